"""Planar curves: arcs, Bezier pieces, biarcs, nearest points."""
