"""The settings of a closed loop."""

import tomlkit

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Scratch, answer
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.tracking.settings import Settings, printed_gains, read_settings

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 6
WORDS = (b"[controllers.adaptive-sliding-mode]", b"[loop]", b"phi = [", b"[reference]")
_scratch = Scratch()


def one(data):
    """Settings that are taken give each controller its laws."""
    settings: Settings | None = answer(read_settings, _scratch.file("settings.toml", data))
    if settings is None:
        return
    printed_gains(settings)
    for controller in CONTROLLERS:
        settings.controllers.laws(controller, 1.0)
    settings.drive.kinematic()


def seeds():
    yield tomlkit.dumps(Settings().model_dump(mode="json", by_alias=True)).encode()
    yield b"[reference]\nmean_N = 40\n[controllers.pid]\nproportional_rpm_per_mm = 2.0\n"
