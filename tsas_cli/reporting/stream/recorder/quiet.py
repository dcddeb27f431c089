"""Rerun, loaded without its own log: what it cannot do is raised, and said in one line of ours."""

import os

TOLD = "RUST_LOG" in os.environ
os.environ.setdefault("RUST_LOG", "off")

import rerun  # noqa: E402, F401  it looks at the environment once

if not TOLD:  # for the viewer, which is a process of its own
    del os.environ["RUST_LOG"]
