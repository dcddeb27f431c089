"""Controllers of the drive that see x_in alone, and the closed loop with plant and sensors."""

CONTROLLERS = ("pid", "sliding-mode", "adaptive-sliding-mode", "disturbance-observer")
