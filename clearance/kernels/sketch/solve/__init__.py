"""Running a construction plan: closed steps, numeric clusters, all roots."""
