"""Friction of the independent rig that reverses over a few micrometres, or over more."""

import pytest

import tsas_cli as tsas
from tsas_studies.challenge.rig.friction import Friction
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, write_dataset
from tsas_studies.challenge.rig.sensors import Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

FINE = Sensors(rate_Hz=100.0, x_in_mm=Sensor(noise=0.0002), f_in_N=Sensor(noise=0.04))


def diagnosed(folder, friction):
    """Return the diagnosis of three motions of a rig with this friction."""
    rig = Rig(cells=60, friction=friction)
    runs = [
        Run(f"{size:.0f}-mm", measure(simulate(rig, sine(size)), FINE, seed=k), conditions(rig))
        for k, size in enumerate((6.0, 8.0, 10.0))
    ]
    return tsas.diagnose(write_dataset(folder / "dataset", runs))


@pytest.mark.parametrize(("length_mm", "named"), [(0.003, []), (0.012, ["presliding"])])
def test_elastic_travel_of_a_few_micrometres_is_no_cause(tmp_path, length_mm, named):
    """It is in every contact of metal; these encoders see it, at five times the noise of f_in."""
    found = diagnosed(tmp_path, Friction(presliding_mm=length_mm))
    assert [cause.effect for cause in found.causes] == named
    assert found.verdict == ("named" if named else "sufficient")
    # The model has the travel in either case: other runs are predicted with it.
    assert found.model.value("presliding.length_mm") == pytest.approx(length_mm, rel=0.3)
    noted = any("of elastic travel before sliding" in note for note in found.record.cannot_tell)
    assert noted is not bool(named)


def test_a_travel_that_grows_with_the_tension_is_no_cause_either(tmp_path):
    """Bristles of a fixed stiffness: 2 µm at 10 N are 5 at the preload of 25 N."""
    found = diagnosed(tmp_path, Friction(presliding_mm=0.002, presliding_growth=1.0))
    assert (found.verdict, found.causes) == ("sufficient", ())
    assert found.model.value("presliding.length_mm") == pytest.approx(0.002, rel=0.3)
    assert found.model.value("presliding.growth") > 0.6
