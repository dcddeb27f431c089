"""Rerun's viewer, a program of its own: started here, shown in a window or a browser, and ended."""
