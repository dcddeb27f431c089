"""A coverage-guided search for input on which a reader breaks a rule (docs/fuzzing.md)."""
