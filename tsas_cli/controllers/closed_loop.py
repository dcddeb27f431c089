"""The closed loop: plant, sensor and controller in one kernel, sample by sample.

At each sample x_in is measured (noise, steps of the encoder), the controller answers at once, and
the motor is asked for that speed until the next sample, within its limit. Between two samples the
plant moves in `substeps` equal steps. From sample `change_at` on the rig is another one.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.controllers.adaptive_sliding_mode import (
    AdaptiveSlidingMode,
    adaptive_sliding_mode,
)
from tsas_cli.controllers.disturbance_observer import DisturbanceObserver, disturbance_observer
from tsas_cli.controllers.pid import Pid, pid
from tsas_cli.controllers.signals import Floats, Signals, filtered
from tsas_cli.controllers.sliding_mode import SlidingMode, distance, sliding_mode
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, SPRING, Boundary
from tsas_cli.physics.ends import Drive, ends_of
from tsas_cli.physics.lugre.start import lugre_laws
from tsas_cli.physics.mesh import segment_compliances
from tsas_cli.physics.plant.lugre_plant import (
    lumps_at_rest,
    step_lumped_plant,
    tension_at_load,
    with_rig,
)
from tsas_cli.physics.plant.turntable import Actuator, Turntable, advance_motor, step_plant
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.chain import follow, initial_state, tension_at_sensor
from tsas_cli.physics.slip.start import slip_laws
from tsas_cli.physics.slip.state import COMPLIANCE, POSITION, Moment

PID, SLIDING, ADAPTIVE, OBSERVER = range(4)
MEMORY = 3
STEPS_TO_START = 200
(
    X_IN,
    X_SEEN,
    X_OUT,
    F_IN,
    F_OUT,
    ASKED,
    MOTOR,
    DISTANCE,
) = range(8)
MEMORY_AT = 8
COLUMNS = MEMORY_AT + MEMORY
RUNAWAY_MM = 1e3  # from the wanted place, at which a run has diverged
GIVEN_UP = 0.01  # of the steps: where more do not settle, the tendon is not followed any further


class ControlLaws(NamedTuple):
    """Every controller's settings, and which of them is at work."""

    kind: int
    pid: Pid
    sliding_mode: SlidingMode
    adaptive_sliding_mode: AdaptiveSlidingMode
    disturbance_observer: DisturbanceObserver


def followed_from(
    drive_mm: float, rig: Rig, actuator: Actuator, n: int
) -> tuple[Turntable, Floats]:
    """Return turntable and chain at rest at a place of the drive, come to from x_in = 0."""
    ends = ends_of(rig, Drive(np.linspace(0.0, drive_mm, 1 + STEPS_TO_START) + rig.x_in_zero_mm))
    state = initial_state(ends.course, rig, ends.boundary, n)
    f_in = rig.preload_N
    if drive_mm != 0.0:
        f_in = float(follow(ends.course, state, rig, ends.boundary, n)[2][-1])
        stiffness = rig.effects.proximal_spring.stiffness_N_per_mm
        f_in += proximal_spring_force(float(state.chain[POSITION]), stiffness)
    motor_mm = drive_mm + (f_in - rig.preload_N) / actuator.stiffness_N_per_mm
    return Turntable(0.0, motor_mm, drive_mm, drive_mm, 0.0, 0.0, f_in, 0.0), state.chain


@kernel
def control(seen: Signals, laws: ControlLaws, memory: Floats, step_s: float) -> tuple[float, float]:
    """Return the motor speed beside the feedforward [rpm], and s where there is a surface."""
    if laws.kind == PID:
        return pid(seen, laws.pid, memory, step_s), 0.0
    if laws.kind == SLIDING:
        sliding = laws.sliding_mode
        return sliding_mode(seen, sliding.surface, sliding.phi), distance(seen, sliding.surface)
    if laws.kind == ADAPTIVE:
        adaptive = laws.adaptive_sliding_mode
        u = adaptive_sliding_mode(seen, adaptive, memory, step_s)
        return u, distance(seen, adaptive.surface)
    return disturbance_observer(seen, laws.disturbance_observer, memory, step_s), 0.0


