"""What is searched: one file per reader, with `one(data)` and `seeds()`."""
