"""The file of a model."""

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Broken, Scratch, answer
from tsas_cli.identification.model import CORRECTION, Model
from tsas_cli.identification.model_file import read_model, write_model
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.manifest import Run

__all__ = ["WORDS", "mutate", "one", "seeds"]
RUN = Run(id="a", file="a.parquet", sha256="0" * 64, preload_N=25.0, total_bend_rad=3.1)
SHARE = 5
WORDS = (b"[parameters.", b"[effects.", b"[bristles.", b"[runs.a.", b'origin = "fitted"')
_scratch = Scratch()


def one(data):
    """A model that is taken makes a rig, and one in eight is the same written and read again."""
    model: Model | None = answer(read_model, _scratch.file("model.toml", data))
    if model is None:
        return
    answer(model.rig, RUN)
    if len(data) % 8:  # writing takes ten times as long as reading
        return
    path = _scratch.folder / "again.toml"
    write_model(path, model, version="0", dataset={})
    again = read_model(path)
    if _plain(again) != _plain(model):
        raise Broken(f"{model} is {again} when it is read again")


def _plain(model: Model) -> list[str]:
    return sorted(repr(estimate) for estimate in model.estimates)


def seeds():
    head = 'format = 1\nkind = "model"\nversion = "0.1.0"\n[dataset]\nname = "bench"\n'
    value = (
        "value = {}\nunit = {!r}\nstderr = 0.1\ninterval_low = 0.0\ninterval_high = 1e3\n"
        'at_bound = false\norigin = "fitted"\n'
    )
    shared = "".join(
        f"[parameters.{name}]\n{value.format(1.0, QUANTITIES[name].unit)}"
        for name in ("friction_coefficient", "load_stiffness_N_per_mm", "tendon_stiffness_N")
    )
    own = f"[runs.a.preload_N]\n{value.format(25.0, 'N')}"
    yield f"{head}{shared}{own}[parameters.{CORRECTION}]\n{value.format(0.1, 'N')}".encode()
    effects = "".join(
        f"[{'' if name.startswith('bristles') else 'effects.'}{name}]\n"
        f"value = {q.lower!r}\nunit = {q.unit!r}\n"
        for name, q in QUANTITIES.items()
        if "." in name
    )
    yield f"{head}{effects}".encode()
