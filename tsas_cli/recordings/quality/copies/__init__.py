"""Recordings that hold samples of other recordings: found, reported, and counted once.

Two runs that repeat a motion have independent noise; copies share it. Every row has a hash of its
channels' values, rounded to what both runs resolve. A stretch of one run is a copy of another if
its hashes are those of the other's rows at one shift of the clock, for longer than a repeat's could
be.
"""
