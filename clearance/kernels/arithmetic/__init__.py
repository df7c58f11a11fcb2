"""Exact and vectorised numbers: points, lanes, double-double numbers, expansions, exact signs, union-find."""
