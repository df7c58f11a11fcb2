"""Cases made in memory are looked at as those from files are; what is told twice is told once, worst first."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from clearance import box, check
from clearance.errors import BadDimension, BadInput, UnknownJoint
from clearance.formats.plausibility import angle_notices
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.report.topics.worst import lines
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case, Limits
from clearance.world.mimics import followers
from clearance.world.notice import Notice, Severity
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.plausibility import notices_of
from clearance.world.plausible_tables import notices_on_tables
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.self_pairs import limbs
from clearance.world.timing import Timing, Window
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, faces_of


def arm(size: float = 0.3, origin: str = "arm.stl", **joint) -> Robot:
    """A base and an upper arm half a metre on."""
    elbow = Joint("elbow", JointKind.REVOLUTE, "base", "upper", at(0.0, 0.0, 0.5))
    bodies = (
        Body("base", box((0.3, 0.3, 0.3)), "box"),
        Body("upper", box((size, size, size)), origin),
    )
    return Robot("arm", ("base", "upper"), (replace(elbow, **joint),), bodies)


def case_of(
    robot=None, obstacle=None, pose=None, positions=(0.0, 0.5), times=(0.0, 1.0), **more
) -> Case:
    asked = Trajectory(np.array(times), ("elbow",), np.array(positions)[:, None])
    body = Body("block", obstacle or box((0.2, 0.2, 0.2)))
    placed = PlacedRobot(robot or arm(), asked)
    return Case("made", (placed,), (Obstacle(body, at(0.8) if pose is None else pose),), **more)


def reported(case: Case) -> list[tuple[str, str]]:
    return [(str(notice.severity), notice.kind) for notice in notices_of(case)]


def test_a_good_case_tells_nothing():
    assert reported(case_of()) == []


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"obstacle": box((600.0, 400.0, 20.0))}, "obstacle 'block' is 600 m long"),
        ({"obstacle": box((2e-4, 2e-4, 3e-4))}, "obstacle 'block' is 0.0003 m long"),
        ({"pose": at(30.0, 30.0)}, "obstacle 'block' stands 42.3 m away"),
        ({"robot": arm(3e-4)}, "link 'upper' is 0.0003 m long"),
        ({"robot": arm(300.0)}, "link 'upper' is 300 m long"),
        ({"robot": arm(parent_from_joint=at(50.0))}, "joint 'elbow' stands 50 m away"),
        ({"positions": (0.0, 45.0)}, "joint 'elbow' goes to 45 rad"),
        ({"times": (0.0, 1000.0)}, "is this milliseconds?"),
        ({"limits": Limits(5.0, 20.0)}, "limits.fail is 5 m and limits.warn is 20 m"),
        ({"limits": Limits(5e-6, 0.02)}, "limits.fail is 0.005 mm; is this metres, given to an"),
    ],
)
def test_another_unit_is_suspect(changes, says):
    found = [notice.text for notice in notices_of(case_of(**changes)) if notice.kind == "units"]
    assert len(found) == 1 and says in found[0], found


def test_a_mesh_a_hundred_times_shorter_than_the_reach_is_suspect():
    """A machine of 7 m, in metres, with scale 0.001. In a hand it is a screw."""
    small = case_of(obstacle=box((7e-3, 7e-3, 2e-3)))
    (block,) = small.obstacles
    mesh = replace(block, body=replace(block.body, origin="machine.stl"))
    block = replace(block, body=replace(block.body, origin="box"))
    assert ("suspect", "units") not in reported(replace(small, obstacles=(block,)))
    assert reported(replace(small, obstacles=(mesh,))) == [("suspect", "units")]
    held = Obstacle(mesh.body, mount=Mount("upper", at(0.1)))
    assert ("suspect", "units") not in reported(replace(small, obstacles=(held,)))


def test_what_rides_on_a_link_is_not_many_times_the_reach():
    """20 m where the robot reaches 0.8 m; a wall may be so long."""
    case = case_of(obstacle=box((20.0, 0.2, 0.2)), pose=np.eye(4))
    assert reported(case) == []
    mount = Mount("upper", at(0.1))
    riding = replace(case.obstacles[0], mount=mount)
    assert reported(replace(case, obstacles=(riding,))) == [("suspect", "units")]


@pytest.mark.parametrize("mount", [None, "block", "arm/upper"])
def test_a_robot_that_stands_far_from_all_else_is_suspect(mount):
    """The block is near the first one; a tool on the second does not count as near it."""
    case = case_of()
    for away, expected in ((0.9, []), (900.0, [("suspect", "units")])):
        placed = {"mount": Mount(mount, at(away))} if mount else {"world_from_base": at(away)}
        placed["fixed_positions"] = {"elbow": 0.0}
        other = PlacedRobot(replace(arm(), name="other"), **placed)
        placed = {"fixed_positions": {"elbow": 0.0}, "mount": Mount("other/upper", at(0.1))}
        tool = PlacedRobot(replace(arm(), name="tool"), **placed)
        held = replace(case.obstacles[0], body=replace(case.obstacles[0].body, name="held"))
        held = Obstacle(held.body, mount=Mount("other/upper", at(0.1)))
        robots, obstacles = (*case.robots, other, tool), (*case.obstacles, held)
        assert reported(replace(case, robots=robots, obstacles=obstacles)) == expected


@pytest.mark.parametrize("mount", [None, Mount("upper", at(0.1))])
def test_a_table_whose_poses_all_are_far_away_is_suspect(mount):
    """From 50 to 90 m: nearer to its first pose than the poses are to each other."""
    case = case_of()
    for unit, expected in ((1e-3, []), (1.0, [("suspect", "units")])):
        positions = unit * np.array([[0.0, 0.0, 50.0], [0.0, 0.0, 90.0]])
        moves = PoseTable(np.array([0.0, 3.0]), positions, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
        slide = Obstacle(Body("slide", box((0.1, 0.1, 0.1))), mount=mount, moves=moves)
        assert reported(replace(case, obstacles=(*case.obstacles, slide))) == expected


@pytest.mark.parametrize("by", ["upper", "cart"])
@pytest.mark.parametrize("mount", [None, Mount("upper", at(200.0))])
def test_a_part_that_lies_far_away_as_a_robot_picks_it_up_is_suspect(by, mount):
    """A cart may bring it from afar."""
    cart = Obstacle(Body("cart", box((0.2, 0.2, 0.2))), at(0.8))
    pose = np.eye(4) if mount else at(200.0)
    part = Obstacle(Body("part", box((0.1, 0.1, 0.1))), pose, mount=mount)
    case = case_of(carries=(Carry("part", by, Window(0.0)),))
    found = reported(replace(case, obstacles=(cart, part)))
    assert found == ([("suspect", "units")] if by == "upper" else [])


def frame_around(side: float, share: float = 0.01) -> Polyhedron:
    """A square frame about the origin, whose bars are a share of `side` thick."""
    bar = box((side, side * share, side * share))
    half = side / 2
    turned = bar.vertices[:, [1, 0, 2]] * [-1, 1, 1]
    parts = [bar.vertices + [0, way * half, 0] for way in (-1, 1)]
    parts += [turned + [way * half, 0, 0] for way in (-1, 1)]
    faces = [[i + 8 * k for i in face] for k in range(4) for face in faces_of(bar)]
    return Polyhedron(np.concatenate(parts), faces)


CROSS = np.array([[9.5, 0, 0], [-9.5, 0, 0], [0, 9.5, 0], [0, -9.5, 0]])
POINTS = PointCloud(np.concatenate([CROSS, 1.001 * CROSS]), 0.01)


@pytest.mark.parametrize(
    ("obstacle", "pose", "severity", "says"),
    [
        (box((60.0, 60.0, 60.0)), at(0.0, 0.0, -35.0), "warning", "'block', the nearest, stays 5 m and more away"),
        (box((0.2, 0.2, 0.2)), at(15.0), "warning", "'block', the nearest, stays 14.9 m and more away"),
        (box((0.2, 0.2, 0.2)), at(0.87), "warning", "stays 0.77 m and more away from the robot's base, "
         "and no point of a link gets farther than 0.76 m from it"),
        (box((0.2, 0.2, 0.2)), at(0.85), None, ""),
        (frame_around(19.0), at(0.0), "warning", "stays 9.4 m and more away"),
        (frame_around(90.0), at(0.0), "suspect", "'block' is 90.9 m long"),
        (POINTS, np.eye(4), "warning", "nothing comes nearer than 9.3 m to the robot, 12 times its reach"),
    ],
)  # fmt: skip
def test_what_is_far_from_the_robot_is_no_quiet_clear(obstacle, pose, severity, says):
    """The base's corners are 0.26 m from its middle, and so are those of the arm half a metre on."""
    case = case_of(obstacle=obstacle, pose=pose)
    if severity == "suspect":
        frame = case.obstacles[0]
        mesh = replace(frame, body=replace(frame.body, origin="frame.stl"))
        case = replace(case, obstacles=(mesh,))
    found = check(case).record.notices
    assert [str(one.severity) for one in found] == ([severity] if severity else [])
    assert all(says in one.text for one in found)


