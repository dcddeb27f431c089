"""What every effect owes the model: neutral is nothing, no energy, one answer from every solver."""

from dataclasses import replace

import numpy as np
import pytest

from tests.both_ways import answers
from tests.physics.references import GROUP_A
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.phases import UNCONVERGED
from tsas_cli.physics.response import NODES, is_closed, simulate
from tsas_cli.physics.rig import with_values

CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
X_IN = np.interp(np.linspace(0, 6, 240), np.arange(7), [0, 14, 13.9, 13.95, 3, 9, 8])
RUN = DriveInput(X_IN, time_s=np.linspace(0.0, 12.0, X_IN.size), session_s=100.0)
LOADS = {
    "spring": RUN,
    "force": replace(RUN, load="force", load_values=25.0 + 1.1 * X_IN),
    "displacement": replace(RUN, load="displacement", load_values=0.8 * X_IN),
    "drive by force": replace(RUN, values=25.0 + 2.0 * X_IN, kind="force"),
}
START = {f"{e.name}.{p.name}": p.start for e in EFFECTS for p in e.parameters}

every_effect = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
every_load = pytest.mark.parametrize("load", LOADS)
every_parameter = pytest.mark.parametrize(
    ("effect", "parameter"),
    [pytest.param(e, p, id=f"{e.name}.{p.name}") for e in EFFECTS for p in e.parameters],
)


def started(effect, **values):
    """Return the rig with one effect, at the values from which its fit begins."""
    start = {p.name: p.start for p in effect.parameters} | values
    return with_values(GROUP_A, {f"{effect.name}.{name}": start[name] for name in start})


def of_response(response):
    return np.array([getattr(response, name) for name in CHANNELS])


def every_answer(rig):
    """Return all channels of all solvers and loads, each as often as it knows the effect."""
    answers = [simulate(rig, drive, nodes=NODES) for drive in LOADS.values()]
    if is_closed(rig, RUN):
        answers += [simulate(rig, RUN), simulate(rig, RUN, "static")]
    return np.array([of_response(answer) for answer in answers])


@pytest.fixture(scope="module")
def nominal():
    return every_answer(GROUP_A)


@every_effect
def test_neutral_is_nothing_to_the_last_bit_whatever_the_shape(effect, nominal):
    neutral = {p.name: p.start if p.shape else p.neutral for p in effect.parameters}
    np.testing.assert_array_equal(
        of_response(simulate(started(effect, **neutral), RUN, nodes=NODES)), nominal[0]
    )
    neutral = {p.name: p.neutral for p in effect.parameters}
    np.testing.assert_array_equal(every_answer(started(effect, **neutral)), nominal)


@every_parameter
def test_the_start_of_every_parameter_changes_a_channel(effect, parameter):
    """A shape matters where the rest of its effect is there."""
    other = {} if parameter.shape else {p.name: p.neutral for p in effect.parameters if not p.shape}
    values = {p.name: p.neutral for p in effect.parameters if p.shape and p.neutral != p.start}
    without = other | values | {parameter.name: parameter.neutral}
    moved = parameter.start if parameter.start != parameter.neutral else 0.5 * parameter.start
    with_it = without | {parameter.name: moved}
    there, not_there = (
        of_response(simulate(started(effect, **v), RUN, nodes=NODES)) for v in (with_it, without)
    )
    assert np.abs(there - not_there).max() > 1e-3


@every_load
@every_effect
def test_every_load_settles_with_every_effect(effect, load):
    answer = simulate(started(effect), LOADS[load])
    assert UNCONVERGED not in answer.phase
    assert np.isfinite(of_response(answer)).all()


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.closed_form], ids=lambda e: e.name)
def test_the_chain_is_the_closed_form(effect):
    """As far as without any effect: a hundredth of a newton, and no more than a node holds back."""
    rig = started(effect)
    closed, chain = simulate(rig, RUN), simulate(rig, RUN, nodes=NODES)
    assert (closed.solver, chain.solver) == ("closed form", "slip chain, 60 nodes")
    error = chain.f_in_N - closed.f_in_N
    assert np.sqrt(np.mean(error**2)) < 0.03
    assert np.abs(error).max() < np.pi / 8 / 60 * closed.f_in_N.max()
    np.testing.assert_allclose(chain.f_out_N, closed.f_out_N, atol=0.02)
    np.testing.assert_allclose(chain.x_out_mm, closed.x_out_mm, atol=0.015)


