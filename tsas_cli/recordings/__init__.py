"""Recordings: columns and units, the manifest, readers, quality checks."""
