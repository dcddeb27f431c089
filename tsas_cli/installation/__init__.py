"""What is installed here, and what that allows, told with as few imports as can be."""
