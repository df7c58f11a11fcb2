"""Lists of rows in arrays that grow. Not for: what the rows mean."""

import numpy as np

from clearance.compile.decorators import inline


@inline
def with_capacity(rows, n, more):
    """The array of the first `n` rows, or a larger copy if its capacity is too small for `more`."""
    if n + more <= rows.shape[0]:
        return rows
    wider = np.empty((2 * rows.shape[0], rows.shape[1]))
    wider[: rows.shape[0]] = rows
    return wider
