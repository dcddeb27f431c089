"""Faults of the recordings that show only beside a model: one run, or one clock, is different."""
