"""tsas: from recordings of a tendon-sheath rig to a model whose errors have names.

What the commands do, for notebooks and programs: `import tsas_cli as tsas`, then `tsas.read`,
`tsas.check`, `tsas.calibrate`, `tsas.simulate`, `tsas.diagnose`, `tsas.track` and the others
(docs/python.md). Each loads its libraries when it is asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from tsas_cli.api.calibrate import calibrate
    from tsas_cli.api.catalogue import catalogue, explain
    from tsas_cli.api.check import check
    from tsas_cli.api.close_loop import close_loop
    from tsas_cli.api.compare import compare
    from tsas_cli.api.diagnose import diagnose
    from tsas_cli.api.guess import guess
    from tsas_cli.api.identify_harmonic_drive import identify_harmonic_drive
    from tsas_cli.api.ingest import ingest
    from tsas_cli.api.plan import plan
    from tsas_cli.api.read import read, read_drive, read_model
    from tsas_cli.api.report import report
    from tsas_cli.api.reproduce import reproduce
    from tsas_cli.api.runs import runs
    from tsas_cli.api.simulate import simulate
    from tsas_cli.api.sweep import sweep
    from tsas_cli.api.track import track
    from tsas_cli.api.upload import upload
    from tsas_cli.api.verify import verify
    from tsas_cli.errors import InputError
    from tsas_cli.steps import Steps

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
    "guess",
    "identify_harmonic_drive",
    "ingest",
    "plan",
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
    "InputError": "tsas_cli.errors",
    "Steps": "tsas_cli.steps",
    "explain": "tsas_cli.api.catalogue",
    "read_drive": "tsas_cli.api.read",
    "read_model": "tsas_cli.api.read",
}


def __getattr__(name: str) -> Any:
    """Load what is asked for; what it needs loads with it, and nothing else."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_ELSEWHERE.get(name, f"tsas_cli.api.{name}")), name)


def __dir__() -> list[str]:
    """Return what `tsas.` is completed with."""
    return [*__all__, "__version__"]
