"""`lend`: hands a named tuple on by its address, within kernels."""

from __future__ import annotations

from typing import Any


def lend(value: Any) -> Any:
    """The tuple, as what a kernel calls is best given it: one word, however many arrays it holds.

    It lies where the caller runs, and no longer than that. In Python it is the tuple itself.
    """
    return value
