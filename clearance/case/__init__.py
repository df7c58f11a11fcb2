"""What is asked: case files read into a `Case`, tolerances, new cases. Not for: other formats."""
