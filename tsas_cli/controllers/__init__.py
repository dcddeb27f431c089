"""Controllers of the drive with feedback of x_in alone, and the closed loop with the plant."""

CONTROLLERS = ("pid", "sliding-mode", "adaptive-sliding-mode", "disturbance-observer")
