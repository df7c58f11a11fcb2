"""Small valid files of scenes, batches, findings, programs and bags. Not for: damaging them (`campaign`)."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Iterable
from pathlib import Path

from clearance.findings.doubts import Doubt
from clearance.findings.finding import AppliedWaiver, Finding
from clearance.findings.findings_file import FindingList, findings_text
from clearance.findings.measurement_conditions import (
    MeasuredPairs,
    MeasuredRobot,
    MeasuredRule,
    MeasurementConditions,
)
from tests.formats.making_bags import planned, state, write_bag

SCENE = b"""obstacles:
- {name: post, pose: {xyz: [2, 0, 0], rpy: [0, 0, 0.5]}, box: {size: [0.1, 0.1, 1]}}
- {name: ball, pose: {xyz: [2, 1, 0], rpy: [0.1, 0, 0]}, sphere: {radius: 0.02}}
- {name: rod, on: post, cylinder: {radius: 0.1, length: 0.5}}
- {name: part, pose: {xyz: [-2, 1, 0]}, mesh: {file: m.stl, scale: [0.5, 1, -1]}}
"""

MANIFEST = b"""name: night
cases: [case.yaml]
cell: cell.yaml
trajectories: ["a*.csv"]
read_as: {units: {angle: deg}, period: 0.5, joints: [shoulder]}
need: steps
limits: {fail: 0.002, warn: 0.01}
certify_gap: 0.001
accept: [units]
"""

WAIVERS = b"""- between: [post, tip]
  at_least: 0.002
  reason: a soft
    bumper
  by: A. Smith
  until: 2027-03-31
  case: small
- {between: ["ba*", upper], rule: near, at_least: 0, reason: r, by: b, until: '2027-03-31'}
"""

POSES_JSON = b"""{"header": {"stamp": {"sec": 3, "nanosec": 5}, "frame_id": "map"}, "poses": [
{"header": {"stamp": {"sec": 3, "nanosec": 5}, "frame_id": "map"},
 "pose": {"position": {"x": 1.0, "y": -2.5, "z": 0.5}, "orientation": {"x": 0, "y": 0, "z": 0.6, "w": 0.8}}},
{"header": {"stamp": {"sec": 4, "nanosec": 0}, "frame_id": "map"},
 "pose": {"position": {"x": 1.0, "y": 2.5, "z": 0.5}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}}]}
"""


def octomap_scene(octree: bytes) -> bytes:
    """A PlanningScene of an octomap in binary form, as its file holds it."""
    header, _, body = octree.partition(b"\ndata\n")
    resolution = header.rpartition(b"res ")[2].decode()
    return f"""world:
  octomap:
    header: {{frame_id: map}}
    origin: {{position: {{x: 0, y: 0, z: 1}}, orientation: {{x: 0, y: 0, z: 0, w: 1}}}}
    octomap: {{id: OcTree, resolution: {resolution}, binary: true, data: {_signed(body)}}}
""".encode()


def _signed(body: Iterable[int]) -> list[int]:
    """Bytes as `int8`, as messages hold them."""
    return [value - 256 if value > 127 else value for value in body]


def findings() -> bytes:
    """`findings.json` of one pair that breaks its rule."""
    measured = MeasurementConditions(
        need="steps",
        method="exact",
        motion="kinematic",
        basis="motion",
        certify_gap=1e-4,
        clock_slack=0.0,
        robots=(MeasuredRobot("arm", 64 * "0", ("base", "tip")),),
        rules=(MeasuredRule("default", (), "", 0.04, 0.06),),
        pairs=(MeasuredPairs(("tip",), ("post",)),),
        unmeasured=(MeasuredPairs(("base",), ("*",)),),
    )
    doubt = Doubt("warning", "meshes", "a mesh is left out")
    waived = AppliedWaiver(0.002, "soft", "A. Smith", "2027-03-31", 0.003)
    found = Finding(
        16 * "0", "clearance", "default", "tip", "post", 0, "violated", 0.035, 0.034, 0.04, 0.06, 2.5, None, 132,
        True,
        2.0, 3.0, 129, 135, (0.1, 0.2, 0.3), (0.1, 0.2, 0.4), {"shoulder": 0.5}, "", waived=waived,
    )  # fmt: skip
    return findings_text(FindingList("small", "", 0, measured, (doubt,), (found,))).encode()


PROGRAM = b"""tool: {link: tool_tip, xyz: [0.0, 0.0, 0.05]}
frames: {table: {on: base, xyz: [0.5, -0.2, 0.4]}}
start: {joint_1: -0.5, joint_2: 0.1, joint_3: 0.4, joint_4: 0.1, joint_5: 1.1, joint_6: 0.2}
step: 0.01
moves:
  - lin: {to: {frame: table, xyz: [0.03, 0.0, 0.0]}, zone: 0.003}
  - lin: {to: {frame: table, xyz: [0.03, 0.03, 0.0], name: P1}, speed: 0.1}
  - circ: {via: {frame: table, xyz: [0.04, 0.04, 0.0]}, to: {frame: table, xyz: [0.03, 0.05, 0.0]}}
  - wait: 0.5
  - ptp: {joints: {joint_1: -0.5, joint_2: 0.1, joint_3: 0.4, joint_4: 0.1, joint_5: 1.1, joint_6: 0.2}}
