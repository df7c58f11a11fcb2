"""Which shapes of a URDF are measured: links that are only seen, robots that only have pictures."""

import pytest

from clearance.errors import NothingToMeasure
from clearance.world.notice import Severity
from tests.formats.making_case import changed, load_small
from tests.formats.making_urdf import BOX, joint, link, load_urdf, robot

VISUAL = '<visual><geometry><box size="2 2 2"/></geometry></visual>'


def arm(base: str, *others: str) -> str:
    """A base and links that turn on it, by what they are made of."""
    links = [link(shapes, f"link{i}") for i, shapes in enumerate(others)]
    joints = [joint(f"joint{i}", "base", f"link{i}") for i in range(len(others))]
    return robot(link(base, "base"), *links, *joints)


def test_links_that_are_seen_but_not_measured_are_a_warning_of_their_own(tmp_path):
    (notice,) = load_urdf(tmp_path, arm(BOX, VISUAL, "", VISUAL, BOX + VISUAL)).notices
    assert (notice.severity, notice.kind) == (Severity.WARNING, "geometry")
    assert notice.text.startswith(
        "2 links have a visual but no collision shape and are not measured: 'link0', 'link2'; "
    )
    assert "geometry: collision_or_visual" in notice.text
    (notice,) = load_urdf(tmp_path, arm(BOX, *([VISUAL] * 9))).notices
    assert "9 links have" in notice.text and "'link5' and 3 more" in notice.text


def test_bare_frames_are_a_note_and_no_warning(tmp_path):
    found = load_urdf(tmp_path, arm(BOX, "", BOX))
    assert found.notices == ()
    assert found.notes == ("arm.urdf: 1 link without any shape: link0",)


def test_collision_or_visual_measures_all_that_has_a_shape(tmp_path):
    urdf = arm(BOX + VISUAL, VISUAL, "")
    found = load_urdf(tmp_path, urdf, geometry="collision_or_visual")
    assert found.notices == ()
    sizes = {body.name: float(body.shape.bounds[1, 0]) for body in found.bodies}
    assert sizes == {"base": 0.5, "link0": 1.0}
    case = changed("arm.urdf", "arm.urdf, geometry: collision_or_visual")
    loaded = load_small(tmp_path, case, urdf=urdf.replace("joint0", "shoulder"))
    assert len(loaded.robots[0].robot.bodies) == 2


@pytest.mark.parametrize(
    ("shape", "asked", "other"), [(VISUAL, "collision", "visual"), (BOX, "visual", "collision")]
)
def test_a_robot_of_the_other_kind_of_shapes_is_told_what_to_give(tmp_path, shape, asked, other):
    with pytest.raises(NothingToMeasure) as caught:
        load_urdf(tmp_path, arm(shape, shape), geometry=asked)
    assert str(caught.value) == (
        f"arm.urdf: no link has a {asked} shape, 2 links have a {other} shape; "
        f"give robot: {{geometry: {other}}}"
    )
