"""Tables of decimal numbers in text: each the double nearest to what is written, or the table is left alone.

Numbers of up to 19 digits whose last stands for 10^-22 to 10^22 are read. Not for: whatever else may stand in a
table, as quotes, words, nan, and faults: a reader that can tell them takes such a table as a whole.
"""

import numpy as np

from clearance.compile.declared import Bytes, Floats2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.expansion import two_product

TENS = np.array([float(10**k) for k in range(23)])
"""The powers of ten that are doubles."""

NOT_READ = -1

_MOST = np.uint64((2**64 - 2058) // 10)
"""A number up to this has room for one more digit, and for its rounding, below 2^64."""

_EXACT = np.uint64(2**53)
_NEAR = 2.0**-48
_LF, _CR, _TAB, _SPACE, _PLUS, _MINUS, _POINT_E, _BIG_E, _ZERO, _NINE = (
    10, 13, 9, 32, 43, 45, 101, 69, 48, 57,
)  # fmt: skip


@inline
def _nearest_quotient(digits, power):
    """The double nearest to `digits` / `power`, or nan where that is not decided.

    Exactness: the quotient of the leading part is right to half its last place, its remainder is a double, and so
    is the rest of the digits; what is added is right to 2^-51 of itself, and both ends of twice that round alike.
    """
    high = float(digits)
    back = np.uint64(high)
    low = float(digits - back) if digits >= back else -float(back - digits)
    quotient = high / power
    product, rest = two_product(quotient, power)
    added = (((high - product) - rest) + low) / power
    least = quotient + (added - _NEAR * abs(added))
    most = quotient + (added + _NEAR * abs(added))
    return least if least == most else np.nan


@inline
def _value(digits, exponent):
    """The double nearest to digits 10^exponent, or nan where that is not decided."""
    if exponent < -22 or exponent > 22:
        return np.nan
    if digits <= _EXACT:
        value = float(digits)
        return value * TENS[exponent] if exponent >= 0 else value / TENS[-exponent]
    return np.nan if exponent >= 0 else _nearest_quotient(digits, TENS[-exponent])


@inline
def _is_blank(c):
    return c == _SPACE or c == _TAB


@inline
def _past_blanks(text, i):
    while i < len(text) and _is_blank(text[i]):
        i += 1
    return i


@inline
def _exponent(text, i):
    """(the exponent at `i`, what follows it); -1 for what follows where there is none."""
    sign = 1
    if i < len(text) and (text[i] == _MINUS or text[i] == _PLUS):
        sign = -1 if text[i] == _MINUS else 1
        i += 1
    start, value = i, 0
    while i < len(text) and _ZERO <= text[i] <= _NINE and i - start < 4:
        value = 10 * value + np.int64(text[i]) - _ZERO
        i += 1
    return sign * value, (i if i > start else -1)


@inline
def _number(text, i, point):
    """(the number at `i`, what follows it); nan where it is not read."""
    negative = text[i] == _MINUS
    if negative:
        i += 1
    digits = np.uint64(0)
    n_digits, exponent, decimals = 0, 0, False
    while i < len(text):
        if _ZERO <= text[i] <= _NINE:
            if digits > _MOST:
                return np.nan, i
            digits = digits * np.uint64(10) + np.uint64(text[i] - _ZERO)
            n_digits += 1
            exponent -= decimals
        elif text[i] == point and not decimals:
            decimals = True
        else:
            break
        i += 1
    if n_digits == 0:
        return np.nan, i
    if i < len(text) and (text[i] == _POINT_E or text[i] == _BIG_E):
        power, i = _exponent(text, i + 1)
        if i < 0:
            return np.nan, i
        exponent += power
    value = _value(digits, exponent)
    return (-value if negative else value), i


@kernel
def read_decimals(text: Bytes, start: int, delimiter: int, point: int, table: Floats2) -> int:
    """Fills `table` (n, k) from the text's rows from `start` on; returns how many there are, or `NOT_READ`.

    Empty lines are no rows. Whatever is not plainly a table of k numbers in at most n rows is not read.

    Args:
        text: (m,) uint8 bytes. delimiter, point: bytes between numbers, and before their decimals.
    """
    n_columns = table.shape[1]
    i, row = start, 0
    while i < len(text):
        if text[i] == _LF:
            i += 1
            continue
        if text[i] == _CR and i + 1 < len(text) and text[i + 1] == _LF:
            i += 2
            continue
        if row == len(table):
            return NOT_READ
        for column in range(n_columns):
            i = _past_blanks(text, i)
            if i == len(text):
                return NOT_READ
            table[row, column], i = _number(text, i, point)
            if np.isnan(table[row, column]):
                return NOT_READ
            i = _past_blanks(text, i)
            if column + 1 < n_columns:
                if i == len(text) or text[i] != delimiter:
                    return NOT_READ
                i += 1
        if i < len(text) and text[i] == _CR:
            i += 1
        if i < len(text) and text[i] != _LF:
            return NOT_READ
        i += 1
        row += 1
    return row
