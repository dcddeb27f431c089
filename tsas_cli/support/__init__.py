"""What every floor leans on: files whole or absent, limits, errors, progress, stopping."""

__version__ = "0.1.0"
