"""Diagnosis of a calibrated model: residual maps, missing effects, evidence, reductions."""
