"""Tracking of a wanted force: settings, references, runs of the closed loop, and their scores."""
