"""The checks by subject, a function each; `tsas_cli.recordings.quality.CHECKS` lists them."""
