"""The parts of the page's section on what a better model is worth in tracking."""
