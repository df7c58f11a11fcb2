"""Swept profiles: the outline that a motion sweeps in a plane; sketches fitted to it; two of them compared."""
