"""The seam to Rerun: a recorder of entities into a file or a viewer, and the viewer's layout.

What is recorded and why is said elsewhere; nothing here knows a tendon.
"""

from tsas_cli.reporting.stream.recorder.opened import to_file, to_viewer
from tsas_cli.reporting.stream.recorder.recorder import Recorder
from tsas_cli.reporting.stream.recorder.times import Times, times_of

__all__ = ["Recorder", "Times", "times_of", "to_file", "to_viewer"]