def test_a_robot_deep_inside_the_box_of_a_plane_is_within_reach():
    """It is in contact at each step, though the nearest side is 7 m away."""
    ground = Obstacle(Body("ground", box((40.0, 40.0, 20.0)), "box"), at(0.0, 0.0, -3.0))
    assert reported(replace(case_of(), obstacles=(ground,))) == []


def test_what_a_link_bears_and_how_far_its_slides_go_count_as_its_reach():
    """A block 0.8 m farther is in reach of an arm that stands, or goes, 0.8 m up, and of a rod of 0.9 m on it."""
    far = case_of(pose=at(0.0, 0.0, 1.6))
    assert reported(far) == [("warning", "reach")]
    rod = Obstacle(Body("rod", box((0.1, 0.1, 0.1))), mount=Mount("upper", at(0.8)))
    assert reported(replace(far, obstacles=(*far.obstacles, rod))) == []
    slide = replace(far.robots[0].robot.joints[0], kind=JointKind.PRISMATIC)

    def on_slide(case, lower, upper, **changes):
        joints = (replace(slide, lower=lower, upper=upper),)
        placed = replace(case.robots[0], robot=replace(case.robots[0].robot, joints=joints))
        return reported(replace(case, robots=(replace(placed, **changes),)))

    assert on_slide(far, -0.6, 0.6) == [("warning", "reach")]
    assert on_slide(far, -0.8, 0.6) == on_slide(far, -np.inf, np.inf) == []
    higher = case_of(pose=at(0.0, 0.0, 6.5))  # five times 0.5 + 0.5 + 0.26 m is 6.3 m
    assert on_slide(higher, -np.inf, np.inf) == [("warning", "reach")]
    asked = far.robots[0].trajectory
    farther = replace(asked, positions=1.6 * asked.positions)
    assert on_slide(higher, -np.inf, np.inf, trajectory=farther) == []
    lifted = {"trajectory": None, "fixed_positions": {"elbow": 0.8}}
    assert on_slide(higher, -np.inf, np.inf, **lifted) == []


