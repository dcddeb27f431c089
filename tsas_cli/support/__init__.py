"""Common infrastructure: atomic outputs, limits, errors, progress, signals."""

__version__ = "0.1.0"
