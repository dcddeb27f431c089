"""The seam to Rerun, the only importer of it: a recorder of entities, and the layout of the viewer.

What is recorded and why is said elsewhere; nothing here knows a tendon.
"""

from tsas_cli.reporting.stream.recorder import quiet  # noqa: F401  before all others
from tsas_cli.reporting.stream.recorder.clock import Clock, Times
from tsas_cli.reporting.stream.recorder.opened import to_file, to_viewer
from tsas_cli.reporting.stream.recorder.recorder import Recorder

__all__ = ["Clock", "Recorder", "Times", "to_file", "to_viewer"]
