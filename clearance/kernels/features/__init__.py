"""Two faces: bounds on their distance, the nearest features, whether they meet."""
