"""The subcommands: parse, read, one call, write, print."""
