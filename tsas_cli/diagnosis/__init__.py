"""What a calibrated model gets wrong: where, why, what names it, and what it would gain."""
