"""What is drawn, one kind of plot per file."""
