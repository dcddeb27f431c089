"""A tendon and its antagonist: every law by hand after every sample, and two exact solutions.

The second tendon is looked at as it is mounted: from the drive on, its displacements towards the
drive, −x_in there and −x_out at the load.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    course_of,
    slip_chain,
    through,
    wrap_of,
)
from tests.physics.slip.laws_by_hand import (
    EFFECTS,
    FREE,
    ROUNDING,
    SPRINGY,
    Nodes,
    gives,
    moments,
    rubs,
    varying,
)
from tsas_cli.effects import Effects
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip import state as rows
from tsas_cli.physics.slip.chain import follow, initial_state
from tsas_cli.physics.slip.pair import lay
from tsas_cli.physics.slip.state import POSITION, SECOND, TENSION, chain_at_rest, slip_laws

N = 3
PAIR = {"antagonist.preload_N": 18.0, "antagonist.friction_ratio": 1.4}
MOTIONS = {
    "both taut": np.array([0.3, 0.5, 0.7, 0.68, 0.6, 0.62, 0.6, 0.3, -0.1, -0.3, -0.2, 0.1]),
    "either slack": np.array([0.4, 2.5, 4.6, 4.5, 2.0, 1.9, -1.5, -7.5, -9.5, -9.4, -3.0, 0.6]),
}
NAMES = (
    *("friction alone", "free tendon", "friction rises with tension", "presliding"),
    *("friction rises along the sheath", "a guide at the load", "friction falls with speed"),
)
CASES = [(name, motion) for name in NAMES for motion in MOTIONS]
for its in ("presliding", "friction falls with speed"):  # its nodes' shares, speeds are not known
    CASES.remove((its, "either slack"))


def states(course, rig, boundary):
    """Yield positions and tensions of both tendons, each from the drive on, after every sample."""
    for i in range(course.shape[1]):
        part = np.ascontiguousarray(course[:, : i + 1])
        start = initial_state(part, rig, boundary, N)
        chain = follow(part, start, rig, boundary, N, None)[1].chain
        x, T = (chain[row : row + N + 2].copy() for row in (POSITION, TENSION))
        x_2, T_2 = (chain[SECOND + row : SECOND + row + N + 2] for row in (POSITION, TENSION))
        yield (x, T[:-1]), (-x_2[::-1], T_2[:-1][::-1].copy())


def friction_of(rig):
    """Return the rig whose nodes hold the second tendon, which has the same effects."""
    return rig._replace(effects=rig.effects._replace(antagonist=Effects().antagonist))


class Tendon:
    """One of both tendons: its tension at rest, and where its nodes were."""

    def __init__(self, rig, preload_N):
        self.preload_N, self.give = preload_N, gives(rig)
        self.nodes, self.before, self.was_slack = Nodes(friction_of(rig)), np.zeros(N + 2), False

    def hold(self, x, T, now):
        """Hold a state against the laws of its segments and nodes; return whether it is slack."""
        slack = not T.any()
        if slack:
            assert x[0] - x[-1] < -self.give.sum() * self.preload_N + ROUNDING
        else:
            assert T.min() > 0.0
            np.testing.assert_allclose(
                x[:-1] - x[1:], self.give * (T - self.preload_N), atol=ROUNDING
            )
            for i in range(1, N + 1):
                way = 0.0 if self.was_slack else x[i] - self.before[i]
                self.nodes.hold(i, way, T[i - 1], T[i], now)
        way = (x - self.before)[1:-1]
        self.slips = np.where(np.abs(way) > ROUNDING, np.sign(way), 0.0)
        self.before, self.was_slack = x, slack
        return slack


def hold_everywhere(course, rig, boundary):
    """Hold every state against all laws; return which tendons were slack, and the phases."""
    effects, ratio = rig.effects, rig.effects.antagonist.friction_ratio
    second_N = effects.antagonist.preload_N
    first, second = Tendon(rig, rig.preload_N + second_N), Tendon(rig, second_N)
    x_before, slack, phases = 0.0, [], []
    for now, ((x, T), (x_2, T_2)) in zip(
        moments(course), states(course, rig, boundary), strict=True
    ):
        assert (x_2[0], x_2[-1]) == (-x[0], -x[-1])
        losses = now.losses
        rougher = losses._replace(pulled=ratio * losses.pulled, released=ratio * losses.released)
        slack.append((first.hold(x, T, now), second.hold(x_2, T_2, now._replace(losses=rougher))))
        slips = np.concatenate((first.slips, -second.slips))
        phases.append(slips[0] if np.all(slips == slips[0]) else 0)
        way, net = x[-1] - x_before, T[-1] - T_2[-1]
        guide = effects.load_friction.before_sensor_N
        if boundary == LOADED_BY_FORCE:
            assert rubs(net - now.load, way, guide)
        elif boundary == LOADED_BY_DISPLACEMENT:
            assert x[-1] == now.load
        else:
            held = rig.preload_N - losses.preload_N + rig.load_stiffness_N_per_mm * x[-1]
            assert rubs(net - held, way, guide + effects.load_friction.after_sensor_N)
        x_before = x[-1]
    return np.array(slack), phases


@pytest.mark.parametrize(("name", "motion"), CASES)
def test_every_law_holds_at_a_spring(name, motion):
    rig = with_values(SPRINGY, EFFECTS[name] | PAIR)
    course = varying(MOTIONS[motion], rig)
    slack, phases = hold_everywhere(course, rig, LOADED_BY_SPRING)
    assert slack.any(axis=0).tolist() == [motion == "either slack"] * 2
    found = slip_chain(course, rig, LOADED_BY_SPRING, N)[4]
    assert UNCONVERGED not in found
    if motion == "both taut" and name != "presliding":
        assert found.tolist() == phases
        assert set(phases) == ({1, 0} if "speed" in name else {1, 0, -1})


@pytest.mark.parametrize("boundary", [LOADED_BY_FORCE, LOADED_BY_DISPLACEMENT])
def test_every_law_holds_with_the_load_given(boundary):
    rig = with_values(SPRINGY, PAIR | {"load_friction.before_sensor_N": 1.5})
    motion = MOTIONS["both taut"]
    load = 25.0 + 6.0 * np.sin(np.arange(12.0)) if boundary == LOADED_BY_FORCE else 0.5 * motion
    course = course_of(motion, rig, load=load, released=0.8 * wrap_of(rig))
    hold_everywhere(course, rig, boundary)
    np.testing.assert_array_equal(
        slip_chain(course, rig, boundary, N)[3 if boundary == LOADED_BY_FORCE else 1], load
    )


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_every_law_holds_with_a_force_at_the_drive(share):
    """Its friction and a spring beside the tendons take their part of the force."""
    beside = {"drive_friction.friction_N": 2.0, "proximal_spring.stiffness_N_per_mm": 4.0}
    rig = with_values(SPRINGY, PAIR | beside | {"antagonist.f_in_share": share})
    pull = 43.0 - 18.0 * share + 40.0 * MOTIONS["both taut"]
    course = course_of(pull, rig)
    hold_everywhere(course, rig, DRIVEN_BY_FORCE)
    x, T, T_2 = np.transpose(
        [(x[0], T[0], T_2[0]) for (x, T), (_, T_2) in states(course, rig, DRIVEN_BY_FORCE)]
    )
    ways = np.diff(x, prepend=0.0)
    assert all(map(rubs, pull - 4.0 * x - T + share * T_2, ways, np.full(12, 2.0)))
    assert (ways.max() > 0.05, ways.min() < -0.05, 0.0 in ways) == (True, True, True)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_a_force_at_the_drive_moves_it_as_the_displacement_did(share):
    """The force that a sensor reads of a motion, given in its place, makes the same motion."""
    rig = with_values(SPRINGY, PAIR | {"antagonist.f_in_share": share})
    motion = MOTIONS["both taut"]
    moved = slip_chain(course_of(motion, rig), rig, LOADED_BY_SPRING, N)
    again = slip_chain(course_of(moved[2], rig), rig, DRIVEN_BY_FORCE, N)
    assert UNCONVERGED not in again[4]
    for found, expected in zip(again[:4], moved[:4], strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-5)


def test_without_friction_both_are_springs_that_cannot_push():
    """K (x_in − x + s₁) − K (x − x_in + s₂) = F₀ + kL x, each term at least zero, s₁ = T₁/K."""
    rig = with_values(
        GROUP_A._replace(friction_coefficient=1e-9, tendon_stiffness_N=3e3),
        {"antagonist.preload_N": 10.0},
    )
    K, kL = rig.tendon_stiffness_N / rig.sheath_length_mm, rig.load_stiffness_N_per_mm
    x_in = through(20.0, -70.0, 5.0, samples=40)

    def tensions(x, drive):
        return max(35.0 + K * (drive - x), 0.0), max(10.0 + K * (x - drive), 0.0)

    def unbalanced(x, drive):
        first, second = tensions(x, drive)
        return first - second - 25.0 - kL * x

    exact = np.array([brentq(unbalanced, -90.0, 60.0, args=(drive,), xtol=1e-12) for drive in x_in])
    pulls = np.array([tensions(*both) for both in zip(exact, x_in, strict=True)])
    assert (pulls.min(axis=0) == 0.0).all()
    answer = simulate(rig, DriveInput(x_in), nodes=4)
    np.testing.assert_allclose(answer.x_out_mm, exact, atol=1e-6)
    np.testing.assert_allclose(answer.f_in_N, pulls[:, 0] - pulls[:, 1], atol=1e-5)
    assert np.array_equal(answer.phase == SLACK, pulls[:, 0] == 0.0)


def test_a_load_cell_in_the_first_tendon_reads_the_second_one_on_top():
    x_in = np.append(0.0, through(8.0, 2.0, samples=50))
    runs = [
        simulate(
            with_values(GROUP_A, PAIR | {"antagonist.f_in_share": share}), DriveInput(x_in), nodes=6
        )
        for share in (0.0, 0.5, 1.0)
    ]
    np.testing.assert_allclose(runs[1].f_in_N, 0.5 * (runs[0].f_in_N + runs[2].f_in_N), atol=1e-9)
    assert (runs[0].f_in_N[0], runs[2].f_in_N[0]) == pytest.approx((43.0, 25.0))
    for channel in ("x_out_mm", "f_out_N"):
        np.testing.assert_array_equal(getattr(runs[0], channel), getattr(runs[2], channel))


@pytest.mark.parametrize("moved", [0.5, -0.5])
def test_a_slack_tendon_waits_taut_up_to_where_it_will_be_pulled_from(moved):
    """From the load where the drive pulls it, from the drive where it lets go; then all slips."""
    rig, ends = with_values(SPRINGY, PAIR | FREE), rows.POSITION_BEFORE + np.array([0, N + 1])
    chain, laws = chain_at_rest(rig, N), slip_laws(rig, N, LOADED_BY_SPRING)
    chain[ends] = 7.0, -3.0
    lay(chain, moved, laws)
    x = chain[ends[0] : ends[1] + 1]
    stretched = x[:-1] - x[1:] + laws.preload_N * chain[rows.COMPLIANCE :][: N + 1]
    np.testing.assert_allclose(stretched[1:] if moved > 0.0 else stretched[:-1], 0.0, atol=1e-12)
    np.testing.assert_array_equal(x[1:-1], chain[POSITION + 1 : POSITION + N + 1])
    for row in (TENSION, rows.TENSION_BEFORE, rows.TRAVEL, rows.TENSION_RISE):
        assert not chain[row : row + N + 2].any()
    for row in (rows.SLIP, rows.SHARE_BEFORE):
        assert chain[row + 1 : row + N + 1].tolist() == [2.0 * moved] * N
