"""How many numbers lie in one register (`lanes`), so how many children a node of a tree has."""

WIDTH = 4
