"""Geometric constraints: equations, the graph they make, and how it is solved."""
