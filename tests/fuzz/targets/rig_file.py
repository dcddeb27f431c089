"""The file of planned runs."""

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Scratch, answer
from tsas_cli.diagnosis.rig_file import read_rig_file

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 25
WORDS = (b"[[run]]", b"[sensors]", b"[limits]", b'"nested"', b'"chirp"', b"frequency_Hz")
_scratch = Scratch()


def one(data):
    """A plan that is taken says the speed of each run."""
    file = answer(read_rig_file, _scratch.file("rig.toml", data))
    for run in file.run if file is not None else ():
        _ = run.speed


def seeds():
    run = "sheath_length_mm = 785.0\ntotal_bend_rad = 3.1\npreload_N = 25.0\namplitude_mm = 10.0\n"
    yield f"""format = 1
kind = "plan"
name = "bench"
[rig]
tendon_diameter_mm = 1.2
[sensors]
rate_Hz = 200
x_in_mm = 0.01
f_in_N = 0.1
[limits]
amplitude_mm = 10.0
preload_N = [15.0, 40.0]
[[run]]
id = "a"
motion = "sine"
frequency_Hz = 0.16
periods = 6
{run}
[[run]]
id = "b"
motion = "nested"
speed_mm_per_s = 20.0
dwell_s = 0.5
{run}""".encode()
