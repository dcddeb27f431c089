"""Whether files are still what was recorded of them, from a page back to the raw recordings."""
