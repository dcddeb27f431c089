"""The nominal rig and its models: four solvers with shared ends, sensors and parameters."""
