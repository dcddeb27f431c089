"""The checks, one file each; `tsas_cli.recordings.quality.CHECKS` lists them in order."""
