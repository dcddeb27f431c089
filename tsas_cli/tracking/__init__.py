"""Tracking of a wanted force: settings, references, runs of the closed loop, and their scores."""

SHAPE_NAMES = ("sine", "two-frequency", "steps", "ramps")  # of a reference
