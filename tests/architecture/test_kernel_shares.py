"""Processes that test at once compile each kernel once."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from filelock import FileLock, Timeout

from clearance.kept_files import cache_root
from tests import kernel_shares
from tests.query.lane_of_domains import DOMAINS


def test_the_shares_hold_all_domains_once():
    assert set(kernel_shares.MAIN_KERNELS) == set(DOMAINS)
    for n in (1, 2, 4, 9):
        shares = [kernel_shares.share_of_list(list(DOMAINS), i, n) for i in range(n)]
        assert [domain for share in shares for domain in share] == list(DOMAINS)


def test_files_of_one_folder_lie_apart_and_keep_their_order():
    names = ("a/1", "a/2", "a/3", "a/4", "b/1", "b/2", "c/1")
    order = kernel_shares.spread([Path(name) for name in names])
    assert [file.as_posix() for file in order] == ["a/1", "b/1", "c/1", "a/2", "a/3", "b/2", "a/4"]


@pytest.mark.slow
@pytest.mark.skipif(cache_root() is None, reason="nothing is kept here")
@pytest.mark.parametrize("domain", DOMAINS)
def test_a_domain_that_was_asked_counts_as_compiled(domain):
    DOMAINS[domain]()
    assert kernel_shares.is_kept(domain)


@pytest.mark.slow
@pytest.mark.skipif(cache_root() is None, reason="nothing is kept here")
@pytest.mark.parametrize("question", kernel_shares.QUESTIONS)
def test_a_question_that_was_asked_counts_as_compiled(question):
    kernel_shares.ask(question)
    assert kernel_shares.is_kept(question)


def kernel_of(room: str) -> SimpleNamespace:
    """What stands for a kernel of a module."""
    return SimpleNamespace(
        py_func=SimpleNamespace(__module__=f"{room}.module", __qualname__="kernel")
    )


SHARED = kernel_of("clearance.kernels")


def is_free(folder) -> bool:
    """True if another process would compile the kernel, and not wait."""
    (path,) = folder.iterdir()
    try:
        FileLock(path, timeout=0).acquire().lock.release()
    except Timeout:
        return False
    return True


def test_others_wait_until_a_kernel_is_compiled_and_what_it_needs_has_no_turn(tmp_path):
    def compile_it(one, signature):
        assert one is SHARED and not is_free(tmp_path)
        return compile_in_turn(one, signature - 1) + 1 if signature else 0

    compile_in_turn = kernel_shares.in_turns(compile_it, tmp_path)
    for _ in range(2):
        assert compile_in_turn(SHARED, 3) == 3
        assert is_free(tmp_path)


def test_a_failure_ends_the_turn(tmp_path):
    def compile_it(one, signature):
        raise ValueError(signature)

    with pytest.raises(ValueError, match="what"):
        kernel_shares.in_turns(compile_it, tmp_path)(SHARED, "what")
    assert is_free(tmp_path)


def test_kernels_that_a_test_makes_have_no_turns(tmp_path):
    made = kernel_of("tests")
    assert kernel_shares.in_turns(lambda *asked: asked, tmp_path)(made, 1) == (made, 1)
    assert not list(tmp_path.iterdir())


def test_the_processes_of_a_session_take_turns_in_one_folder_that_goes_with_the_session(tmp_path):
    """Nothing lies outside the session's own folder, so nothing stays where it is killed."""
    first, second = (kernel_shares.turns_beside(tmp_path / name) for name in ("gw0", "gw1"))
    assert first == second and first.is_dir() and first.parent == tmp_path
