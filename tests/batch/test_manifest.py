"""Manifests, case files and patterns become a list of cases, each with a name of its own."""

import pytest

from clearance.errors import BadInput, DuplicateName, MissingFile, MissingKey, UnknownKey
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


def test_a_cell_times_trajectories_in_order_of_their_names(folder):
    items = items_of([str(folder / "batch.yaml")])
    assert [item.name for item in items] == ["t000", "t001", "t002"]
    assert [item.number for item in items] == [0, 1, 2]
    assert {item.file for item in items} == {str(folder / "cell.yaml")}


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
