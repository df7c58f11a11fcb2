"""Files in and out, each format strict: robots, scenes, meshes, trajectories, poses, clouds. Not for: cases."""
