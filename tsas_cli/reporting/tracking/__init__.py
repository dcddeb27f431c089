"""The parts of the page's section on tracking, one file each."""
