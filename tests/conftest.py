"""A guard that holds a test to its marks, and the profiles of its random examples."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from clearance import progress
from clearance.cli import run
from clearance.compile import library
from clearance.compile.decorators import KERNELS
from clearance.errors import Unavailable
from tests import examples
from tests.cart import files
from tests.counted_end import TimelessEnd
from tests.guards import guarded, refused

MARKS = ("cold", "browser", "peer", "slow", "shared")
LONG = {"cold", "browser", "slow"}

examples.register()


def pytest_sessionstart(session: pytest.Session) -> None:
    """Builds the kernels that have changed, before any test asks for one; no line comes by the clock."""
    progress.Event = TimelessEnd
    if KERNELS == "built":
        try:
            library.opened()
        except Unavailable as error:
            raise pytest.UsageError(str(error)) from None


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Looks for no garbage while tests are collected: all that is made then stays."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> Iterator[None]:
    """Of the listed examples that `-m` and `-k` leave of a test, keeps the profile's share."""
    _put_long_files_first(items)
    result = yield
    kept = examples.listed(items, key=lambda item: item.nodeid.partition("[")[0])
    left_out = set(items) - set(kept)
    if left_out:
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = kept
    return result


def _put_long_files_first(items: list[pytest.Item]) -> None:
    """Files with tests that take seconds or start processes: begun last, one keeps a worker alone at the end."""
    long = {item.path for item in items if LONG & {mark.name for mark in item.iter_markers()}}
    items.sort(key=lambda item: item.path not in long)


def pytest_collection_finish() -> None:
    """Leaves half a million collected objects out of all later collections of garbage."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Guards a test with its fixtures, from set-up to tear-down."""
    with guarded(frozenset(mark for mark in MARKS if item.get_closest_marker(mark))):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    """Fails a test that the guard refused something, even where the code under test made nothing of it."""
    result = yield
    if refused:
        pytest.fail(f"{item.nodeid}: {'; '.join(refused)}", pytrace=False)
    return result


@pytest.fixture
def refusal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs a command on bad input: the one line that it says, with exit code 2 and every file as it was."""

    def line_of(*words: object) -> str:
        before = sorted(tmp_path.rglob("*")), files(tmp_path)
        capsys.readouterr()
        assert run([*map(str, words)]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.startswith("error: ") and err.count("\n") == 1
        assert (sorted(tmp_path.rglob("*")), files(tmp_path)) == before
        return err

    return line_of
