"""Robot programs: straight lines, arcs and joint moves of a tool as joint paths with a proven greatest
deviation."""
