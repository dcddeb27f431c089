"""The parts of the section on the diagnosis, one file each."""