@pytest.mark.parametrize(
    ("shape", "place", "origin", "severity"),
    [
        (box((100.0, 80.0, 50.0)), at(0.5, 0.2, 0.3), "box", ["suspect"]),
        (box((100.0, 80.0, 50.0)), at(140.0), "box", ["suspect"]),
        (box((0.3, 0.2, 0.1)), at(500.0, 250.0, 300.0), "box", ["suspect"]),
        (box((20.0, 6.0, 12.0)), at(50.0, 25.0, 30.0), "bracket.stl", ["suspect"]),
        (frame_around(54.0, 0.2), at(0.3), "ring.stl", ["suspect"]),
        (frame_around(54.0), at(0.3), "hall.stl", []),
        (box((5.0, 1.5, 3.0)), at(9.0), "bracket.stl", ["warning"]),
        (box((5.0, 1.5, 3.0)), at(9.0), "box", []),
        (box((60.0, 60.0, 60.0)), at(0.0, 0.0, -30.5), "box", []),
        (box((40.0, 0.3, 8.0)), at(0.0, 30.0), "box", []),
    ],
)  # fmt: skip
def test_millimetres_beside_obstacles_of_usual_size(shape, place, origin, severity):
    """Solids about the cell, or far from it, whatever else is near the robot; walls are none."""
    near = case_of(obstacle=box((0.5, 0.5, 0.5)))
    other = Obstacle(Body("other", shape, origin), place)
    found = notices_of(replace(near, obstacles=(*near.obstacles, other)))
    assert [str(one.severity) for one in found] == severity
    assert all("obstacle 'other'" in one.text for one in found)


