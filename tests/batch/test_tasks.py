"""Manifests become cases, a queue of tasks; the cases of a task come to what each does alone; hashes of files."""

from __future__ import annotations

from pathlib import Path

import pytest

from clearance.batch import measuring
from clearance.batch.engine import LEAST, MOST, Queue
from clearance.batch.file_hashes import RACY, FileHashes, FileStamp, seen
from clearance.batch.keys import program
from clearance.batch.measuring import Task, TaskResult, measure
from clearance.errors import (
    BadInput,
    DuplicateName,
    Incomplete,
    MissingFile,
    MissingKey,
    UnknownKey,
)
from tests.batch.batches import CELL, items_of, write_cell


@pytest.fixture
def folder(tmp_path):
    write_cell(tmp_path, [0.5, 0.2, 0.1])
    return tmp_path


def written(folder, text):
    path = folder / "batch.yaml"
    path.write_text(text)
    return [str(path)]


def names(arguments):
    return [item.name for item in items_of(arguments)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('cell: cell.yaml\ntrajectories: [t002.csv, "t*.csv"]\n', ["t002", "t000", "t001"]),
        ('name: line\ncell: cell.yaml\ntrajectories: "t00[01].csv"\n', ["line/t000", "line/t001"]),
    ],
)
def test_a_list_keeps_its_order_and_a_name_goes_before_those_of_its_cases(folder, text, expected):
    assert names(written(folder, text)) == expected


def test_case_files_are_named_from_the_folder_that_they_share(folder):
    for name in ("a", "b"):
        (folder / name).mkdir()
        (folder / name / "case.yaml").write_text(CELL)
    assert names([str(folder / "*" / "case.yaml")]) == ["a/case", "b/case"]


def test_options_of_the_manifest_and_of_the_command_line(folder):
    text = 'cell: cell.yaml\ntrajectories: "t*.csv"\nneed: minimum\nlimits: {fail: 0.1}\n'
    options = items_of(written(folder, text), dict(warn=0.4, accept=("units",)))[0].options
    asked = options.asked
    assert (asked.need, asked.fail, asked.warn, asked.certify) == ("minimum", 0.1, 0.4, True)
    assert asked.accept == ("units",)
    assert not items_of(written(folder, text), dict(certify=False))[0].options.asked.certify


@pytest.mark.parametrize(
    ("text", "fault", "told"),
    [
        ("cell: cell.yaml\n", MissingKey, "'trajectories' is missing"),
        ("trajectories: t0.csv\n", MissingKey, "'cell' is missing"),
        ("cases: []\n", BadInput, "1 values are needed"),
        ("cell: cell.yaml\ntrajectorys: t.csv\n", UnknownKey, "'trajectories'"),
        ("cell: c.yaml\ntrajectories: t.csv\nneed: all\n", BadInput, "batch.yaml: need: 'all'"),
        ('cell: cell.yaml\ntrajectories: "x*.csv"\n', MissingFile, "no file matches 'x*.csv'"),
        ("cases: a.yaml\nrobot: left\n", BadInput, "there is no cell"),
        (
            "cell: c.yaml\ntrajectories: t.csv\nsamples_only: true\ncertify_gap: 0.1\n",
            BadInput,
            "batch.yaml: certify_gap says nothing with samples_only: true",
        ),
        (
            "cell: c.yaml\ntrajectories: t.csv\nread_as: {file: t.csv}\n",
            BadInput,
            "read_as.file: a file is given; the files under trajectories",
        ),
    ],
)
def test_a_manifest_that_is_none_is_refused_in_one_line(folder, text, fault, told):
    with pytest.raises(fault) as caught:
        items_of(written(folder, text))
    assert told in str(caught.value) and "\n" not in str(caught.value)


def test_two_cases_of_one_name_are_refused(folder):
    (folder / "other.yaml").write_text('cell: one.yaml\ntrajectories: "t*.csv"\n')
    (folder / "one.yaml").write_text(CELL)
    arguments = [str(folder / "batch.yaml"), str(folder / "other.yaml")]
    assert len(names(arguments[:1])) == 3
    with pytest.raises(DuplicateName, match="two cases would be called 't000'"):
        names(arguments)


def test_a_file_that_is_named_and_not_there_is_a_case(folder):
    text = "cell: cell.yaml\ntrajectories: [t000.csv, gone.csv]\n"
    assert names(written(folder, text)) == ["t000", "gone"]
    assert names([str(folder / "gone.yaml")]) == ["gone"]


