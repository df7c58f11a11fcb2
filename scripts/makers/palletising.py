"""Scene `palletising_cell`: an arm puts three cartons from an infeed on a pallet, by a program in RAPID.

Millimetres and degrees, as the controller has them; the frame is the arm's base.
"""

from __future__ import annotations

Place = tuple[float, float, float]

PICKS: tuple[Place, ...] = ((550, -550, 390.5), (550, -400, 390.5), (550, -250, 390.5))
PLACES: tuple[Place, ...] = ((500, 250, 190.5), (500, 400, 190.5), (640, 250, 190.5))
MIDDLE: Place = (550, 30, 600)

PROGRAM = """MODULE Palletise
    ! Three cartons from the infeed to the pallet; the tool's z axis is its approach.
    PERS tooldata grip:=[TRUE,[[150,0,0],[0.707106781,0,0.707106781,0]],[1,[50,0,0],[1,0,0,0],0,0,0]];
    CONST jointtarget home:=[[0,-20,3,0,107,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
{targets}

    PROC main()
        MoveAbsJ home,v500,fine,grip;
        MoveJ Offs(pick_1,0,0,140),v500,fine,grip;
{calls}
        MoveAbsJ home,v500,fine,grip;
    ENDPROC

    PROC bring(robtarget pick,robtarget place)
        MoveL Offs(pick,0,0,140),v500,fine,grip;
        MoveL pick,v200,fine,grip;
        SetDO gripper_closed,1;
        WaitTime 0.5;
        MoveL Offs(pick,0,0,220),v200,z20,grip;
        MoveL middle,v500,z20,grip;
        MoveL Offs(place,0,0,420),v500,z20,grip;
        MoveL place,v200,fine,grip;
        SetDO gripper_closed,0;
        WaitTime 0.5;
        MoveL Offs(place,0,0,420),v200,z20,grip;
        MoveL middle,v500,fine,grip;
    ENDPROC
ENDMODULE
"""


def programs() -> dict[str, str]:
    """The arm's program, as the text of a file."""
    named = {f"pick_{i + 1}": place for i, place in enumerate(PICKS)}
    named |= {f"place_{i + 1}": place for i, place in enumerate(PLACES)} | {"middle": MIDDLE}
    targets = "\n".join(map(_target, named, named.values()))
    calls = "\n".join(f"        bring pick_{i},place_{i};" for i in range(1, len(PICKS) + 1))
    return {"palletise.mod": PROGRAM.format(targets=targets, calls=calls)}


def _target(name: str, place: Place) -> str:
    """A target with the tool downwards, its first and sixth axes in the quadrant of their angle."""
    quadrant = 0 if place[1] > 0 else -1
    x, y, z = (f"{one:g}" for one in place)
    told = f"[[{x},{y},{z}],[0,0,1,0],[{quadrant},0,{quadrant},0],[9E9,9E9,9E9,9E9,9E9,9E9]]"
    return f"    CONST robtarget {name}:={told};"
