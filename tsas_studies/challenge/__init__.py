"""The blind benchmark: sealed recordings of an independent rig, and scores of the answers."""
