"""Curves in the plane: exact distances between them. Not for: solids, sketches, files other than DXF."""
