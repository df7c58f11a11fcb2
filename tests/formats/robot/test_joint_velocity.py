"""The greatest speeds of joints that a URDF gives."""

import math

import pytest

import clearance as cl

URDF = """<robot name="r"><link name="a"/><link name="b"><collision><geometry><sphere radius="0.1"/></geometry>
</collision></link><joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
{limit}</joint></robot>"""


@pytest.mark.parametrize(
    "given, velocity",
    [
        ('<limit lower="-1" upper="1" velocity="2.5"/>', 2.5),
        ('<limit lower="-1" upper="1" velocity="0"/>', math.inf),
        ('<limit lower="-1" upper="1" velocity="nan"/>', math.inf),
        ('<limit lower="-1" upper="1" velocity="fast"/>', math.inf),
        ('<limit lower="-1" upper="1"/>', math.inf),
        ("", math.inf),
    ],
)
def test_a_speed_that_is_one_is_read_and_nothing_is_refused_for_it(tmp_path, given, velocity):
    (tmp_path / "r.urdf").write_text(URDF.format(limit=given))
    (joint,) = cl.load_urdf(tmp_path / "r.urdf").joints
    assert joint.velocity == velocity and "velocity" not in repr(joint)
