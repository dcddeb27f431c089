"""What the stages have written, as later ones read it: one file per stage (docs/formats.md)."""
