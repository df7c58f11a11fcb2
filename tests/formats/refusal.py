"""The line with which bad input is refused, as a value that a test may look into."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from clearance.errors import ClearanceError


def refusal(call: Callable, *args: object, of: type[Exception] = ClearanceError, **kw) -> str:
    """What the error says with which a call is refused; `of` is its class."""
    with pytest.raises(of) as caught:
        call(*args, **kw)
    return str(caught.value)
