"""Laws of unnamed origin: what describes a residual that no proven cause explains."""
