"""The constraint graph: what depends on what, and the construction plan."""
