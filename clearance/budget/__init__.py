"""What the tolerances of a case leave of its clearances: proven, expected, and which of them takes how much.

Not for: the tolerances themselves (`world.budget`), reading them (`formats`), or judging by them (`findings`).
"""