def test_angles_that_look_like_degrees_are_told_how_to_say_so():
    (notice,) = notices_of(case_of(positions=(0.0, 45.0)))
    assert "'NAME [deg]' in the header" in notice.text and "units: {angle: deg}" in notice.text
    (notice,) = angle_notices(["a pose has an angle of 90 rad"])
    assert notice.text.endswith("is this degrees (90° are 1.5708 rad)?")


def test_a_small_box_of_a_robot_is_a_sensor():
    assert reported(case_of(arm(0.001, "box"), pose=at(0.5))) == []


def test_a_mesh_is_also_held_against_the_other_obstacles():
    """60 m beside blocks of 0.2 m, where the robot reaches 0.8 m: under 200 times the reach, over 200 blocks."""
    fence = Obstacle(Body("fence", box((60.0, 0.1, 40.0)), "fence.stl"), at(2.0))
    case = case_of()
    case = replace(case, obstacles=(*case.obstacles, fence))
    assert reported(case) == [("suspect", "units")]
    wall = replace(fence, body=replace(fence.body, origin="box"))
    assert reported(replace(case, obstacles=(case.obstacles[0], wall))) == []


def test_a_surface_that_is_flat_has_an_extent():
    vertices = np.array([[0.0, 0, 0], [3000, 0, 0], [3000, 0, 2000], [0, 0, 2000]])
    fence = Polyhedron.from_triangles(vertices, np.array([[0, 1, 2], [0, 2, 3]]))
    assert reported(case_of(obstacle=fence)) == [("suspect", "units")]


def test_joints_beyond_their_limits():
    limited = arm(lower=-1.0, upper=1.0)
    assert reported(case_of(limited, positions=(0.0, 1.0 + 1e-10))) == []
    assert reported(case_of(limited, positions=(0.0, 1.2))) == [("warning", "limits")]
    assert reported(case_of(limited, positions=(0.0, 8.0))) == [("suspect", "limits")]
    assert (
        check(case_of(limited, positions=(0.0, 1.2))).verdict.headline()
        == "clear, joints beyond their limits"
    )
    assert check(case_of(limited, positions=(0.0, 0.9))).verdict.headline() == "clear"
    strict = Limits(joints="fail")
    assert reported(case_of(limited, positions=(0.0, 1.2), limits=strict)) == [
        ("violated", "joint limits")
    ]


@pytest.mark.parametrize("n_joints", [4, 5])
def test_limbs_that_are_not_measured_against_each_other_are_told(n_joints):
    """Two chains on a turning torso; the second has a finger of two joints at its end."""
    joints = [Joint("torso", JointKind.REVOLUTE, "base", "chest", np.eye(4))]
    for side, n in (("left", n_joints), ("right", n_joints + 1)):
        links = ["chest", *(f"{side}_{i}" for i in range(n))]
        for above, link in itertools.pairwise(links):
            joints.append(Joint(f"to_{link}", JointKind.REVOLUTE, above, link, np.eye(4)))
    joints.append(Joint("finger", JointKind.PRISMATIC, f"right_{n_joints - 1}", "tip", np.eye(4)))
    names = ("base", *(joint.child for joint in joints))
    robot = Robot("dual", names, tuple(joints), (Body("chest", box((0.3, 0.3, 0.3))),))
    ends = [f"left_{n_joints - 1}", f"right_{n_joints}"]
    assert limbs(robot) == (ends if n_joints == 5 else [])
    asked = Trajectory(np.array([0.0, 1.0]), ("torso",), np.array([[0.0], [0.5]]))
    block = Obstacle(Body("block", box((0.2, 0.2, 0.2))), at(0.8))
    for measured in (None, SelfClearance()):
        placed = PlacedRobot(robot, asked, self_clearance=measured)
        told = [one for one in reported(Case("made", (placed,), (block,))) if one[1] == "limbs"]
        assert bool(told) == (n_joints == 5 and measured is None)


def test_pairs_that_never_meet_within_limits_are_in_doubt_beyond_them():
    limited = case_of(arm(lower=-1.0, upper=1.0), positions=(0.0, 1.2))
    for trusts, found in ((False, []), (True, [("suspect", "limits")])):
        placed = replace(limited.robots[0], self_clearance=SelfClearance(trust_never=trusts))
        case = replace(limited, robots=(placed,))
        assert [one for one in reported(case) if one[0] == "suspect"] == found


