"""What keeps a file from taking more memory or time than one of its size may."""
