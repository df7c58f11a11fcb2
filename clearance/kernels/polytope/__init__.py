"""Convex polytopes: cutting, common parts, depth, volume."""
