"""Studies of the program: the blind benchmark, and the source paper computed again."""