NOT_FED_BACK = {
    # A delayed or filtered channel loses its corners. A measured force is taken with its tilt, with
    # what it holds of the other one, and with its loop. Where a load stands still, its displacement
    # does not tell on which side the friction before the sensor is.
    ("channel_delay", "force"),
    ("channel_delay", "displacement"),
    ("force_crosstalk", "force"),
    ("force_sensor_hysteresis", "force"),
    ("force_sensor_tilt", "force"),
    ("sensor_lag", "force"),
    ("sensor_lag", "displacement"),
    ("load_friction", "displacement"),
}


@pytest.mark.parametrize(("load", "channel"), [("force", "f_out_N"), ("displacement", "x_out_mm")])
@every_effect
def test_a_run_fed_back_as_a_measured_load_repeats_itself(effect, load, channel):
    if (effect.name, load) in NOT_FED_BACK:
        pytest.skip("the load does not tell everything")
    rig = started(effect)
    spring = simulate(rig, RUN, nodes=NODES)
    again = simulate(rig, replace(RUN, load=load, load_values=getattr(spring, channel)))
    wrong = (
        f"{channel} as read with {effect.name} is not read back: true_value (physics/sensors.py)"
        " lacks its inverse; where there is none, NOT_FED_BACK says why"
    )
    np.testing.assert_allclose(of_response(again), of_response(spring), atol=1e-6, err_msg=wrong)


ROUND = np.array([0.0, 16.0, 3.0, 9.0, 5.0, 16.0])
CHANGES_WITH_TIME = {"bend_drift", "friction_drift", "preload_loss", "load_relaxation"}


def work_of_a_round(rig):
    """Return the drive's work from 14 mm upwards to 14 mm upwards, at one speed all the way."""
    way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(ROUND)))))
    passed = np.linspace(0.0, way[-1], 6001)
    x = np.interp(passed, way, ROUND)
    answer = simulate(rig, DriveInput(x, time_s=0.1 * passed), nodes=NODES)
    trip = slice(
        int(np.searchsorted(passed, 14.0)), int(np.searchsorted(passed, way[-1] - 2.0)) + 1
    )
    return np.trapezoid(answer.f_in_N[trip], x[trip]), answer.f_in_N[trip]


@pytest.mark.parametrize(
    "effect",
    [e for e in EFFECTS if e.acts_on != "sensor" and e.name not in CHANGES_WITH_TIME],
    ids=lambda e: e.name,
)
def test_no_energy_comes_from_an_effect(effect):
    """A round that ends as it began costs work, with any amount of the effect."""
    for factor in (1.0, 3.0):
        large = {p.name: factor * p.start for p in effect.parameters if not p.shape}
        work, f_in = work_of_a_round(started(effect, **large))
        assert f_in[-1] == pytest.approx(f_in[0], rel=0.01)
        assert work > 10.0


@pytest.mark.parametrize(
    "name",
    [
        "drive_friction.friction_N",
        "stribeck_friction.excess",
        "viscous_friction.coefficient_N_s_per_mm",
        "sheath_drag.force_N",
        "drive_damping.coefficient_N_s_per_mm",
        "load_damping.coefficient_N_s_per_mm",
        "load_hysteresis.force_N",
        "load_friction.after_sensor_N",
        "load_friction.before_sensor_N",
    ],
)
def test_more_friction_costs_more_work(name):
    works = [work_of_a_round(with_values(GROUP_A, {name: f * START[name]}))[0] for f in (0, 1, 3)]
    assert works[0] < works[1] < works[2]


PROGRAM = """
import json
import sys
import numpy as np
from tests.effects.test_contract import LOADS, X_IN, started
from tests.physics.references import GROUP_A, slip_chain
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.ends import ends_of

columns = []
for effect in EFFECTS:
    for drive in LOADS.values():
        ends = ends_of(started(effect), drive)
        answer = slip_chain(ends.course[:, ::4], started(effect), ends.boundary, 4)
        columns += [column.tolist() for column in answer]
print(json.dumps(["numba" in sys.modules, columns]))
"""


def test_compiled_is_plain_python_to_rounding():
    plain, compiled = answers(PROGRAM, plain=True), answers(PROGRAM, plain=False)
    assert len(plain) == 5 * len(LOADS) * len(EFFECTS)
    for ours, theirs in zip(plain, compiled, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=1e-8)
