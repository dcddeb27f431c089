"""From diagnosis to tracking: whether a better model tracks better."""
