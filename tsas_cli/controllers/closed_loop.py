"""The closed loop: plant, sensor and controller in one kernel, sample by sample.

At each sample x_in is measured (noise, encoder resolution), the controller computes a speed without
delay, and the motor gets it as its command until the next sample, within its limit. Between two
samples the plant takes `substeps` equal steps. From sample `change_at` on the second rig applies.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.controllers.laws import MEMORY, ControlLaws, control, initial_memory
from tsas_cli.controllers.signals import Signals, filtered
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, SPRING, Boundary
from tsas_cli.physics.course import Losses
from tsas_cli.physics.ends import DriveInput, ends_of
from tsas_cli.physics.lugre.start import lugre_laws
from tsas_cli.physics.plant.laws import (
    AHEAD,
    PlantLaws,
    beside_drive,
    friction_of_tendon,
    laws_at_rest,
    plant_laws,
)
from tsas_cli.physics.plant.lugre_plant import (
    lumps_at_rest,
    step_lumped_plant,
    tension_at_load,
    with_rig,
)
from tsas_cli.physics.plant.slip_plant import step_plant
from tsas_cli.physics.plant.turntable import (
    Actuator,
    DriveStep,
    Motor,
    Turntable,
    advance_motor,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.chain import follow, initial_state
from tsas_cli.physics.slip.outputs import tension_at_sensor
from tsas_cli.physics.slip.state import POSITION, Moment, set_compliances, slip_laws
from tsas_cli.support.arrays import Floats

DRIVEN = Boundary(FORCE, SPRING)  # the tendon in the plant
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
RUNAWAY_MM = 1e3  # error of x_in at which a run has diverged
GIVEN_UP = 0.01  # of the steps: beyond this share the run ends


class LoopReference(NamedTuple):
    """Reference of the loop at m samples."""

    path: Floats  # of the drive: position and its first three derivatives, shape (4, m) [mm, s]
    feedforward: Floats  # shape (m,) [rpm]


class DriveSensor(NamedTuple):
    """How x_in is measured, and how the error's rates are estimated (`signals.error_filter`)."""

    step_s: float  # between samples
    noise: Floats  # of each, shape (m,) [mm]
    encoder_step_mm: float
    A: Floats
    b: Floats


class PlantStart(NamedTuple):
    """State of a plant at rest."""

    motor: Motor
    table: Turntable
    chain: Floats  # the tendon, overwritten
    laws: Floats  # the state of the laws of unnamed origin, overwritten


class LoopPlant(NamedTuple):
    """The controlled plant; from sample `change_at` on the second rig applies."""

    actuator: Actuator
    rigs: tuple[Rig, Rig]
    laws: tuple[PlantLaws, PlantLaws]  # of the rigs
    change_at: int
    substeps: int  # of the plant in one sample
    nodes: int
    start: PlantStart


def plant_at_rest(drive_mm: float, rig: Rig, actuator: Actuator, n: int) -> PlantStart:
    """Return motor, turntable and tendon at rest at x_in = `drive_mm`, reached from x_in = 0."""
    ends = ends_of(
        rig, DriveInput(np.linspace(0.0, drive_mm, 1 + STEPS_TO_START) + rig.x_in_zero_mm)
    )
    state = initial_state(ends.course, rig, ends.boundary, n)
    f_in = rig.preload_N
    if drive_mm != 0.0:
        output, state = follow(ends.course, state, rig, ends.boundary, n, None)
        stiffness = rig.effects.proximal_spring.stiffness_N_per_mm
        f_in = float(output.f_in[-1])
        f_in += proximal_spring_force(float(state.chain[POSITION]), stiffness)
    laws = laws_at_rest(ends.drive, f_in, plant_laws(rig))
    f_in += float(laws[AHEAD])
    motor_mm = drive_mm + (f_in - rig.preload_N) / actuator.stiffness_N_per_mm
    table = Turntable(drive_mm, drive_mm, 0.0, 0.0, f_in, 0.0)
    return PlantStart(Motor(0.0, motor_mm), table, state.chain, laws)


