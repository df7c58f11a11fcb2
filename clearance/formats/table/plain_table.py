"""Short tables of plain decimal numbers, read in one go; of all others it says that it does not know.

Not for: what is wrong with a table, and long ones (`csv_table`).
"""

from __future__ import annotations

import numpy as np

from clearance.kernels.arithmetic.decimal_text import NOT_READ, read_decimals


def plain_numbers(
    content: bytes, n_lines: int, n_columns: int, delimiter: str, decimal: str
) -> np.ndarray | None:
    """(n, `n_columns`) the numbers in a text, or None where it is not plainly such a table.

    Args:
        n_lines: that come before the numbers.

    Exactness: each is the double nearest to what is written.
    """
    if b"\r" in content and content.count(b"\r") != content.count(b"\r\n"):
        return None  # a line may end without a newline
    start = 0
    for _ in range(n_lines):
        start = content.find(b"\n", start) + 1
        if not start:
            return None
    most = (len(content) - start) // (2 * n_columns) + 1  # a number is a digit and what ends it
    found = np.empty((most, n_columns))
    text = np.frombuffer(content, dtype=np.uint8)
    n_rows = read_decimals(text, start, ord(delimiter), ord(decimal), found)
    return None if n_rows == NOT_READ else found[:n_rows]
