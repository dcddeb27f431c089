"""What a call from Python refuses, and the names that can be called."""

import inspect
import pickle

import numpy as np
import pytest

import tsas_cli as tsas
from tsas_cli.records.result import Result


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda data: tsas.read(data / "none"), "does not exist"),
        (lambda data: tsas.calibrate(data, dynamics="static"), "expected slip or lugre"),
        (lambda data: tsas.simulate(data, dynamics="lugra"), "did you mean lugre"),
        (lambda data: tsas.diagnose(data, runs=["b"]), "there is no run 'b'"),
        (lambda data: tsas.identify_harmonic_drive(data, speed="said"), "measured or comman"),
        (lambda data: tsas.track(controllers=[]), "no controller is named"),
        (lambda data: tsas.track(dynamics="static"), "expected slip or lugre"),
        (lambda data: tsas.track(seeds=0), "seeds is 0; expected 1 or more"),
        (lambda data: tsas.close_loop(out="none", first_seed=-1), "first_seed is -1"),
        (lambda data: tsas.close_loop(out="none", seeds=10_001), "seeds is 10001; expected at m"),
        (lambda data: tsas.track(seeds=10_001), "seeds is 10001; expected at most 10000"),
        (lambda data: tsas.plan(data / "none.toml"), "cannot be read"),
        (lambda data: tsas.close_loop(out="none", cases=["x"]), "unknown case x"),
        (lambda data: tsas.read(5), "5 is of type int; expected str or Path"),
        (lambda data: tsas.read(data)[0], "there is no run 0; known are"),
        (lambda data: tsas.check(data, runs=[]), "no run is chosen"),
        (lambda data: tsas.simulate(data, model={}), "is of type dict; expected Model or str"),
        (lambda data: tsas.runs("", folders=[]), "no folder or file is named"),
        (lambda data: tsas.runs(5), "5 is of type int; expected str"),
        (lambda data: tsas.runs("", data, columns=5), "5 is of type int; expected str"),
        (lambda data: tsas.runs("", data, sort=[None]), "None is of type NoneType"),
        (lambda data: tsas.runs("", data, limit="x"), "'x' is of type str; expected int"),
        (lambda data: tsas.runs("", data, limit=1.5), "1.5 is of type float; expected int"),
        (lambda data: tsas.explain(5), "5"),
        (lambda data: tsas.calibrate(data, dynamics=5), "dynamics is 5; expected slip or"),
        (lambda data: tsas.identify_harmonic_drive(data, speed=5), "speed is 5"),
        (lambda data: tsas.track(seeds=[1]), "is of type list; expected int"),
        (lambda data: tsas.track(first_seed=b"x"), "is of type bytes; expected int"),
        (lambda data: tsas.compare("a", "b", out=5), "out: 5 is of type int; expected str"),
        (lambda data: tsas.guess([]), "no folder or file is named"),
        (lambda data: tsas.report([], out="x.html"), "no folder or file is named"),
        (lambda data: tsas.plan([data, data]), "is of type list; expected Dataset or str"),
        (lambda data: tsas.track(controllers=5), "5 is of type int; expected str"),
        (lambda data: tsas.plan(3), "3 is of type int"),
        (lambda data: tsas.verify(3), "3 is of type int"),
        (lambda data: tsas.ingest(3, map=4, out="x"), "is of type int"),
        (lambda data: tsas.simulate(data, nodes="x"), "'x' is of type str; expected int"),
        (lambda data: tsas.simulate(data, nodes=50.0), "50.0 is of type float; expected int"),
        (lambda data: tsas.predict(5, data), "5 is of type int; expected str or Path"),
        (lambda data: tsas.compare("a", None), "b: None is of type NoneType; expected Model"),
        (lambda data: tsas.runs("", data, limit=True), "True is of type bool; expected int"),
        (lambda data: tsas.read(300 * "a"), "no file can have this name"),
        (lambda data: tsas.check(data, out="a\0b"), "no file can have this name"),
        (lambda data: tsas.track(settings=5000 * "a/"), "no file can have this name"),
        (lambda data: tsas.upload(300 * "a", "s3://b/c"), "no file can have this name"),
        (lambda data: tsas.upload("a\0b", "s3://b/c"), "no file can have this name"),
        (lambda data: tsas.calibrate(data, dynamics=np.zeros(2)), "expected slip or lugre"),
        (lambda data: tsas.simulate(data, fit_own=np.zeros(2)), "fit_own: .* expected bool"),
        (lambda data: tsas.report(data, out="x", pdf=np.zeros(2)), "pdf: .* expected bool"),
        (lambda data: tsas.explain(np.zeros(2)), "name: .* is of type ndarray; expected str"),
        (lambda data: tsas.check(data, runs=np.array(3)), "is of type ndarray; expected str"),
        (lambda data: tsas.runs("", np.array(3)), "is of type ndarray; expected str or Path"),
        (lambda data: tsas.export(None, to="json", out="x"), "model: None is of type NoneType"),
        (lambda data: tsas.sweep({}, out="x", cluster=data), "cluster: .* expected str"),
        (lambda data: tsas.read("\ud800"), "no file can have this name"),
        (lambda data: tsas.verify(data, step=None), "step: None .* expected Steps"),
        (lambda data: tsas.simulate(data, each=1), "each: 1 is of type int; expected Callab"),
    ],
)
def test_a_wrong_call_is_an_input_error(dataset, wrong, says):
    with pytest.raises(tsas.InputError, match=says):
        wrong(dataset)


def test_what_is_checked_keeps_its_name_and_can_be_sent_to_another_process():
    for name in tsas.__all__:
        thing = getattr(tsas, name)
        assert pickle.loads(pickle.dumps(thing)) is thing is getattr(tsas, name)  # noqa: S301
        assert thing.__name__ == name


def test_every_name_is_there_and_explained():
    for name in tsas.__all__:
        thing = getattr(tsas, name)
        assert thing.__doc__
        assert name in dir(tsas)
        if inspect.isfunction(thing):
            told = inspect.getdoc(thing)
            assert "Returns\n-------" in told
            for parameter in inspect.signature(thing).parameters:
                assert f"\n{parameter}\n" in told
    with pytest.raises(AttributeError, match="no attribute 'nope'"):
        _ = tsas.nope


def test_every_result_is_known_by_itself_and_prints_its_tables():
    assert all(hasattr(tsas, name) for name in tsas.__all__)  # and loads its stage
    kinds = Result.__subclasses__()
    assert len(kinds) > 15
    for kind in kinds:
        assert (kind.__eq__, kind.__hash__) == (object.__eq__, object.__hash__)
        assert kind.__repr__ is Result.__repr__
