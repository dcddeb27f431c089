"""Make the machine code that takes longest, that of fits, of streams and of closed loops."""

from pathlib import Path
from tempfile import TemporaryDirectory

import tsas_cli as tsas
from tsas_cli.app import app

GROUPS = Path(__file__).parents[1] / "datasets" / "paper-groups"
MODELS = ("--dynamics=static", "--dynamics=slip", "--nodes=20", "--dynamics=lugre")


def main() -> None:
    """Use every model, with profiles along the tendon and without."""
    with TemporaryDirectory() as folder:
        out = Path(folder)
        settings = out / "short.toml"
        settings.write_text("[reference]\nduration_s = 1.0\n", encoding="utf-8")
        tsas.calibrate(GROUPS, runs=["a"], dynamics="lugre")
        for dynamics in ("slip", "lugre"):
            tsas.track(settings=settings, dynamics=dynamics)
        for model in MODELS:
            call = ["simulate", str(GROUPS), "--runs=a", model, "--rrd", "--quiet"]
            app([*call, f"--out={out / model}"], prog_name="tsas", standalone_mode=False)


if __name__ == "__main__":
    main()
