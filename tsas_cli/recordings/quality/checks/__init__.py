"""The checks, one per file; `tsas_cli.recordings.quality.CHECKS` lists them in order."""
