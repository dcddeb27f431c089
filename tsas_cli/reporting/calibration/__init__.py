"""What a calibration says: its sections on stiffness, transfer and parameters."""
