"""The page of a comparison: two models side by side."""
