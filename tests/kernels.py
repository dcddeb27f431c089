"""Make the machine code that takes longest: `python -m tests.kernels calibrate` or `track`."""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import tsas_cli as tsas

GROUPS = Path(__file__).parents[1] / "datasets" / "paper-groups"


def calibrate() -> None:
    """Make the code of fits, with the slip chain and with the dynamic one."""
    tsas.calibrate(GROUPS, runs=["a"], dynamics="lugre")


def track() -> None:
    """Make the code of a closed loop with either plant."""
    with TemporaryDirectory() as folder:
        settings = Path(folder) / "short.toml"
        settings.write_text("[reference]\nduration_s = 1.0\n", encoding="utf-8")
        for dynamics in ("slip", "lugre"):
            tsas.track(settings=settings, dynamics=dynamics)


if __name__ == "__main__":
    {"calibrate": calibrate, "track": track}[sys.argv[1]]()
