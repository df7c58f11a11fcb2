"""Bodies that move: kinematics, clearance of every step, a proven bound between the steps."""
