"""Many calls of a stage: a plan, its tasks, their execution, and the table of results."""
