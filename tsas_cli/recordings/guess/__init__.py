"""A map proposed from the names, the units and the signals of files."""
