"""A hash is believed where a file cannot have changed since it was read, and only there."""

import os

import pytest

from clearance.batch.file_hashes import RACY, FileHashes, FileStamp, seen

LONG_AGO = 10**9 * 10**9


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("time,rail\n0,0\n")
    return str(path)


def marks(path, **changes):
    """What is known of a file that was read long after it was written, its hash made up."""
    found = seen(path, "known", 0)
    late = max(found.changed, found.status_changed) + RACY + 1
    return found._replace(**{"read": late} | changes)


def test_a_settled_file_is_not_read_again(file):
    assert FileHashes({file: marks(file)}).of(file) == "known"


@pytest.mark.parametrize("mark", ["device", "inode", "n_bytes", "changed", "status_changed"])
def test_any_mark_that_is_another_makes_it_read_again(file, mark):
    known = marks(file)
    hashes = FileHashes({file: known._replace(**{mark: getattr(known, mark) - 1})})
    assert hashes.of(file) not in (None, "known")


def test_what_was_read_soon_after_its_last_change_is_not_kept(file):
    hashes = FileHashes({})
    assert hashes.of(file) is not None
    assert hashes.known == {} and not hashes.is_new  # written a moment ago: racy


def test_what_changed_as_it_was_read_is_not_kept(file):
    hashes = FileHashes({})
    early = marks(file)._replace(read=LONG_AGO)
    hashes.learn([(file, early)])
    assert hashes.known == {}
    hashes.learn([(file, marks(file))])
    assert hashes.known == {file: marks(file)} and hashes.is_new


def test_content_changed_with_its_time_set_back_is_seen(file):
    known = marks(file)
    with open(file, "r+") as stream:
        stream.write("TIME")
    os.utime(file, ns=(known.changed, known.changed))
    assert os.stat(file).st_mtime_ns == known.changed and os.stat(file).st_size == known.n_bytes
    assert FileHashes({file: known}).of(file) != "known"


def test_a_file_that_is_gone_has_no_hash(tmp_path):
    assert FileHashes({}).of(str(tmp_path / "gone.csv")) is None
    assert seen(str(tmp_path / "gone.csv"), "", 0) is None


def test_a_settled_mark_lies_more_than_the_clocks_grain_before_reading():
    assert FileStamp(0, 0, 0, 10, 10, 11 + RACY, "").is_settled
    assert not FileStamp(0, 0, 0, 10, 11, 11 + RACY, "").is_settled
    assert not FileStamp(0, 0, 0, 11, 10, 11 + RACY, "").is_settled
