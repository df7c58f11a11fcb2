"""A record put into files that people and programs read. Not for: measuring or judging anything.

Nothing is imported here: a run that writes no report takes the verdict and no page.
"""
