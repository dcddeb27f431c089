"""What is installed here, and what that allows: for `tsas doctor`, with as few imports as can be."""
