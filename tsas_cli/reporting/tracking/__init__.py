"""Tracking: the section, its parts and figures."""
