"""Exact and vectorised numbers: points, lanes, wide numbers, expansions, exact signs, union-find."""
