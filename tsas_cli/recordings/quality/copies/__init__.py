"""Recordings that hold samples of other recordings: found, reported, and counted once.

Two runs that repeat a motion have independent noise; copies share it. A stretch of one run is a
copy of another if every sample of every channel agrees with the other's samples, or with their
linear or cubic-spline interpolation, to within a twentieth of the noise, for longer than a repeat
could.
"""