def test_the_same_files_asked_about_in_two_ways_are_two_cases(folder):
    usual = 'cell: cell.yaml\ntrajectories: "t*.csv"\n'
    others = {"limits": "limits: {fail: 0.6, warn: 0.7}\n", "reading": "read_as: {period: 0.5}\n"}
    (folder / "usual.yaml").write_text(usual)
    for name, text in others.items():
        (folder / f"{name}.yaml").write_text(f"name: {name}\n{usual}{text}")
    given = [str(folder / f"{name}.yaml") for name in ("usual", *others)]
    items = items_of(given)
    assert [item.name for item in items][::3] == ["t000", "limits/t000", "reading/t000"]
    assert items[3].options.asked.fail == 0.6 and items[0].options.asked.fail is None
    (folder / "limits.yaml").write_text(f"{usual}{others['limits']}")
    with pytest.raises(DuplicateName, match=r"'t000': .*t000.csv, asked in two ways"):
        items_of(given[:2])


@pytest.fixture
def many(tmp_path: Path):
    return items_of([str(write_cell(tmp_path, [0.5] * 500))])


def cut(queue, n_hands):
    """The numbers of the cases of each task."""
    found = []
    while (task := queue.task(n_hands)) is not None:
        found.append([item.number for item in task.items])
    return found


@pytest.mark.slow
@pytest.mark.parametrize("n_hands", [1, 4, 16])
def test_each_case_is_in_one_task_and_the_last_are_small(many, n_hands):
    tasks = cut(Queue(many, "batch"), n_hands)
    assert [number for task in tasks for number in task] == [item.number for item in many]
    waiting = len(many)
    for task in tasks:
        assert len(task) == min(waiting, MOST, max(LEAST, -(-waiting // n_hands)))
        waiting -= len(task)


def test_cases_that_are_given_back_alone_are_tasks_of_their_own(many):
    queue = Queue(many[:20], "batch")
    first = queue.task()
    queue.give_back(first.items[:3], alone=True)
    queue.give_back((), alone=True)
    assert cut(queue, 1) == [[0], [1], [2]]


NEAREST = [0.5, 0.02, 0.2, 0.4, 0.01, 0.3, 0.25, 0.6, 0.1]


@pytest.fixture
def items(tmp_path):
    manifest = write_cell(tmp_path, NEAREST)
    (tmp_path / "t004.csv").write_text("time,rail\n0,0\n1,nothing\n")
    return tuple(items_of([str(manifest)]))


def done(items, seconds: float = 1e9) -> TaskResult:
    return measure(Task(tuple(items), seconds, program(), "a batch"))


def test_cases_of_a_task_come_to_what_each_comes_to_by_itself(items):
    alone = [done([item]) for item in items]
    found = done(items)
    assert found.measured == tuple(told for one in alone for told in one.measured)
    assert found.faults == tuple(fault for one in alone for fault in one.faults)
    assert [fault.number for fault in found.faults] == [4] and not found.left


def test_after_its_time_a_task_leaves_what_it_has_not_begun(items):
    found = done(items, seconds=-1.0)
    assert [told.number for told in found.measured] == [0] and found.left == items[1:]


def test_a_fault_of_the_program_in_one_case_is_told_of_that_alone(items, monkeypatch):
    told = measuring.row_of
    monkeypatch.setattr(
        measuring, "row_of", lambda run: 1 / 0 if run.record.case.name == "t002" else told(run)
    )
    found = done(items)
    assert [(fault.number, bool(fault.trace)) for fault in found.faults] == [(2, True), (4, False)]
    assert "ZeroDivisionError" in found.faults[0].trace
    assert len(found.measured) == len(items) - 2


def test_a_process_of_another_program_measures_nothing(items):
    with pytest.raises(Incomplete, match="another version of clearance"):
        measure(Task(items, 1e9, "another", "a batch"))


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


def test_a_settled_mark_lies_more_than_the_clocks_grain_before_reading():
    assert FileStamp(0, 0, 0, 10, 10, 11 + RACY, "").is_settled
    assert not FileStamp(0, 0, 0, 10, 11, 11 + RACY, "").is_settled
    assert not FileStamp(0, 0, 0, 11, 10, 11 + RACY, "").is_settled
