"""A user's project: the Makefile pipelines and the files that `tsas init` writes."""
