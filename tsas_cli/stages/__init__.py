"""What the commands do, as functions: one file per verb, with its result and what it writes."""
