"""What a better model is worth in tracking: the section, its parts and figure."""
