"""Names that are hard to show or to match, and messages that must read as a person writes."""

import pytest

from clearance.errors import BadInput, BadPose
from clearance.geometry.pose import pose_from_quaternion
from clearance.load.schema import Obstacle
from clearance.load.schema_errors import validated
from clearance.world.pairs import matches


@pytest.mark.parametrize("name", ["a\nb", "a\x01b", "a\x1b[31mb"])
def test_control_characters_in_a_name_are_refused(name):
    with pytest.raises(BadInput, match="control character"):
        validated(Obstacle, {"name": name, "box": {"size": [1.0, 1.0, 1.0]}}, "case.yaml")


def test_a_name_that_holds_wildcards_matches_itself():
    assert matches("post[a]", "post[a]") and matches("posta", "post[a]")
    assert not matches("postb", "post[a]")


def test_a_bad_quaternion_is_shown_as_plain_numbers():
    with pytest.raises(BadPose) as caught:
        pose_from_quaternion([0, 0, 0], [1, 1, 0, 0])
    assert "[1.0, 1.0, 0.0, 0.0]" in str(caught.value)
