"""What the commands do, as functions: one file per verb, used by the commands themselves."""
