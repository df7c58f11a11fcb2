"""What the tolerances of a case leave of its clearances: proven, expected, and which of them takes how much."""
