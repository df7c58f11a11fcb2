"""Distances that errors of a machine leave, proven: compiled. Not for: the errors (`clearance.budget`)."""
