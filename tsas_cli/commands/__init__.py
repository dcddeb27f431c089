"""The subcommands: parse the arguments, call a stage, print the result."""
