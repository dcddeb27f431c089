"""The Rerun stream: what was measured and simulated, over time, to look at in the viewer."""

import os

_LOGGED = "RUST_LOG" in os.environ
os.environ.setdefault("RUST_LOG", "off")  # what Rerun cannot do is raised, and said in our words
import rerun  # noqa: E402, F401  it looks at the environment once

if not _LOGGED:  # for the viewer, which is a process of its own
    del os.environ["RUST_LOG"]

from tsas_cli.reporting.stream.stream import STREAM_FILE, Stream, stream_of, write_stream  # noqa: E402

__all__ = ["STREAM_FILE", "Stream", "stream_of", "write_stream"]
