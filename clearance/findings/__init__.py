"""What each rule of a run comes to between which bodies: findings that keep their names from run to run.

Not for: measuring (`simulate`), and how findings look on a page, in a terminal or in JUnit (`report`).
"""
