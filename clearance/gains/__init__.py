"""The least change to a case that makes every rule hold, proven, and what no change can reach.

Not for: measuring (`run`), what a clearance changes by (`simulate.answers.approaches`).
"""
