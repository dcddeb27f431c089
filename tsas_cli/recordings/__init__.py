"""What a user brings: columns and units, the manifest, readers, quality checks."""