def test_a_joint_that_jumps_is_suspect_and_not_only_fast():
    """2 rad in 1 ms are 2000 rad/s; a limit of 10 is exceeded 200 times, one of 1000 twice."""
    jump = {"positions": (-1.0, 1.0), "times": (0.0, 0.001)}
    assert reported(case_of(arm(velocity=10.0), **jump)) == [("suspect", "limits")]
    assert reported(case_of(arm(velocity=1000.0), **jump)) == [("warning", "limits")]
    strict = case_of(arm(velocity=10.0), **jump, limits=Limits(joints="fail"))
    assert reported(strict) == [("suspect", "limits"), ("violated", "joint limits")]


def test_a_joint_that_goes_to_and_fro_all_the_time_is_that_of_two_robots():
    """The rows of one at 0.2 t and of another at -0.2 t, 5 ms apart."""
    times = np.arange(40) * 0.005
    braided = np.where(np.arange(40) % 2, -0.2, 0.2) * (1.0 + times)
    assert reported(case_of(arm(velocity=2.0), positions=braided, times=times)) == [
        ("suspect", "limits")
    ]
    uneven = np.where(np.arange(120) % 3 == 1, -0.2, 0.2)  # of drivers of 100 and 50 Hz
    uneven = {"positions": uneven, "times": 0.005 * np.arange(120)}
    assert reported(case_of(arm(velocity=20.0), **uneven)) == [("suspect", "limits")]
    fast = {"positions": 0.05 * np.arange(40), "times": times}
    assert reported(case_of(arm(velocity=2.0), **fast)) == [("warning", "limits")]


def test_a_joint_that_is_too_fast_once_jumps_and_one_that_often_is_is_fast():
    """1 rad/s of 41 rows at 0.1 s; a step of 0.8 rad in place of 0.1 is at 8 rad/s, of a limit of 2."""
    times, steps = 0.1 * np.arange(41), np.full(41, 0.1)

    def told(limit, **changes):
        ways = steps.copy()
        for i, way in changes.get("ways", {}).items():
            ways[i] = way
        found = notices_of(
            case_of(
                arm(velocity=limit),
                positions=np.cumsum(ways) - 3.0,
                times=changes.get("times", times),
            )
        )
        return [str(one.severity) for one in found if one.kind == "limits"]

    assert told(2.0, ways={20: 0.8}) == ["suspect"]
    assert told(3.0, ways={20: 0.8}) == ["warning"]
    assert told(2.0, ways={10: 0.8, 20: 0.8, 30: 0.8}) == ["warning"]
    close = np.sort([*times[:40], times[20] + 0.01])
    assert told(1.5, times=close, ways={21: 0.049}) == ["warning"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("01234", None),
        ("0123", "1 of 5 joints is given by nobody and stays at 0: 'j4'; is a column missing?"),
        ("1234", "1 of 5 joints is given by nobody and stays at 0: 'j0'; is a column missing?"),
        (
            "013",
            "2 of 5 joints are given by nobody and stay at 0: 'j2', 'j4'; joints on both sides of 'j2'",
        ),
        ("01", "3 of 5 joints are given by nobody and stay at 0: 'j2', 'j3', 'j4'; is a column"),
    ],
)
def test_joints_that_nobody_gives_are_a_warning_since_a_column_may_be_lost(given, told):
    joints = tuple(replace(one, mimic=None) for one in chain(5).joints)
    names = tuple(f"j{i}" for i in given)
    asked = Trajectory(np.array([0.0, 1.0]), names, np.full((2, len(names)), [[0.0], [0.5]]))
    placed = PlacedRobot(replace(chain(5), joints=joints), asked)

    def texts(**changes):
        case = replace(case_of(), robots=(replace(placed, **changes),))
        return [one.text for one in notices_of(case) if one.kind == "rest"]

    assert [one.startswith(str(told)) for one in texts()] == [True] * (told is not None)
    case_says = {f"j{i}": 0.1 for i in "01234" if i not in given}
    assert not texts(fixed_positions=case_says)
    assert not texts(trajectory=None)


