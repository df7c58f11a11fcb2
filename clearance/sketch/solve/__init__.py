"""Running a construction plan: closed steps by ruler and compass, numeric clusters by search."""