@kernel
def close_loop(
    path: Floats,
    feedforward: Floats,
    noise: Floats,
    encoder_step_mm: float,
    A: Floats,
    b: Floats,
    laws: ControlLaws,
    table: Turntable,
    chain: Floats,
    rigs: tuple[Rig, Rig],
    change_at: int,
    actuator: Actuator,
    n: int,
    step_s: float,
    substeps: int,
    lumps: Floats | None = None,
) -> tuple[Floats, int, int]:
    """Run the loop; return its columns, shape (COLUMNS, m), unsettled steps, samples followed.

    `chain` is the tendon at rest. With room for lumps (`lugre_plant.no_lumps`) they follow it from
    there, else the slip chain itself does; only what does so is compiled.
    """
    m = path.shape[1]
    columns = np.zeros((COLUMNS, m))
    memory, state = np.zeros(MEMORY), np.zeros(3)
    if laws.kind == ADAPTIVE:
        start = laws.adaptive_sliding_mode.start
        memory[0], memory[1], memory[2] = start.phi1, start.phi2, start.phi3
    rig = rigs[0]
    chain_laws = slip_laws(rig, n)
    scale = rig.sheath_length_mm * rig.preload_N / rig.tendon_stiffness_N / n + 1e-9
    now = Moment(table.f_in, 0.0, 0.0, 0.0, 0.0, 0.0, np.inf)
    boundary = Boundary(FORCE, SPRING)
    if lumps is not None:
        law, tendon = lugre_laws(rig, n), lumps_at_rest(lumps, chain, table.f_in, rig, n)
    h = step_s / substeps
    applied, limited, unsettled = 0.0, False, 0
    for k in range(m):
        if k == change_at:
            rig = rigs[1]
            chain_laws = slip_laws(rig, n)
            gives = segment_compliances(rig, n)
            for j in range(n + 2):
                chain[COMPLIANCE + j] = gives[min(j, n)]
            if lumps is not None:
                law, tendon = lugre_laws(rig, n), with_rig(lumps, tendon, rig, n)
        x_seen = table.x + noise[k]
        if encoder_step_mm > 0.0:
            x_seen = encoder_step_mm * np.round(x_seen / encoder_step_mm)
        e = path[0, k] - x_seen
        if not abs(e) < RUNAWAY_MM or unsettled > GIVEN_UP * m * substeps:
            return columns, unsettled, k
        filtered(state, e, A, b)
        seen = Signals(
            e,
            state[0],
            state[1],
            state[2],
            path[1, k],
            path[2, k],
            path[3, k],
            applied,
            limited,
        )
        u, s = control(seen, laws, memory, step_s)
        wanted = feedforward[k] + u
        asked = min(max(wanted, -actuator.speed_limit_rpm), actuator.speed_limit_rpm)
        applied, limited = asked - feedforward[k], asked != wanted
        columns[X_IN, k], columns[X_SEEN, k] = table.x, x_seen
        columns[X_OUT, k], columns[F_IN, k] = chain[POSITION + n + 1], table.f_in
        columns[F_OUT, k] = tension_at_sensor(chain, now, boundary, chain_laws)
        if lumps is not None:
            columns[X_OUT, k] = tendon.ends.x_out
            columns[F_OUT, k] = tension_at_load(tendon, law)
        columns[ASKED, k], columns[MOTOR, k], columns[DISTANCE, k] = asked, table.motor_rpm, s
        for j in range(MEMORY):
            columns[MEMORY_AT + j, k] = memory[j]
        for sub in range(substeps):
            table = advance_motor(table, asked, actuator, h)
            time_s = (k + (sub + 1) / substeps) * step_s
            if lumps is not None:
                table, tendon, settled = step_lumped_plant(
                    table, lumps, tendon, time_s, rig, law, actuator, h
                )
            else:
                table, now, settled = step_plant(
                    table, chain, now, time_s, rig, chain_laws, actuator, h, scale
                )
            unsettled += not settled
    return columns, unsettled, m