def test_a_robot_of_which_nothing_is_given_is_a_warning_beside_one_that_moves():
    case = case_of()
    other = PlacedRobot(replace(arm(), name="other"), world_from_base=at(0.9))
    (text,) = [one.text for one in notices_of(replace(case, robots=(*case.robots, other)))]
    assert text.startswith(
        "1 of 1 joints is given by nobody and stays at 0: 'other/elbow'; is its traj"
    )


HALF = np.sqrt(0.5)


@pytest.mark.parametrize(
    ("step", "place", "turn", "rate", "told"),
    [
        (
            0.0005,
            1.9,
            0.0,
            1.0,
            "goes 1.9 m from 1 to 1.0005 s of its table, at 3800 m/s: does it jump",
        ),
        (0.5, 1.9, 0.0, 1000.0, "goes 1.9 m from 1 to 1.5 s of its table, at 3800 m/s"),
        (0.001, 0.0, HALF, 1.0, "goes 1.57 rad from 1 to 1.001 s of its table, at 1571 rad/s"),
        (0.1, 1.9, 0.0, 1.0, None),
        (0.0001, 0.004, 0.0, 1.0, None),
        (0.0005, 1900.0, 0.0, 1.0, "moves 1900 m; lengths are in metres"),
    ],
)
def test_a_table_that_jumps_is_suspect(step, place, turn, rate, told):
    """A block moves by 0.3 m in the first second, or turns by a quarter in the step after it."""
    times = np.array([0.0, 1.0, 1.0 + step, 2.0 + step])
    places = np.array([[0.8, 0, 0], [0.8, 0.3, 0], [0.8, 0.3, place], [0.8, 0.3, place]])
    turns = np.array([[0, 0, 0, 1], [0, 0, 0, 1], *[[0, 0, turn, np.sqrt(1 - turn**2)]] * 2])
    moves = PoseTable(times, places, turns, Timing(rate=rate))
    case = case_of()
    case = replace(case, obstacles=(Obstacle(case.obstacles[0].body, moves=moves),))
    found = [one.text for one in notices_on_tables(case)]
    assert len(found) == (told is not None)
    assert all(text.startswith(f"CHECK UNITS: obstacle 'block' {told}") for text in found)


@pytest.mark.parametrize("after", ["loop", "hold"])
@pytest.mark.parametrize(
    ("end", "turn", "told"), [(0.0, 0.0, ""), (1.0, 0.0, "1 m"), (0.0, 1.0, "1 rad")]
)
def test_a_table_that_begins_again_elsewhere_is_told(end, turn, told, after):
    xyz = np.array([[0.0, 2.0, 0.0], [0.5, 2.0, 0.0], [end, 2.0, 0.0]])
    quaternions = np.array([[0.0, 0.0, np.sin(a / 2), np.cos(a / 2)] for a in (0.0, 0.5, turn)])
    quaternions[2] *= -1.0  # the same turn
    moves = PoseTable(np.arange(3.0), xyz, quaternions, Timing(after=after))
    pusher = Obstacle(Body("pusher", box((0.1, 0.1, 0.1))), moves=moves)
    (found,) = notices_on_tables(Case("c", (PlacedRobot(arm()),), (pusher,))) or [None]
    assert (found is None) == (not told or after == "hold")
    assert found is None or f"elsewhere than they end: obstacle 'pusher' by {told};" in found.text


@pytest.mark.parametrize(("radius", "n_told"), [(0.0051, 0), (0.0049, 1)])
def test_a_scan_whose_balls_stand_alone_is_a_warning(radius, n_told):
    """Points 10 mm apart in a row."""
    row = PointCloud(np.arange(60)[:, None] * [0.01, 0.0, 0.0] + [0.5, 0.0, 0.0], radius)
    found = notices_of(case_of(obstacle=row, pose=np.eye(4)))
    assert [(str(one.severity), one.kind) for one in found] == [("warning", "scan")] * n_told
    for one in found:
        assert one.text.startswith("scan 'block': most of its balls of 4.9 mm touch no other")


def test_a_robot_that_need_not_move_is_checked_too():
    far = case_of(pose=at(30.0, 30.0))
    resting = replace(far.robots[0], trajectory=None)
    assert reported(replace(far, robots=(resting,))) == [("suspect", "units")]


