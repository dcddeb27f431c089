"""Everything that makes a real rig differ from the nominal one, one file each."""
