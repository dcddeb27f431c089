"""What a dynamic fit says of values that fit alike, and how far intervals allow for them."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.counted import Counted
from tsas_cli.identification import dynamic_fit as d
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.model import Model
from tsas_cli.recordings.manifest import Run

RUN = SimpleNamespace(run=Run(id="a", file="a.parquet", sha256="0" * 64))
FITTED = Fitted(np.zeros(1), np.array([3.0]), np.array([2.0]), np.zeros(1, bool), True, "", 1)


def look(name, value, saves, move=0.0):
    return d.ScreenedValue({name: value}, np.array([move]), saves)


@pytest.fixture
def found(monkeypatch):
    """Run the dynamic fit on a first fit that no step betters, and on looks that are made up."""

    def run(sizes, free=(), sentences=(), *, finest=1e9):
        fit = SimpleNamespace(
            free=[SimpleNamespace(name=name) for name in free],
            problem=SimpleNamespace(ids=["a"]),
            model=Model(()),
            cannot_tell=list(sentences),
        )
        for better in ("_from_better_stiffness", "_at_stiffness", "_freed"):
            monkeypatch.setattr(d, better, lambda *_: None)
        monkeypatch.setattr(d, "_solved", lambda *_: d.Solved(fit, FITTED))
        monkeypatch.setattr(d, "_friction_at_rest", lambda fit, step: "at rest")
        monkeypatch.setattr(d, "_static_friction_note", lambda looks: f"unseen {looks}")
        monkeypatch.setattr(d, "_finest_stiffness", lambda fit: finest)
        monkeypatch.setattr(d, "misfit", lambda fit: [])
        monkeypatch.setattr(
            d, "_sizes", lambda fit, name, step: sizes.get(name, [look(name, 1.0, 0.0)])
        )
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
        return d.dynamic_fit(Model(()), [RUN], Counted())

    return run


def test_what_fits_alike_is_said_of_what_is_fixed(found):
    """Within 25 squares of the best; a stiffness too fine for the mesh may be any such."""
    sizes = {
        d.STIFFNESS: [
            look(d.STIFFNESS, v, s) for v, s in ((1, 0), (2, 74.9), (3, 75.1), (4, 100), (50, 9))
        ],
        d.DAMPING: [look(d.DAMPING, v, s) for v, s in ((5, 10.0), (90, -20.0))],
        d.VISCOUS: [look(d.VISCOUS, v, s) for v, s in ((6, 10.0), (7, -14.9))],
    }
    assert list(found(sizes, sentences=["said"], finest=50.0).cannot_tell) == [
        "said",
        "unseen at rest",
        f"{d.STIFFNESS}: [3, 4, 50]",
        f"{d.DAMPING}: [5]",
        f"{d.VISCOUS}: [6, 7]",
    ]
    other = found(sizes, (d.DAMPING, d.VISCOUS), finest=51.0)
    assert other.cannot_tell[1:] == (f"{d.STIFFNESS}: [3, 4]",)


def test_intervals_allow_for_what_fits_alike(found):
    """Moves of 8 and 6 for a t of 2: √(3² + 4² + 3²)."""
    sizes = {
        d.STIFFNESS: [look(d.STIFFNESS, 1.0, 0.0, -8.0), look(d.STIFFNESS, 2.0, -30.0, 99.0)],
        d.VISCOUS: [look(d.VISCOUS, 1.0, 0.0, 6.0)],
    }
    fit = found(sizes, (d.DAMPING,))
    assert fit.fitted.stderr == pytest.approx([np.sqrt(34.0)])
    assert fit.model.estimate("preload_N", "a").stderr == pytest.approx(np.sqrt(34.0))
