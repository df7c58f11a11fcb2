"""A hash is believed where a file cannot have changed since it was read, and only there."""

import pytest

from clearance.batch.file_hashes import RACY, FileHashes, FileStamp, seen

LONG_AGO = 10**9 * 10**9
MADE_UP = "ab" * 32


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("time,rail\n0,0\n")
    return str(path)


def marks(path, **changes):
    """What is known of a file that was read long after it was written, its hash made up."""
    found = seen(path, MADE_UP, 0)
    late = max(found.changed, found.status_changed) + RACY + 1
    return found._replace(**{"read": late} | changes)


def known(path, stamp):
    """What was known before of one file."""
    return lambda *asked: stamp.sha256 if asked == (path, stamp.marks) else None


def test_a_settled_file_is_not_read_again(file):
    assert FileHashes(known(file, marks(file))).of(file) == MADE_UP


@pytest.mark.parametrize("mark", ["device", "inode", "n_bytes", "changed", "status_changed"])
def test_any_mark_that_is_another_makes_it_read_again(file, mark):
    given = marks(file)
    hashes = FileHashes(known(file, given._replace(**{mark: getattr(given, mark) - 1})))
    assert hashes.of(file) not in (None, MADE_UP)


def test_what_was_read_soon_after_its_last_change_is_not_kept(file):
    hashes = FileHashes()
    assert hashes.of(file) is not None
    assert hashes.stamps() == []  # written a moment ago: racy


def test_what_changed_as_it_was_read_is_not_kept(file):
    hashes = FileHashes()
    early = marks(file)._replace(read=LONG_AGO)
    hashes.learn([(file, early)])
    assert hashes.stamps() == []
    hashes.learn([(file, marks(file))])
    assert hashes.stamps() == [(file, marks(file))] and hashes.stamps() == []


def test_a_file_that_is_gone_has_no_hash(tmp_path):
    assert FileHashes().of(str(tmp_path / "gone.csv")) is None
    assert seen(str(tmp_path / "gone.csv"), "", 0) is None


def test_a_settled_mark_lies_more_than_the_clocks_grain_before_reading():
    assert FileStamp(0, 0, 0, 10, 10, 11 + RACY, "").is_settled
    assert not FileStamp(0, 0, 0, 10, 11, 11 + RACY, "").is_settled
    assert not FileStamp(0, 0, 0, 11, 10, 11 + RACY, "").is_settled
