"""What is wrong with recordings, found before anyone fits anything."""
