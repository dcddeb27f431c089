"""The installation and its capabilities, inspected with few imports."""