"""

URSCRIPT = b"""def weld():
  set_tcp(p[0, 0, 0.1, 0, 0, 0])
  home = [-0.5, 0.1, 0.4, 0.1, d2r(60), 0.2]
  movej(home, a=1.4, v=1.05)
  i = 0
  while i < 2:
    movel(pose_trans(p[0.4, 0.1, 0.3, 0, 3.1416, 0], p[0.1 * i, 0, 0, 0, 0, 0]), v=0.25, r=0.005)
    i = i + 1
  end
  movec(p[0.5, 0.2, 0.3, 0, 3.1416, 0], p[0.6, 0.1, 0.3, 0, 3.1416, 0], a=1.2, v=0.1, mode=0)
  if home[0] < 0: sleep(0.5) else: movej([0, 0, 0, 0, 0, 0]) end
end
"""

RAPID = b"""MODULE Weld
  PERS tooldata gun:=[TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  CONST jointtarget home:=[[-30,5,20,5,60,10],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p10:=[[400,100,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveAbsJ home\\NoEOffs,v200,fine,gun;
    FOR i FROM 1 TO 2 DO
      MoveL Offs(p10,10*i,0,0),v100,z5,gun\\WObj:=wobj0;
    ENDFOR
    IF home.robax.rax_1<0 THEN WaitTime 0.5; ENDIF
    MoveC RelTool(p10,-40,20,0),Offs(p10,60,0,0),v100\\V:=50,fine,gun;
  ENDPROC
ENDMODULE
"""

KRL = b"""&ACCESS RVP
DEF weld( )
BAS (#TOOL,0)
BAS (#BASE,1)
BAS (#VEL_PTP,50)
$VEL.CP=0.25
$APO.CDIS=5.0
PTP XHOME
FOR I=1 TO 2
  LIN XP1:{X 10.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0} C_DIS
  stitch(I*10.0)
ENDFOR
WAIT SEC 0.5
I=2
SWITCH I
CASE 1,2
  CIRC {X 110.0,Y 10.0,Z 50.0},{X 120.0,Y 0.0,Z 50.0,A 90.0,B 0.0,C 180.0}
ENDSWITCH
END
DEF stitch(at:IN)
  REAL at
  LIN_REL {Z at} #TOOL
END
DECL E6AXIS XHOME={A1 0.0,A2 10.0,A3 20.0,A4 0.0,A5 60.0,A6 0.0}
DECL E6POS XP1={X 100.0,Y 0.0,Z 50.0,A 90.0,B 0.0,C 180.0,S 2,T 10}
BASE_DATA[1]={X 400.0,Y 0.0,Z 300.0,A 0.0,B 0.0,C 0.0}
"""

FANUC = b"""/PROG  WELD
/ATTR
/MN
   1:  UFRAME_NUM=0 ;
   2:  UTOOL_NUM=0 ;
   3:J P[1:HOME] 50% FINE    ;
   4:  FOR R[1]=1 TO 2 ;
   5:L P[2] 250mm/sec FINE    ;
   6:  ENDFOR ;
   7:C P[2]
    :  P[3] 100mm/sec FINE    ;
   8:  WAIT    .50(sec) ;
   9:  IF R[1]>1,DO[1]=ON ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 0,	
	J1=    10.000 deg,	J2=    20.000 deg,	J3=    -5.000 deg,
	J4=     0.000 deg,	J5=    45.000 deg,	J6=    30.000 deg
};
P[2]{
   GP1:
	UF : 0, UT : 0,		CONFIG : 'N U T, 0, 0, 0',
	X =   500.000  mm,	Y =     0.000  mm,	Z =   300.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
P[3]{
   GP1:
	UF : 0, UT : 0,		CONFIG : 'N U T, 0, 0, 0',
	X =   550.000  mm,	Y =    50.000  mm,	Z =   300.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =    90.000 deg
};
/END
"""


@functools.cache
def bag(container: str) -> bytes:
    """A bag of one planned motion."""
    return _written(container, {"/plan": [planned([0.1, 0.0], [0.3, 0.05])]})


def states(container: str) -> bytes:
    """A bag of what two joints did."""
    seen = [state(i, [0.1 * i, 0.2], velocities=[0.1, 0.0]) for i in range(3)]
    return _written(container, {"/joint_states": seen})


def bag_metadata() -> bytes:
    """What stands beside the messages in a folder of rosbag2 in sqlite3."""
    with tempfile.TemporaryDirectory() as folder:
        topics = {"/plan": [planned([0.1, 0.0], [0.3, 0.05])]}
        path = write_bag(Path(folder) / "made", "rosbag2 sqlite3", topics)
        return (path / "metadata.yaml").read_bytes()


def _written(container: str, topics: dict) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = write_bag(Path(folder) / "made", container, topics)
        return (next(path.glob("*.db3")) if path.is_dir() else path).read_bytes()
