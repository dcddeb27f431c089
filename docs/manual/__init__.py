"""The site of the documentation: `python -m docs.manual` builds it from the repository."""
