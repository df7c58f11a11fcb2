"""What is kept of compiled kernels: believed only where it is whole and ours, and never needed."""

from __future__ import annotations

import errno
import os
import pickle
import shutil
import stat
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numba
import pytest

from clearance import kept_files
from clearance.compile.jit import kernel
from clearance.kept_files import KernelCacheWarning, cache_root

pytestmark = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled here")

ROOT_ONLY = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give a file away"
)


def twice(x):
    return 2.0 * x


def half(x):
    return 0.5 * x


def forget() -> None:
    """As in a process that has just begun."""
    cache_root.cache_clear()
    kept_files.warn_not_kept.cache_clear()


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A home with an empty cache."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    forget()
    yield tmp_path
    forget()


def ran(function: Callable = twice) -> tuple[int, int]:
    """How often one run takes the compiled function from the cache, and compiles it; its answer is right."""
    forget()
    compiled = kernel(function)
    assert compiled(3.0) == function(3.0)
    return sum(compiled.stats.cache_hits.values()), sum(compiled.stats.cache_misses.values())


TAKEN, MADE = (1, 0), (0, 1)


def kept(home: Path) -> Path:
    (found,) = home.rglob("*.kernel")
    return found


def test_a_second_run_takes_what_the_first_has_made(home):
    assert ran() == MADE
    assert ran() == TAKEN
    for path in (kept(home), kept(home).parent, cache_root()):
        assert stat.S_IMODE(path.stat().st_mode) & 0o077 == 0
    assert list(home.rglob("*.partial")) == []


def test_a_cache_can_be_put_elsewhere_and_nothing_there_changes_but_ours(home, monkeypatch):
    place = home / "elsewhere"
    place.mkdir()
    place.chmod(0o777)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(place))
    assert [ran(), ran()] == [MADE, TAKEN]
    assert (
        kept(home).is_relative_to(place / "clearance")
        and stat.S_IMODE(place.stat().st_mode) == 0o777
    )


def flipped(content: bytes, at: int) -> bytes:
    return content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]


class Evil:
    """What runs when it is unpickled."""

    def __reduce__(self) -> tuple:
        return (os.mkdir, ("trapped",))


DAMAGE = {
    "nothing": lambda content: b"",
    "a few bytes": lambda content: content[:7],
    "the digest alone": lambda content: content[:32],
    "half of it": lambda content: content[: len(content) // 2],
    "all but one byte": lambda content: content[:-1],
    "one byte more": lambda content: content + b"\0",
    "zeros, as after a power cut": lambda content: bytes(len(content)),
    "random bytes": lambda content: bytes((7919 * i * i + 31 * i) % 251 for i in range(5000)),
    "a bit of the digest": lambda content: flipped(content, 3),
    "the first bit of the code": lambda content: flipped(content, 32),
    "a bit in the middle": lambda content: flipped(content, len(content) // 2),
    "the last bit": lambda content: flipped(content, len(content) - 1),
    "another pickle": lambda content: pickle.dumps(Evil()),
    "another pickle under its digest": lambda content: content[:32] + pickle.dumps(Evil()),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_what_is_damaged_is_dropped_and_compiled_again(home, monkeypatch, damage):
    monkeypatch.chdir(home)
    ran()
    whole = kept(home).read_bytes()
    kept(home).write_bytes(DAMAGE[damage](whole))
    assert ran() == MADE
    assert not (home / "trapped").exists()
    assert ran() == TAKEN


def test_the_code_of_another_kernel_under_this_name_is_not_believed(home):
    ran(half)
    other = kept(home)
    content = other.read_bytes()
    other.unlink()
    ran()
    kept(home).write_bytes(content)
    assert ran() == MADE


def test_what_is_whole_but_of_another_build_is_compiled_again(home):
    ran()
    path, payload = kept(home), pickle.dumps((1, 2, 3))
    path.write_bytes(kept_files.digest_of_kept(path.name, payload) + payload)
    assert [ran(), ran()] == [MADE, TAKEN]


def others_can_write_the_file(path: Path) -> None:
    path.chmod(0o666)


def a_group_can_write_the_folder(path: Path) -> None:
    path.parent.chmod(0o770)


def the_file_is_a_link(path: Path) -> None:
    shutil.copy(path, path.parents[2] / "elsewhere")
    path.unlink()
    path.symlink_to(path.parents[2] / "elsewhere")


def the_file_is_of_another_user(path: Path) -> None:
    os.chown(path, 12345, 12345)


def the_folder_is_of_another_user(path: Path) -> None:
    os.chown(path.parent, 12345, 12345)


@pytest.mark.skipif(os.name == "nt", reason="other rights")
@pytest.mark.parametrize(
    "give",
    [
        others_can_write_the_file, a_group_can_write_the_folder, the_file_is_a_link,
        pytest.param(the_file_is_of_another_user, marks=ROOT_ONLY),
        pytest.param(the_folder_is_of_another_user, marks=ROOT_ONLY),
    ],
)  # fmt: skip
def test_what_others_could_have_written_is_not_run(home, give):
    ran()
    give(kept(home))
    assert ran() == MADE


def others_can_write_it(root: Path) -> None:
    root.chmod(0o777)


def it_is_of_another_user(root: Path) -> None:
    os.chown(root, 12345, 12345)


def it_is_a_file(root: Path) -> None:
    shutil.rmtree(root)
    root.touch()


@pytest.mark.skipif(os.name == "nt", reason="other rights")
@pytest.mark.parametrize(
    "spoil",
    [others_can_write_it, pytest.param(it_is_of_another_user, marks=ROOT_ONLY), it_is_a_file],
)
def test_without_a_folder_to_trust_a_run_goes_on_and_says_so_once(home, spoil):
    ran()
    spoil(cache_root())
    with pytest.warns(KernelCacheWarning, match="compiled kernels are not kept") as told:
        assert ran() == MADE
    assert len(told) == 1 and "\n" not in str(told[0].message)


def test_a_home_that_cannot_be_written_is_no_obstacle(home, monkeypatch):
    (home / "file").touch()
    monkeypatch.setenv("HOME", str(home / "file"))
    with pytest.warns(KernelCacheWarning, match="no folder for them can be made"):
        ran()


@pytest.mark.parametrize("fault", [errno.ENOSPC, errno.EROFS, errno.EDQUOT])
@pytest.mark.parametrize("where", ["mkdir", "mkstemp", "write", "replace"])
def test_a_full_disk_is_no_obstacle(home, monkeypatch, where, fault):
    def full(*_: object, **__: object) -> None:
        raise OSError(fault, os.strerror(fault))

    class Full:
        __enter__ = __exit__ = full

    place = {
        "mkdir": (kept_files.Path, "mkdir", full), "mkstemp": (kept_files.tempfile, "mkstemp", full),
        "write": (kept_files.os, "fdopen", lambda handle, mode: os.close(handle) or Full()),
        "replace": (kept_files.os, "replace", full),
    }  # fmt: skip
    with monkeypatch.context() as patched:
        patched.setattr(*place[where])
        with pytest.warns(KernelCacheWarning, match=os.strerror(fault)) as told:
            ran()
    assert len(told) == 1
    assert list(home.rglob("*.kernel")) == list(home.rglob("*.partial")) == []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert [ran(), ran()] == [MADE, TAKEN]
