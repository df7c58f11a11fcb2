"""The words of RAPID: which are known, by what they do, and how expressions are made of them.

Not for: doing it (`rapid`), statements (`rapid_text`).

Source: ABB, Technical reference manual, RAPID kernel, instructions, functions and data types.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from functools import partial
from typing import Any, Literal, NamedTuple

import numpy as np

from clearance.formats.program.grammar import Grammar, Spelled, numeric, ranked
from clearance.formats.program.rapid_data import VALUES


class MoveRule(NamedTuple):
    """The kind of a move, and where among its arguments are target, speed, zone and tool."""

    kind: Literal["ptp", "lin", "circ"]
    to: int
    speed: int
    zone: int
    tool: int


_LINE, _ARC = MoveRule("lin", 0, 1, 2, 3), MoveRule("circ", 1, 2, 3, 4)
_JOINTS = _LINE._replace(kind="ptp")
_WELD, _WELD_ARC = _LINE._replace(zone=4, tool=5), _ARC._replace(zone=5, tool=6)
_AFTER_TRIGGER, _ARC_AFTER_TRIGGER = _LINE._replace(zone=3, tool=4), _ARC._replace(zone=4, tool=5)
MOVES = {
    **dict.fromkeys(("MoveAbsJ", "MoveJ", "MoveJDO", "MoveJAO", "MoveJGO", "MoveJSync"), _JOINTS),
    **dict.fromkeys(("MoveL", "MoveLDO", "MoveLAO", "MoveLGO", "MoveLSync"), _LINE),
    **dict.fromkeys(("MoveC", "MoveCDO", "MoveCAO", "MoveCGO", "MoveCSync"), _ARC),
    "TriggJ": _AFTER_TRIGGER._replace(kind="ptp"),
    "TriggL": _AFTER_TRIGGER,
    "TriggC": _ARC_AFTER_TRIGGER,
    **dict.fromkeys(("ArcLStart", "ArcL", "ArcLEnd"), _WELD),
    **dict.fromkeys(("ArcCStart", "ArcC", "ArcCEnd"), _WELD_ARC),
}
"""Moves that are read."""

OTHER_MOVES = frozenset(
    "MoveExtJ SearchL SearchC SearchExtJ SpotL SpotJ PaintL PaintC PDispOn PDispSet EOffsOn EOffsSet CorrCon "
    "CorrWrite IndAMove IndRMove IndDMove IndCMove EGMRunJoint EGMRunPose EGMMoveL EGMMoveC SoftAct "
    "StepBwdPath ClearPath RestoPath WaitWObj ContactL DispL DispC LaserL PathRecMoveBwd "
    "PathRecMoveFwd MToolTCPCalib CONNECT SingArea CirPathMode".split()
)
"""Instructions that move the robot otherwise, or change where moves go."""

WAITS = frozenset(
    "WaitDI WaitDO WaitGI WaitGO WaitAI WaitAO WaitUntil WaitSyncTask WaitTestAndSet WaitRob".split()
)
"""Waits for signals or other programs."""

STILL = frozenset(
    "Break TPWrite TPErase TPShow UIShow Set Reset SetDO SetGO SetAO PulseDO InvertDO ClkStart ClkStop "
    "ClkReset VelSet ConfJ ConfL GripLoad IDelete ISignalDI ISignalDO ITimer IWatch ISleep IEnable "
    "IDisable IError IPers Incr Decr Add Clear TriggIO TriggEquip TriggInt TriggRampAO TriggCheckIO Open "
    "Close Write ErrWrite ErrLog BookErrNo MotionSup ActUnit DeactUnit EOffsOff PDispOff IOEnable "
    "IODisable SocketCreate SocketSend SocketClose SocketListen SocketBind StartMove StorePath SetSysData "
    "SoftDeact TuneServo TuneReset SpyStart SpyStop WriteStrBin WriteBin Rewind ClearIOBuff TextTabInstall "
    "RMQEmptyQueue ArcRefresh SetAllDataVal".split()
)
"""Further instructions that move nothing."""

PAUSES = frozenset(
    "WaitTime Stop SystemStopAction UIMsgBox TPReadNum TPReadFK TPReadDnum SocketReceive SocketConnect "
    "SocketAccept Load UnLoad StartLoad LoadId SyncMoveOn SyncMoveOff StopMove ReadAnyBin ReadRawBytes "
    "UIMessageBox UINumEntry UINumTune UIAlphaEntry UIListView UIDnumEntry ReadNum ReadStr ReadStrBin "
    "ReadBin".split()
)
"""Instructions and functions that take time, beside `WAITS`: until a person or another machine has answered."""

LIMITS = frozenset("AccSet PathAccLim WorldAccLim SpeedLimAxis SpeedLimCheckPoint".split())
"""Instructions that limit accelerations and speeds."""

WRITES = frozenset(
    "TPReadNum TPReadFK TPReadDnum SocketReceive ReadAnyBin ReadRawBytes UnpackRawBytes GetDataVal GetSysData "
    "GetJointData GetTrapData BitSet BitClear ReadErrData SetDataVal TryInt".split()
)
"""Instructions that move nothing and give variables a value that only the controller knows."""

WRITES_ONE = {"StrToVal": (1,), "GetNextSym": (0, 1), "TestAndSet": (0,)}
"""Functions that give arguments a value, and which of them."""

UNKNOWN_VALUES = frozenset(
    "TestDI DOutput GOutput AOutput DInput GInput AInput ClkRead CTime CDate GetTime NumToStr ValToStr "
    "StrToVal StrPart StrMatch StrFind StrLen StrMap StrMemb StrOrder StrDigCmp ByteToStr StrToByte "
    "DecToHex HexToDec CRobT CJointT CPos CTool CWObj CSpeedOverride CalcRobT CalcJointT CalcRotAxFrameZ "
    "OpMode RunMode RobOS TaskRunMec TaskRunRob MotionPlannerNo IsStopMoveAct IsSysId IsPers IsVar "
    "ReadMotor TestAndSet GetNextSym GetTaskName GetMecUnitName EulerZYX BitAnd BitOr BitXOr BitNeg "
    "BitCheck BitLSh BitRSh DefFrame DefDFrame DefAccFrame ORobT SocketGetStatus GetSignalOrigin "
    "MaxRobSpeed NumToDnum DnumToNum Rand FileSize".split()
)
"""Further functions whose value only the controller knows."""

_FURTHER = (*STILL, *UNKNOWN_VALUES, *VALUES, "Present")
WORDS = {
    word.lower(): word
    for word in (*MOVES, *OTHER_MOVES, *WAITS, *PAUSES, *LIMITS, *WRITES, *_FURTHER)
}
"""All of them as they are written, by their small letters."""

RESULTS = frozenset("timeflag errornumber readlength string str".split())
"""Arguments in which instructions leave a value."""

WORD = re.compile(
    r"""(?P<skip>\s+|![^\n]*|%%%.*?%%%)
    |(?P<number>0[xX][0-9a-fA-F]+|0[bB][01]+|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
    |(?P<name>[A-Za-z_][A-Za-z_0-9]*)
    |(?P<string>"(?:[^"\n]|"")*")
    |(?P<operator>:=|<>|<=|>=|[-+*/<>=(){}\[\],.;:\\|?%])""",
    re.VERBOSE | re.DOTALL,
)


def added(a: object, b: object) -> object:
    """Numbers, texts and positions are added."""
    if isinstance(a, str) and isinstance(b, str):
        return a + b
    return _by_item(operator.add, a, b)


def _by_item(act: Callable[[Any, Any], Any], a: object, b: object) -> object:
    """An operator on numbers, or on each item of two positions."""
    if isinstance(a, list) and isinstance(b, list):
        return [numeric(act)(x, y) for x, y in zip(a, b, strict=True)]
    return numeric(act)(a, b)


def _product(a: object, b: object) -> object:
    """Numbers, a position by a number, and two orientations are multiplied.

    Raises:
        TypeError: other things are.
    """
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b) == 4:
        (w, *v), (s, *t) = a, b
        turned = np.cross(v, t) + w * np.array(t) + s * np.array(v)
        return [float(w * s - np.dot(v, t)), *turned.tolist()]
    for one, by in ((a, b), (b, a)):
        if isinstance(one, list) and len(one) == 3 and not isinstance(by, list):
            return [numeric(operator.mul)(x, by) for x in one]
    return numeric(operator.mul)(a, b)


GRAMMAR = Grammar(
    binary=ranked(
        *("OR XOR", "AND", "= <> < > <= >=", "+ -", "* / DIV MOD"),
        own={"+": added, "-": partial(_by_item, operator.sub), "*": _product},
    ),
    unary={
        "NOT": (2, operator.not_),
        "-": (6, lambda a: _product(-1.0, a)),
        "+": (6, lambda a: a),
    },
    constants={"true": True, "false": False},
    index="{}",
    optional="\\",
    fold=lambda name: WORDS.get(name.lower()) or Spelled(name.lower(), str(name)),
)
