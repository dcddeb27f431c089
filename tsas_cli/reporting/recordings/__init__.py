"""The recordings, what the checks say of them, and their loops."""
