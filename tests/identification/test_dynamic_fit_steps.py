"""The order of the dynamic fit's steps: what each begins with, and what is said in the end."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.counted import Counted
from tests.physics.references import TABLE_1
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.physics.response import LUMPS
from tsas_cli.recordings.manifest import Run

RUN = SimpleNamespace(run=Run(id="a", file="a.parquet", sha256="0" * 64))
NOMINAL = Model((Estimate("friction_coefficient", 0.1, "1", "fitted", None, 0.01, 0.08, 0.12),))


def test_what_is_looked_at():
    """Stribeck velocities from 0.01 to 100 mm/s, four for each ten times as fast."""
    assert d.VELOCITIES[[0, 4, 8, 12, 16]] == pytest.approx([0.01, 0.1, 1.0, 10.0, 100.0])
    assert d.VELOCITIES.size == 17
    assert d.TIMES == (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)


def test_the_finest_stiffness_reaches_as_far_as_a_lump_is_long():
    """√(EA L/σ0) is L/LUMPS there."""
    fit = SimpleNamespace(rigs=[TABLE_1, "another"])
    length = TABLE_1.sheath_length_mm
    reach = np.sqrt(TABLE_1.tendon_stiffness_N * length / d._finest_stiffness(fit))
    assert reach == pytest.approx(length / LUMPS)


def test_moves_that_are_asked_for_take_errors_away():
    slopes = np.array([[1.0, 0.0], [0.0, 2.0], [0.0, 0.0]])
    assert d._least_squares_step(slopes, np.array([3.0, -4.0, 7.0])) == pytest.approx([-3.0, 2.0])


def test_values_to_start_from_have_their_units():
    (one, two) = d._model_of({d.STIFFNESS: 5.0, d.EXCESS: 0.2}).estimates
    assert (one.name, one.value, one.unit, one.origin) == (d.STIFFNESS, 5.0, "N/mm", "default")
    assert (two.name, two.value, two.unit) == (d.EXCESS, 0.2, QUANTITIES[d.EXCESS].unit)


@pytest.mark.parametrize("fitted", [None, "fitted"])
def test_a_fit_is_of_the_dynamic_model_with_what_is_freed(monkeypatch, fitted):
    asked = {}

    def prepare_fit(initial, fixed, runs, **how):
        asked.update(initial=initial, fixed=fixed, runs=runs, **how)
        return "problem"

    solved = SimpleNamespace(fitted=fitted)
    monkeypatch.setattr(d, "prepare_fit", prepare_fit)
    monkeypatch.setattr(d, "solve_fit", {"problem": solved}.__getitem__)
    step = Counted()
    found = d._solved("initial", "fixed", ["run"], (d.VISCOUS,), step)
    assert asked == {
        "initial": "initial", "fixed": "fixed", "runs": ["run"], "dynamics": "lugre",
        "further": (d.VISCOUS,),
    }  # fmt: skip
    assert (step.total, step.done) == (1, 1)
    if fitted is None:
        assert found is None
    else:
        assert (found.fit, found.fitted) == (solved, "fitted")


def test_looks_are_counted_as_they_are_made(monkeypatch):
    monkeypatch.setattr(d, "residuals_with", lambda fit, values: np.array([2.0, 1.0]))
    monkeypatch.setattr(d, "slopes_of_free", lambda fit: np.array([[1.0], [0.0]]))
    linear = SimpleNamespace(rigs=[TABLE_1])
    for looks, count in (
        (lambda step: d._sizes(linear, d.STIFFNESS, step), 14),
        (lambda step: d._sizes(linear, d.VISCOUS, step), 7),
        (lambda step: d._friction_at_rest(linear, step), 17),
    ):
        step = Counted()
        assert len(looks(step)) == count
        assert (step.total, step.done) == (count, count)


def test_only_names_that_are_free_are_free():
    fit = SimpleNamespace(free=[SimpleNamespace(name=d.VISCOUS)])
    assert d._is_free(fit, d.VISCOUS)
    assert not d._is_free(fit, d.STIFFNESS)


FITTED = Fitted(np.zeros(1), np.array([3.0]), np.array([2.0]), np.zeros(1, bool), True, "", 1)


def look(name, value, saves, move=0.0):
    return d.Look({name: value}, np.array([move]), saves)


def made(label, free=(), sentences=()):
    """A fit whose only unknown is its name; estimates of it say its widened error."""
    fit = SimpleNamespace(
        label=label,
        free=[SimpleNamespace(name=name) for name in free],
        problem=SimpleNamespace(ids=["a"]),
        model=Model(()),
        cannot_tell=list(sentences),
    )
    return d.Solved(fit, FITTED)


@pytest.fixture
def steps(monkeypatch):
    """Run the dynamic fit on made-up steps; return what it found, and in which order they came."""

    def run(first, better=None, fixed=None, rest=None, damped=None, *, sizes=None, finest=1e9):
        log = []

        def solved(start, kept, runs, further, step):
            log.append(("first", start, kept, runs, further))
            return first

        def freed(at, looks, step):
            log.append((looks if looks == "at rest" else "dampings", at.fit.label))
            return rest if looks == "at rest" else damped

        def named(name, answer):
            def taken(at, step):
                log.append((name, at.fit.label))
                return answer

            return taken

        def looked(fit, name, step):
            log.append((f"looked at {name}", fit.label))
            return (sizes or {}).get(name, [look(name, 1.0, 0.0)])

        monkeypatch.setattr(d, "_solved", solved)
        monkeypatch.setattr(d, "_from_better_stiffness", named("better", better))
        monkeypatch.setattr(d, "_at_stiffness", named("fixed", fixed))
        monkeypatch.setattr(d, "_friction_at_rest", lambda fit, step: "at rest")
        monkeypatch.setattr(d, "_freed", freed)
        monkeypatch.setattr(d, "_sizes", looked)
        monkeypatch.setattr(d, "_static_friction_note", lambda looks: f"unseen {looks}")
        monkeypatch.setattr(d, "_finest_stiffness", lambda fit: finest)
        monkeypatch.setattr(d, "misfit", lambda fit: [f"{fit.label} misses"])
        monkeypatch.setattr(
            d,
            "_indistinguishable_note",
            lambda name, like: f"{name}: {[v for one in like for v in one.values.values()]}",
        )
        monkeypatch.setattr(
            d,
            "estimates_of",
            lambda told, fitted, ids: [
                Estimate("preload_N", 1.0, "N", "fitted", ids[0], float(fitted.stderr[0]))
            ],
        )
        return d.dynamic_fit(NOMINAL, [RUN, "b"], Counted()), log

    return run


EVERYTHING = (d.STIFFNESS, d.DAMPING, d.VISCOUS)


def test_it_begins_with_the_bristles_of_the_paper_and_a_little_viscous_friction(steps):
    found, log = steps(None)
    assert (found.model, found.fitted, found.cannot_tell, found.misfit) == (NOMINAL, None, (), ())
    ((_, start, kept, runs, further),) = log
    assert start.value(d.STIFFNESS) == TABLE_1.bristles.stiffness_N_per_mm
    assert start.value(d.VISCOUS) == QUANTITIES[d.VISCOUS].size
    assert start.value("friction_coefficient") == 0.1
    assert kept is NOMINAL
    assert runs == [RUN, "b"]
    assert further == [d.STIFFNESS, d.VISCOUS]


def test_each_step_goes_on_from_the_one_before(steps):
    first, better, fixed, rest, damped = (
        made(label, EVERYTHING) for label in ("first", "better", "fixed", "rest", "damped")
    )
    found, log = steps(first, better, fixed, rest, damped)
    assert [entry for entry in log[1:] if "looked" not in entry[0]] == [
        ("better", "first"),
        ("at rest", "better"),
        ("dampings", "rest"),
    ]
    assert found.misfit == ("damped misses",)
    assert found.cannot_tell == ()
    _, log = steps(first, None, fixed)
    assert [entry for entry in log[1:] if "looked" not in entry[0]] == [
        ("better", "first"),
        ("fixed", "first"),
        ("at rest", "fixed"),
        ("dampings", "fixed"),
    ]
    found, log = steps(first)
    assert ("at rest", "first") in log
    assert found.misfit == ("first misses",)
    assert found.cannot_tell == ("unseen at rest",)


def test_what_fits_alike_is_said_of_what_is_fixed(steps):
    """Within 25 squares of the best; a stiffness too fine for the mesh may be any such."""
    sizes = {
        d.STIFFNESS: [
            look(d.STIFFNESS, v, s) for v, s in ((1, 0), (2, 74.9), (3, 75.1), (4, 100), (50, 9))
        ],
        d.DAMPING: [look(d.DAMPING, v, s) for v, s in ((5, 10.0), (90, -20.0))],
        d.VISCOUS: [look(d.VISCOUS, v, s) for v, s in ((6, 10.0), (7, -14.9))],
    }
    first = made("first", sentences=["said"])
    found, _ = steps(first, sizes=sizes, finest=50.0)
    assert list(found.cannot_tell) == [
        "said",
        "unseen at rest",
        f"{d.STIFFNESS}: [3, 4, 50]",
        f"{d.DAMPING}: [5]",
        f"{d.VISCOUS}: [6, 7]",
    ]
    found, log = steps(made("first", (d.DAMPING, d.VISCOUS)), sizes=sizes, finest=51.0)
    assert found.cannot_tell[1:] == (f"{d.STIFFNESS}: [3, 4]",)
    assert [entry for entry in log if entry[0].startswith("looked")] == [
        (f"looked at {d.DAMPING}", "first"),  # where to begin with it
        (f"looked at {d.STIFFNESS}", "first"),
    ]


def test_intervals_allow_for_what_fits_alike(steps):
    """Moves of 8 and 6 for a t of 2: √(3² + 4² + 3²)."""
    sizes = {
        d.STIFFNESS: [look(d.STIFFNESS, 1.0, 0.0, -8.0), look(d.STIFFNESS, 2.0, -30.0, 99.0)],
        d.VISCOUS: [look(d.VISCOUS, 1.0, 0.0, 6.0)],
    }
    found, _ = steps(made("first", (d.DAMPING,)), sizes=sizes)
    assert found.fitted.stderr == pytest.approx([np.sqrt(34.0)])
    assert found.model.estimate("preload_N", "a").stderr == pytest.approx(np.sqrt(34.0))
