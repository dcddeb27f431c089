"""A virtual rig of its own, which shares no code with the product's model (README.md)."""
