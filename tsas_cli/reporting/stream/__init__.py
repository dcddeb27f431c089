"""The Rerun stream: what was measured and simulated, over time, to look at in the viewer."""

from tsas_cli.reporting.stream.stream import FILE, Stream, stream_of, write_stream

__all__ = ["FILE", "Stream", "stream_of", "write_stream"]
