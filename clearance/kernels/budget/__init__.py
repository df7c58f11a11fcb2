"""What errors of a machine leave of distances, proven: compiled. Not for: the errors (`clearance.budget`)."""
