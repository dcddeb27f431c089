"""Vectors only, no physics."""
