"""Recordings that hold the same samples as others: found, said, and counted once.

Two runs that repeat a motion have noise of their own; copies share it. So a stretch of one run is a
copy of another where every sample of every channel lies on the other's samples, or on the line
(straight or a cubic spline) through them, to within a twentieth of the noise, for so long that no
repeat would.
"""
