"""From recordings to parameters with confidence intervals."""
