"""The nominal rig and what it does: four models, over shared ends, sensors and parameters."""
