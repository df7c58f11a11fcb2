"""Two curves: Hausdorff distance and least distance, certified."""
