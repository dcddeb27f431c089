"""The tendon of a run: in space with its tensions, along the sheath, and in the loop."""
