"""Two robots whose clocks are not tied: all pairs of their times that can occur together."""
