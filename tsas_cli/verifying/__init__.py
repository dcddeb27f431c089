"""Verification of recorded checksums, from a report back to the raw recordings."""
