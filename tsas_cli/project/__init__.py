"""A project of a person's own: the Makefile pipelines and the files that `tsas init` writes."""