def test_what_loading_reported_is_kept_and_the_worst_comes_first():
    warning = Notice(Severity.WARNING, "package", "another file")
    of_robot = Notice(Severity.WARNING, "geometry", "a link without shape")
    robot = replace(arm(), notices=(of_robot,))
    case = case_of(robot, times=(0.0, 1000.0), notices=(warning, warning))
    assert [notice.kind for notice in notices_of(case)] == ["units", "package", "geometry"]
    again = replace(case, notices=notices_of(case))
    assert notices_of(again) == notices_of(case)


def test_a_run_carries_the_notices_of_its_case():
    run = check(case_of(pose=at(0.0, 0.0, 90.0)))
    assert [notice.kind for notice in run.record.case.notices] == ["units"]
    run = check(case_of(), limits=Limits(0.8, 0.9))
    assert ["limits.fail is 0.8 m" in notice.text for notice in run.record.case.notices] == [True]


def chain(n_joints: int, **mimic) -> Robot:
    """Joints in a row, each following the one before."""
    names = tuple(f"l{i}" for i in range(n_joints + 1))
    joints = [
        Joint(f"j{i}", JointKind.PRISMATIC, names[i], names[i + 1], np.eye(4),
              mimic=Mimic(f"j{i - 1}", **mimic) if i else None)
        for i in range(n_joints)
    ]  # fmt: skip
    bodies = (Body(names[-1], box((1.0, 1.0, 1.0))),)
    return Robot("chain", names, tuple(joints), bodies)


def test_a_joint_that_follows_one_that_follows():
    found = followers(chain(4, multiplier=2.0, offset=1.0))
    assert [(one.master, one.factor, one.offset) for one in found] == [
        ("j0", 1.0, 0.0), ("j0", 2.0, 1.0), ("j0", 4.0, 3.0), ("j0", 8.0, 7.0)
    ]  # fmt: skip


def test_joints_that_follow_each_other_in_memory_are_refused():
    def made(**followed):
        links = ("a", "b", "c")[: len(followed) + 1]
        joints = [
            Joint(name, JointKind.REVOLUTE, *ends, np.eye(4), mimic=Mimic(other))
            for (name, other), ends in zip(followed.items(), itertools.pairwise(links), strict=True)
        ]
        return Robot("made", links, tuple(joints), ())

    with pytest.raises(BadInput, match="joints follow each other"):
        followers(made(j="k", k="j"))
    with pytest.raises(UnknownJoint, match="unknown joint 'gone'"):
        followers(made(j="gone"))


@pytest.mark.parametrize(
    ("kind", "mimic", "says"),
    [
        (JointKind.PRISMATIC, {"offset": 1e160}, r"link 'l2': it reaches .* m from the origin"),
        (JointKind.PRISMATIC, {"multiplier": 1e8}, r"link 'l2': it reaches .* m from the origin"),
        (JointKind.REVOLUTE, {"offset": 1e160}, r"joint 'j1' stands 1e\+160 rad beyond"),
    ],
)
def test_what_follows_out_of_the_world_is_refused(kind, mimic, says):
    joints = tuple(replace(joint, kind=kind) for joint in chain(2, **mimic).joints)
    asked = Trajectory(np.array([0.0, 1.0]), ("j0",), np.array([[0.0], [0.5]]))
    placed = PlacedRobot(replace(chain(2), joints=joints), asked)
    case = Case("made", (placed,), (Obstacle(Body("b", box((1.0, 1.0, 1.0))), at(3.0)),))
    with pytest.raises(BadDimension, match=says):
        check(case)


def test_a_pair_that_never_moves_does_not_hide_how_near_the_motion_comes():
    """The base stands 2 mm above a table; the upper arm, half a metre above it, turns by 0.5 rad."""
    case = case_of()
    assert check(case_of(pose=at(0.6, 0.0, 0.5))).summary["nearest_moving"] is None
    table = Obstacle(Body("table", box((1.0, 1.0, 0.1))), at(0.0, 0.0, -0.202))
    run = check(replace(case, obstacles=(*case.obstacles, table)))
    assert run.worst["clearance"] == pytest.approx(0.002) and run.worst["link"] == "base"
    nearest = run.summary["nearest_moving"]
    assert (
        nearest == "448.4 mm, upper - table at 1.000 s, step 1"
    )  # 0.5 + 0.152 - 0.15 (cos 0.5 + sin 0.5)
    assert ("moving", f"base and table never move; nearest of what moves: {nearest}") in lines(
        run.report
    )
