"""The digest of the package's sources: another for each change of a source, and for nothing else."""

from __future__ import annotations

import pytest

from clearance.batch import keys
from clearance.package_digest import digest_of_sources
from clearance.receipt import remade_report
from clearance.record import fingerprint
from tests.cells import cell


@pytest.fixture
def folder(tmp_path):
    for name, content in (("a.py", "x = 1\n"), ("rooms/b.py", "y = 2\n"), ("rooms/p.yaml", "z: 3")):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(content)
    return tmp_path


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "rooms/b.py").write_text("y = 3\n"),
        lambda folder: (folder / "rooms/p.yaml").write_text("z: 4"),
        lambda folder: (folder / "rooms/page.html").write_text("<p>"),
        lambda folder: (folder / "rooms/b.py").rename(folder / "b.py"),
        lambda folder: (folder / "a.py").unlink(),
    ],
)
def test_whatever_is_changed_it_is_another(folder, change):
    before = digest_of_sources(folder)
    change(folder)
    assert digest_of_sources(folder) != before


def test_what_decides_nothing_does_not_change_it(folder):
    before = digest_of_sources(folder)
    (folder / "rooms/NOTES.md").write_text("notes")
    (folder / "rooms/b.cpython-311.pyc").write_bytes(b"compiled")
    assert digest_of_sources(folder) == before


@pytest.mark.parametrize(
    "room, told",
    [
        (keys, keys.program.__wrapped__),
        (remade_report, remade_report.maker),
        (fingerprint, lambda: fingerprint.fingerprint(cell(0), (), (), ())),
    ],
    ids=["rows of a batch", "report of a receipt", "rows of a long run"],
)
def test_what_other_sources_made_is_not_taken_for_ones_own(room, told, monkeypatch):
    before = told()
    assert told() == before
    monkeypatch.setattr(room, "package_digest", lambda: "0" * 64)
    assert told() != before
