"""The first paper's methods as published."""
