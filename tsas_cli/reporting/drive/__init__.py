"""The drive's section and its figures."""
