"""A map proposed from what files show: names, units and the look of the signals."""
