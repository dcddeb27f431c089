"""Laws of unnamed origin: what describes a residual that no proven cause explains."""

# The displacement that each law follows.
FOLLOWS = {"drive_law": "x_in_mm", "tendon_law": "x_in_mm", "load_law": "x_out_mm"}

# The fields that the laws of the drive and of the tendon begin with, in a row.
TRAVEL, LOW, HIGH, SLOW, FAST = range(5)
