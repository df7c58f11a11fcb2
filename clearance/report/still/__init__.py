"""The worst moment standing still: as a picture, and as a GLB file. Not for: the whole motion (`page`, `view`)."""
