"""Files that never end, or are no files, are refused before they are read."""

import os

import pytest

from clearance.errors import MissingFile
from clearance.formats.files.input_files import InputFiles, read_bytes
from clearance.profiles.outline_file import read_outline
from clearance.sketch import Sketch
from tests.formats.making import PATH


@pytest.mark.parametrize("name", ["/dev/zero", "pipe"])
def test_pipes_and_devices_are_refused_without_waiting(tmp_path, name):
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / name
    files = InputFiles(tmp_path)
    for read in (
        lambda: read_bytes(path, name),
        lambda: files.read(path),
        lambda: files.unread(path),
    ):
        with pytest.raises(MissingFile, match="is a pipe or a device; a path to a file on disk"):
            read()


def test_files_and_links_to_them_are_read(tmp_path):
    (tmp_path / "path.csv").write_text(PATH)
    (tmp_path / "link.csv").symlink_to("path.csv")
    files = InputFiles(tmp_path)
    assert files.read(tmp_path / "link.csv") == PATH.encode()
    opened, n_bytes = files.unread(tmp_path / "link.csv")
    with opened() as file:
        assert len(file.read()) == n_bytes
    with pytest.raises(MissingFile, match="is a folder"):
        files.read(tmp_path)


def test_sketches_and_profiles_from_pipes_are_refused(tmp_path):
    os.mkfifo(tmp_path / "s.yaml")
    for read in (Sketch.load, read_outline):
        with pytest.raises(MissingFile, match="file"):
            read(tmp_path / "s.yaml")
