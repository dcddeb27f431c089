"""tsas: from recordings of a tendon-sheath rig to a model whose errors have names.

What the commands do, for notebooks and programs: `import tsas_cli as tsas`, then `tsas.read`,
`tsas.check`, `tsas.calibrate`, `tsas.simulate`, `tsas.diagnose`, `tsas.track` and the others
(docs/python.md). Each loads its libraries when it is asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from tsas_cli.support import __version__ as __version__

if TYPE_CHECKING:
    from tsas_cli.stages.calibrate import calibrate
    from tsas_cli.stages.catalogue import catalogue, explain
    from tsas_cli.stages.check import check
    from tsas_cli.stages.compare import compare
    from tsas_cli.stages.diagnose import diagnose
    from tsas_cli.stages.export import export
    from tsas_cli.stages.identify_harmonic_drive import identify_harmonic_drive
    from tsas_cli.stages.ingest import guess, ingest
    from tsas_cli.stages.plan import plan
    from tsas_cli.stages.predict import predict
    from tsas_cli.stages.read import read, read_drive, read_model
    from tsas_cli.stages.report import report
    from tsas_cli.stages.runs import runs
    from tsas_cli.stages.simulate import simulate
    from tsas_cli.stages.sweep import sweep
    from tsas_cli.stages.track import track
    from tsas_cli.stages.upload import upload
    from tsas_cli.stages.verify import verify
    from tsas_cli.support.errors import InputError
    from tsas_cli.support.steps import Steps
    from tsas_studies.closing.close_loop import close_loop
    from tsas_studies.reproduction.reproduce import reproduce

__all__ = [
    "InputError",
    "Steps",
    "calibrate",
    "catalogue",
    "check",
    "close_loop",
    "compare",
    "diagnose",
    "explain",
    "export",
    "guess",
    "identify_harmonic_drive",
    "ingest",
    "plan",
    "predict",
    "read",
    "read_drive",
    "read_model",
    "report",
    "reproduce",
    "runs",
    "simulate",
    "sweep",
    "track",
    "upload",
    "verify",
]

_ELSEWHERE = {
    "InputError": "tsas_cli.support.errors",
    "Steps": "tsas_cli.support.steps",
    "close_loop": "tsas_studies.closing.close_loop",
    "explain": "tsas_cli.stages.catalogue",
    "guess": "tsas_cli.stages.ingest",
    "read_drive": "tsas_cli.stages.read",
    "read_model": "tsas_cli.stages.read",
    "reproduce": "tsas_studies.reproduction.reproduce",
}


def __getattr__(name: str) -> Any:
    """Load what is asked for; what it needs loads with it, and nothing else."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from tsas_cli.support.limits import loadable

    loadable()
    module = import_module(_ELSEWHERE.get(name, f"tsas_cli.stages.{name}"))
    found = getattr(module, name)
    if not isinstance(found, type) and not hasattr(found, "__wrapped__"):
        from tsas_cli.stages.given import checked

        setattr(module, name, found := checked(found))  # where pickle looks for it
    return found


def __dir__() -> list[str]:
    """Return what `tsas.` is completed with."""
    return [*__all__, "__version__"]
