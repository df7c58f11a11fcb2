"""How many examples a test has in the fast lane, and how many in all.

Of random examples `dev` draws a tenth of what the test asks for, at least three, and `ci` all;
`pytest --hypothesis-profile dev` chooses, and `ci` holds where nothing is chosen. Of listed examples, as seeds and
names are, it takes the same share, from all over the list (`listed`); those that take long are marked `slow`.
"""

from collections.abc import Callable, Collection, Hashable, Iterable, Sequence
from typing import TypeVar

import pytest
from hypothesis import settings

Item = TypeVar("Item")

PROFILES = {"ci": 100, "dev": 10}
"""Of a hundred examples that a test asks for, how many are drawn."""


def register() -> None:
    """Makes the profiles known, and `ci` the one that holds."""
    for name, share in PROFILES.items():
        settings.register_profile(name, max_examples=share, deadline=None)
    settings.load_profile("ci")


def examples(n: int) -> settings:
    """The settings of a property that draws `n` examples, or its profile's share of them."""
    return settings(max_examples=share_of(n))


def share_of(n: int) -> int:
    """`n`, or the profile's share of it: how many examples a test draws by itself."""
    return max(3, n * settings.default.max_examples // 100)


def listed(items: Sequence[Item], key: Callable[[Item], Hashable]) -> list[Item]:
    """The items in their order, of those of one key the profile's share, evenly from the first one on."""
    places: dict[Hashable, list[int]] = {}
    for i, item in enumerate(items):
        places.setdefault(key(item), []).append(i)
    kept = {i for own in places.values() for i in _evenly(own)}
    return [item for i, item in enumerate(items) if i in kept]


def _evenly(own: list[int]) -> list[int]:
    n = len(own)
    n_kept = min(n, share_of(n))
    return [own[i * n // n_kept] for i in range(n_kept)]


def first_fast(values: Iterable, n: int) -> list:
    """All values for `parametrize`; those after the first `n` are marked `slow`."""
    return [value if i < n else _slow(value) for i, value in enumerate(values)]


def some_slow(values: Iterable, slow: Collection) -> list:
    """All values for `parametrize`; those that are in `slow` are marked so."""
    values = list(values)
    assert set(slow) <= set(values), "a value that the test does not have"
    return [_slow(value) if value in slow else value for value in values]


def _slow(value: object) -> object:
    return pytest.param(value, marks=pytest.mark.slow)
