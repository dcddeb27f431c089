"""The diagnosis: the section and its parts, one file each."""
