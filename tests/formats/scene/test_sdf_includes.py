"""Models that an SDF file includes and that are not there: left out, or taken from elsewhere, as a case says."""

import pytest

from clearance.case.case_file import load_case
from clearance.cli import run
from clearance.errors import BadInput
from clearance.world.notice import Severity
from tests.formats.making import CASE, write_case
from tests.formats.making_case import load_small
from tests.formats.making_sdf import at, collision, include, library, link, model, sdf, world

FUEL = "https://fuel.gazebosim.org/1.0/openrobotics/models/Table"
MISSING = sdf(
    world(include(uri="model://crate"), include(at(3), uri=FUEL), model(at(2), link(collision())))
)


def with_includes(folder, said):
    case = CASE.partition("scene:")[0] + "scene: w.sdf\ntrajectory: path.csv\n"
    return load_small(folder, case + f"includes: {said}\n", w__sdf=MISSING)


def test_a_model_that_is_missing_is_left_out_or_taken_from_elsewhere_where_the_case_says_so(
    tmp_path,
):
    library(tmp_path / "own")
    case = with_includes(tmp_path, f"{{'model://crate': skip, '{FUEL}': own/post}}")
    places = {one.name: one.world_from_body[0, 3] for one in case.obstacles}
    assert places == {"post/l/c": 3, "m/l/c": 2}
    told = [(one.severity, one.text) for one in case.notices]
    assert told == [
        (
            Severity.WARNING,
            "included models left out, as the case says: 'model://crate'",
        ),
        (
            Severity.WARNING,
            f"models used in place of others, as the case says: post for '{FUEL}'",
        ),
    ]
    case = with_includes(tmp_path, f"{{'model://crate': 'file://own/post', '{FUEL}': skip}}")
    assert [one.name for one in case.obstacles] == ["post/l/c", "m/l/c"]


@pytest.mark.parametrize(
    ("said", "says"),
    [
        (
            "{}",
            'includes: {"model://crate": skip} in the case leaves it out, '
            "a path in place of skip uses another model",
        ),
        ("{'model://crate': skip}", f'includes: {{"{FUEL}": skip}} in the case leaves it out'),
        (
            f"{{'model://crate': skip, '{FUEL}': skip, 'model://crat': skip}}",
            "includes names 'model://crat', which the scene does not include; did you mean 'model://crate'?",
        ),
        ("{'model://crate': none}", "there is no model"),
    ],
)
def test_an_include_that_leads_nowhere_is_refused_with_what_to_say(tmp_path, said, says):
    with pytest.raises(BadInput) as caught:
        with_includes(tmp_path, said)
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_includes_of_what_is_no_sdf_file_are_refused(tmp_path):
    with pytest.raises(BadInput, match="includes: the scene stands in the case itself"):
        load_small(tmp_path, CASE + "includes: {'model://crate': skip}\n")
    case = CASE.partition("scene:")[0] + "scene: s.yaml\ntrajectory: path.csv\n"
    with pytest.raises(BadInput, match=r"includes are given, and s\.yaml is no SDF file"):
        load_small(
            tmp_path, case + "includes: {'model://crate': skip}\n", s__yaml="obstacles: []\n"
        )


def test_new_and_convert_leave_models_out_or_take_others_too(tmp_path, monkeypatch, capsys):
    library(tmp_path / "own")
    write_case(tmp_path, w__sdf=MISSING)
    monkeypatch.chdir(tmp_path)
    said = ["--include", "model://crate=skip", "--include", f"{FUEL}=own/post"]
    words = ["--robot", "arm.urdf", "--trajectory", "path.csv", "--scene", "w.sdf"]
    assert run(["new", "out", *words]) == 2
    assert 'includes: {"model://crate": skip}' in capsys.readouterr().err
    assert run(["new", "out", *words, *said]) == 0
    text = (tmp_path / "out" / "case.yaml").read_text()
    assert f'includes: {{"model://crate": skip, "{FUEL}": ../own/post}}' in text
    places = [one.world_from_body[0, 3] for one in load_case("out/case.yaml").obstacles]
    assert places == [3, 2]
    assert run(["convert", "w.sdf", "scene.yaml", *said]) == 0
    told = "included models left out, as the case says: 'model://crate'"
    assert told in capsys.readouterr().err and told in (tmp_path / "scene.yaml").read_text()
    assert run(["convert", "path.csv", "path.yaml", *said]) == 2
    assert "--include says nothing about" in capsys.readouterr().err
