"""Many calls of a stage: a plan, its tasks, who does them, and the table of what came out."""
