import numpy as np
import pytest

from tsas_cli.effects import EFFECTS
from tsas_studies.challenge.faults import FAULTS
from tsas_studies.challenge.near import NEAR_FULL
from tsas_studies.challenge.rig.hidden import CATALOGUE, hide
from tsas_studies.challenge.rig.motions import nested
from tsas_studies.challenge.rig.near import NEAR
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate
from tsas_studies.challenge.rig.unknowns import UNKNOWNS

RIG, SENSORS, MOTION = Rig(cells=20), Sensors(rate_Hz=80.0), nested(speed_mm_s=13.0, rate_Hz=80.0)
NEUTRAL = {e.name: {p.name: p.neutral for p in e.parameters} for e in EFFECTS}
SHAPES = {(e.name, p.name): p.upper for e in EFFECTS for p in e.parameters if p.shape}


def recorded(rig, sensors):
    return measure(simulate(rig, MOTION, session_s=600.0), sensors, seed=3)


PLAIN = recorded(RIG, SENSORS)


def test_the_rig_knows_the_whole_catalogue_and_nothing_of_it_is_unknown():
    assert {name: set(places) for name, places in CATALOGUE.items()} == {
        name: set(parameters) for name, parameters in NEUTRAL.items()
    }, "CATALOGUE of tsas_studies/challenge/rig/hidden.py says where the rig has each parameter"
    assert not set(CATALOGUE) & (set(UNKNOWNS) | set(NEAR))
    assert not set(UNKNOWNS) & set(NEAR)
    assert len(UNKNOWNS) >= 6
    assert len(NEAR) + len(UNKNOWNS) >= 20


@pytest.mark.parametrize("name", CATALOGUE)
def test_neutral_changes_nothing_to_the_last_bit(name):
    parameters = {p: SHAPES.get((name, p), value) for p, value in NEUTRAL[name].items()}
    columns = recorded(*hide(name, parameters, RIG, SENSORS))
    for column, values in PLAIN.items():
        np.testing.assert_array_equal(columns[column], values)


def shown(sized):
    """Return each variant of some causes at full size."""
    return [
        (
            name,
            {q: np.mean(b) for q, b in size.drawn.items()}
            | {p: value or max(size.scaled.values())},
        )
        for name, sizes in sized.items()
        for size in sizes
        for p, value in size.scaled.items()
    ]


@pytest.mark.parametrize(
    "name", sorted(set(NEAR) - {"coarse_converter"})
)  # every converter has a step
def test_a_near_cause_of_no_size_changes_nothing_to_the_last_bit(name):
    parameters = {p: 0.0 for size in NEAR_FULL.get(name, FAULTS.get(name)) for p in size.scaled}
    columns = recorded(*hide(name, parameters, RIG, SENSORS))
    for column, values in PLAIN.items():
        np.testing.assert_array_equal(columns[column], values)


@pytest.mark.parametrize(("name", "parameters"), shown(NEAR_FULL))
def test_every_size_of_a_near_cause_acts(name, parameters):
    columns = recorded(*hide(name, parameters, RIG, SENSORS))
    shows = max(
        np.std(columns[c] - PLAIN[c]) / unit
        for c, unit in (("x_in_mm", 0.1), ("x_out_mm", 0.1), ("f_in_N", 1.0), ("f_out_N", 1.0))
    )
    most = 20.0 if name == "antagonist" else 5.0  # the torque of the drive knows both tendons
    assert 0.1 < shows < most
    of_the_drive = name == "eccentric_encoder"
    assert np.array_equal(columns["x_in_mm"], PLAIN["x_in_mm"]) != of_the_drive


@pytest.mark.parametrize(("name", "parameters"), shown(FAULTS))
def test_a_small_fault_changes_one_channel_by_a_little(name, parameters):
    columns = recorded(*hide(name, parameters, RIG, SENSORS))
    changed = {c for c, values in PLAIN.items() if np.any(columns[c] != values)}
    assert len(changed) == 1 or (name == "unsteady_clock" and "time_s" not in changed)
    units = {"x_in_mm": 0.1, "x_out_mm": 0.1, "f_in_N": 1.0, "f_out_N": 1.0}
    rms = {c: np.sqrt(np.mean((columns[c] - PLAIN[c]) ** 2)) / units[c] for c in changed}
    assert 0.02 < max(rms.values()) < 2.0


def test_a_shared_settling_reaches_both_force_sensors():
    _, sensors = hide("force_sensor_drift", {"settling_per_s": 0.3}, RIG, SENSORS)
    assert sensors.f_in_N.settling_per_s == sensors.f_out_N.settling_per_s == 0.3


def test_causes_add_up():
    rig, sensors = hide("backlash", {"play_mm": 0.1}, RIG, SENSORS)
    rig, sensors = hide("drive_friction", {"friction_N": 2.0}, rig, sensors)
    assert (rig.drive_end.play_mm, rig.drive_end.friction_N) == (0.1, 2.0)


@pytest.mark.parametrize(("name", "parameter"), [("gremlins", "size"), ("backlash", "size")])
def test_what_does_not_exist_is_refused(name, parameter):
    with pytest.raises(KeyError):
        hide(name, {parameter: 1.0}, RIG, SENSORS)
