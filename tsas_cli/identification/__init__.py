"""From recordings to parameters with honest intervals."""
