"""The nominal rig: parameters, static capstan model, slip chain."""