@kernel
def close_loop(
    wanted: LoopReference,
    sensor: DriveSensor,
    laws: ControlLaws,
    plant: LoopPlant,
    lumps: Floats | None = None,
) -> tuple[Floats, int, int]:
    """Return the loop's columns, shape (COLUMNS, m), unconverged steps and completed samples.

    With arrays for lumps (`lugre_plant.empty_lumps`) the tendon is the LuGre chain, from the state
    of the slip chain at the start, else the slip chain; only the one in use is compiled.
    """
    path, n, actuator, substeps = wanted.path, plant.nodes, plant.actuator, plant.substeps
    motor, table, chain, law_state = plant.start
    m = path.shape[1]
    columns = np.zeros((COLUMNS, m))
    memory, state = np.zeros(MEMORY), np.zeros(3)
    initial_memory(laws, memory)
    rig, laws_of_rig = plant.rigs[0], plant.laws[0]
    chain_laws = slip_laws(rig, n, DRIVEN)
    now = Moment(table.f_in, 0.0, Losses(0.0, 0.0, 0.0, 0.0), np.inf)
    if lumps is not None:
        lump_laws = lugre_laws(rig, n, DRIVEN)
        friction = friction_of_tendon(law_state, chain[POSITION], laws_of_rig)
        f_in = table.f_in - law_state[AHEAD]
        tendon = lumps_at_rest(lumps, chain, f_in, rig, n, friction)
    h = sensor.step_s / substeps
    applied, limited, unconverged = 0.0, False, 0
    for k in range(m):
        if k == plant.change_at:
            rig, laws_of_rig = plant.rigs[1], plant.laws[1]
            chain_laws = slip_laws(rig, n, DRIVEN)
            set_compliances(chain, rig, n)
            if lumps is not None:
                lump_laws = lugre_laws(rig, n, DRIVEN)
                tendon = with_rig(lumps, tendon, rig, n)
        x_measured = measured(table.x, sensor, k)
        e = path[0, k] - x_measured
        if not abs(e) < RUNAWAY_MM or unconverged > GIVEN_UP * m * substeps:
            return columns, unconverged, k
        filtered(state, e, sensor.A, sensor.b)
        signals = Signals(
            e, state[0], state[1], state[2], path[1, k], path[2, k], path[3, k], applied, limited
        )
        u, s = control(signals, laws, memory, sensor.step_s)
        speed = wanted.feedforward[k] + u
        asked = min(max(speed, -actuator.speed_limit_rpm), actuator.speed_limit_rpm)
        applied, limited = asked - wanted.feedforward[k], asked != speed
        columns[X_IN, k], columns[X_SEEN, k] = table.x, x_measured
        columns[X_OUT, k], columns[F_IN, k] = chain[POSITION + n + 1], table.f_in
        columns[F_OUT, k] = tension_at_sensor(chain, now, chain_laws)
        if lumps is not None:
            columns[X_OUT, k] = tendon.ends.load.x
            columns[F_OUT, k] = tension_at_load(tendon, lump_laws)
        columns[ASKED, k], columns[MOTOR, k], columns[DISTANCE, k] = asked, motor.rpm, s
        for j in range(MEMORY):
            columns[MEMORY_AT + j, k] = memory[j]
        tendon_rows = chain if lumps is None else lumps  # the end at the drive is the first of both
        friction = friction_of_tendon(law_state, tendon_rows[POSITION], laws_of_rig)
        for sub in range(substeps):
            motor = advance_motor(motor, asked, actuator, h)
            time_s = (k + (sub + 1) / substeps) * sensor.step_s
            beside = beside_drive(law_state, tendon_rows[POSITION], table, h, laws_of_rig)
            step = DriveStep(actuator, motor.mm, time_s, h, beside, friction)
            if lumps is not None:
                table, tendon, converged = step_lumped_plant(
                    table, lumps, tendon, rig, lump_laws, step
                )
            else:
                table, now, converged = step_plant(table, chain, now, rig, chain_laws, step)
            unconverged += not converged
    return columns, unconverged, m


@kernel
def measured(x_in: float, sensor: DriveSensor, k: int) -> float:
    """Return the reading of the encoder at a sample [mm]."""
    x_measured: float = x_in + sensor.noise[k]
    if sensor.encoder_step_mm > 0.0:
        x_measured = sensor.encoder_step_mm * np.round(x_measured / sensor.encoder_step_mm)
    return x_measured
