"""Limits on the memory and time that reading a file may take."""
