"""Friction of the independent rig that reverses over a few micrometres, or over more."""

from dataclasses import replace

import pytest

import tsas_cli as tsas
from tsas_cli.diagnosis.diagnose import bench_folds
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.nominal import nominal_fit
from tsas_cli.diagnosis.tolerated_travel import with_tolerated_travel
from tsas_cli.identification.extension import bench_of
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.prepared import prepare
from tsas_studies.challenge.rig.friction import Friction
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, write_dataset
from tsas_studies.challenge.rig.sensors import Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

FINE = Sensors(rate_Hz=100.0, x_in_mm=Sensor(noise=0.0002), f_in_N=Sensor(noise=0.04))


def recorded(folder, friction):
    """Return three motions of a rig with this friction."""
    rig = Rig(cells=60, friction=friction)
    runs = [
        Run(f"{size:.0f}-mm", measure(simulate(rig, sine(size)), FINE, seed=k), conditions(rig))
        for k, size in enumerate((6.0, 8.0, 10.0))
    ]
    return write_dataset(folder / "dataset", runs)


@pytest.mark.parametrize(("length_mm", "named"), [(0.003, []), (0.012, ["presliding"])])
def test_elastic_travel_of_a_few_micrometres_is_no_cause(tmp_path, length_mm, named):
    """It is in every contact of metal; these encoders see it, at five times the noise of f_in."""
    found = tsas.diagnose(recorded(tmp_path, Friction(presliding_mm=length_mm)))
    assert [cause.effect for cause in found.causes] == named
    assert found.verdict == ("named" if named else "sufficient")
    # The model has the travel in either case: other runs are predicted with it.
    assert found.model.value("presliding.length_mm") == pytest.approx(length_mm, rel=0.3)
    noted = any("of elastic travel before sliding" in note for note in found.record.cannot_tell)
    assert noted is not bool(named)


def test_a_travel_that_grows_with_the_tension_is_no_cause_either(tmp_path):
    """Bristles of a fixed stiffness: 2 µm at 10 N are 5 at the preload of 25 N."""
    found = tsas.diagnose(recorded(tmp_path, Friction(presliding_mm=0.002, presliding_growth=1.0)))
    assert (found.verdict, found.causes) == ("sufficient", ())
    assert found.model.value("presliding.length_mm") == pytest.approx(0.002, rel=0.3)
    assert found.model.value("presliding.growth") > 0.6


def test_a_set_that_no_search_has_fitted_is_fitted_without_a_travel(tmp_path):
    """As one is that is left when an effect is not proven; here without any travel to find."""
    dataset = tsas.read(recorded(tmp_path, Friction()))
    runs = [prepare(run) for run in dataset]
    bench = bench_of(solve_fit(nominal_fit(dataset.manifest, data_sheet(dataset.manifest), runs)))
    fits = Fits(bench, bench_folds(bench))
    fits.trial(frozenset())
    search = replace(fits.so_far(), named=frozenset(["force_sensor_offset"]))
    assert with_tolerated_travel(search) is search
