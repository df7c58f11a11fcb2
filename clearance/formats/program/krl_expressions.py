"""Words, expressions and values of KRL: instructions, aggregates (`{X 1, Y 2}`, frames too, in mm and degrees).

Not for: statements (`krl_text`).

Source: KUKA, expert programming, priority of operators: comparisons bind least, NOT most.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    ExpressionReader,
    Name,
    Part,
    Unknown,
)
from clearance.formats.program.grammar import Grammar, Spelled, numeric, ranked
from clearance.formats.program.statements import Assign, Do, Routine, Statement, assigned
from clearance.formats.program.tokens import NEWLINE, Cursor, Line, Token
from clearance.geometry.pose import pose_from_rpy, rpy_from_pose

MM = 1e-3

FRAME = ("X", "Y", "Z", "A", "B", "C")

UNIT = "UNIT"
"""The part of a base that a machine carries: which one; no frame of a file has it."""

Aggregate = Mapping[str, Any]


def is_number(value: object) -> bool:
    """True for a number; a truth value is none, nor is what is too large for one."""
    is_one = isinstance(value, int | float) and not isinstance(value, bool)
    return is_one and abs(value) < 1e300  # type: ignore[arg-type]


def matrix_of(frame: Aggregate, shown: str) -> np.ndarray:
    """(4, 4) [m] The frame of an aggregate: A about z, then B about the new y, then C about the new x.

    Raises:
        BadSyntax: not six numbers.
    """
    for key in FRAME:
        value = frame.get(key, Unknown("it is not given"))
        if not is_number(value):
            fault = f"{key} of {shown} is not known: {why(value)}"
            raise BadSyntax(fault, valid="X, Y, Z, A, B and C as numbers")
    x, y, z, a, b, c = (float(frame[key]) for key in FRAME)
    return pose_from_rpy([x * MM, y * MM, z * MM], [math.radians(one) for one in (c, b, a)])


def frame_of(pose: np.ndarray) -> Aggregate:
    """The aggregate of a pose (4, 4) [m]; B is within 90 degrees."""
    c, b, a = (math.degrees(one) for one in rpy_from_pose(pose))
    return dict(zip(FRAME, (*(pose[:3, 3] / MM).tolist(), a, b, c), strict=True))


def composed(one: Any, other: Any) -> Aggregate:
    """A frame seen from where another one is: `BASE : POINT`; none of a base that a machine carries."""
    if not isinstance(one, Mapping) or not isinstance(other, Mapping) or UNIT in {**one, **other}:
        raise TypeError
    product = matrix_of(one, "the left side of ':'") @ matrix_of(other, "its right side")
    return {**other, **frame_of(product)}


def quotient(one: float, other: float) -> float:
    """A quotient; that of two integers is one too."""
    whole = isinstance(one, int) and isinstance(other, int)
    return math.trunc(one / other) if whole else one / other


def as_integer(value: Any) -> Any:
    """A value as an INT takes it: the nearest whole number, of two the greater."""
    return math.floor(value + 0.5) if is_number(value) else value


def as_real(value: Any) -> Any:
    """A value as a REAL takes it."""
    return float(value) if is_number(value) else value


def is_real(key: str) -> bool:
    """True for a part of a position, which is never an integer."""
    return key in FRAME or re.fullmatch("[AE][1-6]", key) is not None


def why(value: object) -> str:
    """Why a value is not known, or that it does not fit."""
    return value.why if isinstance(value, Unknown) else f"{value!r:.40} is given"


MOVES = {
    spline + kind + relative: kind.lower()
    for spline in ("", "S")
    for kind in ("PTP", "LIN", "CIRC")
    for relative in ("", "_REL")
}
"""The instructions that move, and the way each takes."""

WAIT, SPLINE = "WAIT SEC", "SPLINE"
"""Calls that stand for a wait, and for a spline, which is not read."""

REFUSED = {
    SPLINE: "a spline is not read",
    "RSI_MOVECORR": "RSI_MOVECORR moves the robot by sensors",
}
"""Moves that are not read, and why."""

PAUSES = ("HALT", "BRAKE")
"""Instructions that stop the robot on its way, until it goes on along it: at a key, or at an interrupt's end."""

PACKAGES = {"A20": "ARC_INI", "A10_INI": "", "A10": None, "H70": "1"}
"""Routines of KUKA's technology packages (arc welding, touch sensing) that programs call in their INI, with the
argument of that call; None where interrupts alone call one."""

QUIET = frozenset(
    "HALT BRAKE INTERRUPT TRIGGER ANOUT ANIN DIGIN SIGNAL EXT EXTFCT EXTP EXTFCTP STRUC ENUM IMPORT "
    "SET_CD_PARAMS MSGNOTIFY MSGQUIT ERR_CLEAR ON_ERROR_PROCEED".split()
)
"""Instructions that move nothing, whatever stands behind them."""

SIGNALS = ("$OUT", "$ANOUT", "$FLAG", "$TIMER_FLAG", "PULSE")
"""Instructions that set an output or a flag."""

NUMBERED = ("$IN", "$OUT", "$FLAG", "$TIMER_FLAG", "$ANIN")
"""Signals: each of a number is a variable of its own."""

NOTHING = ("CONTINUE", "DEFDAT", "ENDDAT")

TYPES = frozenset(("INT", "REAL", "BOOL", "CHAR", "FRAME", "POS", "E6POS", "AXIS", "E6AXIS"))

AGGREGATE = "{}"
"""The call that an aggregate is."""

WORD = re.compile(
    r"""(?P<skip>[ \t\f\v]+|;[^\n]*|\[[ \t,]*\])
    |(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|'[HhBb][0-9A-Fa-f]+')
    |(?P<string>"[^"\n]*")
    |(?P<name>\#?\$?[A-Za-z_][A-Za-z0-9_$]*)
    |(?P<mark>==|<>|<=|>=|[-+*/:.,=<>()\[\]{}])""",
    re.VERBOSE,
)


SYSTEM = "IR_STOPM"
"""What every program calls where the controller stops with a message: it moves nothing."""


def _of(kind: type, act: Callable[..., Any]) -> Callable[..., Any]:
    """An operator that takes truths, or whole numbers bit by bit, and raises TypeError for others, as KRL does."""

    def acted(*given: Any) -> Any:
        if any(type(one) is not kind for one in given):
            raise TypeError
        return act(*given)

    return acted


OF = " of "
"""Between a name that only its module knows and the module: no word of a file has it."""


def _folded(name: str) -> str:
    """A name as it is compared; messages do not show its module."""
    written, of, _ = name.upper().partition(OF.upper())
    return Spelled(name.upper(), written) if of else written


GRAMMAR = Grammar(
    binary=ranked(
        *("== <> < > <= >=", "OR B_OR", "EXOR B_EXOR", "AND B_AND", "+ -", "* /", ":"),
        own={
            **{"OR": _of(bool, operator.or_), "B_OR": _of(int, operator.or_)},
            **{"EXOR": _of(bool, operator.xor), "B_EXOR": _of(int, operator.xor)},
            **{"AND": _of(bool, operator.and_), "B_AND": _of(int, operator.and_)},
            **{"/": numeric(quotient), ":": composed},
        },
    ),
    unary={
        "NOT": (8, _of(bool, operator.not_)),
        "B_NOT": (8, _of(int, operator.invert)),
        "-": (8, operator.neg),
        "+": (8, operator.pos),
    },
    constants={"TRUE": True, "FALSE": False},
    leaves_out=True,
    fold=_folded,
)


class Expressions(ExpressionReader):
    """Expressions of KRL: aggregates, members of enumerations, and signals.

    Attributes:
        kinds: the types of variables by name, the nearest first; of a signal `SIGNAL $IN[3]`.
    """

    kinds: Sequence[Mapping[str, str]] = ()

    def _atom(self) -> Expression:
        found = self._value()
        if not isinstance(found, Name):
            return found
        kind = next((own[found.name] for own in self.kinds if found.name in own), "")
        if kind.startswith("SIGNAL $"):
            name, line = kind.removeprefix("SIGNAL "), found.line
            timer = re.fullmatch(r"(\$TIMER)\[(\d+)\]", name)  # it runs on, whatever it is set to
            return (
                Part(Name(timer[1], line), Constant(int(timer[2])), line)
                if timer
                else Name(name, line)
            )
        index = self.cursor.after(1)
        if found.name in NUMBERED and self.cursor.after(2).text == "]" and index.text.isdigit():
            self.cursor.take(), self.cursor.take(), self.cursor.take()
            return Name(f"{found.name}[{int(index.text)}]", found.line)
        return found

    def _value(self) -> Expression:
        word = self.cursor.next
        if self.cursor.accept("{"):
            return self._aggregate(word.line)
        if word.kind == "name" and word.text.startswith("#"):
            return Constant(self.cursor.take().text.upper())
        return super()._atom()

    def _aggregate(self, line: Line) -> Call:
        """The parts in braces, the first of which is taken; `{E6POS: X 1}` may name its type."""
        found, cursor = dict[str, Expression](), self.cursor
        while not cursor.is_at("}"):
            name = GRAMMAR.folded(cursor.expect_kind("name", "the name of a part").text)
            if not found and cursor.accept(":"):
                continue
            while cursor.accept("["):
                while not cursor.accept("]"):
                    name += cursor.expect_kind("number", "an index").text
            found[name] = self.expression()
            if not cursor.accept(",") and not cursor.is_at("}"):
                cursor.refuse("',' or '}'")
        cursor.expect("}")
        return Call(AGGREGATE, (), found, line)


def parameters_of(cursor: Cursor) -> tuple[tuple[str, ...], frozenset[str]]:
    """The names of parameters, and those whose values go back: all but `:IN`."""
    cursor.expect("(")
    found, returned = list[str](), set[str]()
    while not cursor.accept(")"):
        name = cursor.expect_kind("name", "a parameter").text.upper()
        words = list[str]()
        while not cursor.is_at(",", ")"):
            if cursor.next.kind == NEWLINE:
                cursor.refuse("')'")
            words.append(cursor.take().text.upper())
        found.append(name)
        if "IN" not in words:
            returned.add(name)
        cursor.accept(",")
    return tuple(found), frozenset(returned)


def called_beside(words: Sequence[Token]) -> tuple[Expression, ...]:
    """The name of the procedure that an interrupt or a trigger calls: `DO sub()`."""
    for do, name, mark in zip(words, words[1:], words[2:], strict=False):
        if do.text.upper() == "DO" and mark.text == "(":
            return (Constant(GRAMMAR.folded(name.text)),)
    return ()


def move_of(word: str, line: Line, read: Expressions) -> Call:
    """A move: its target, or the two of an arc; words for its end; what holds with it (`WITH $VEL.CP = 0.1`)."""
    cursor = read.cursor
    cursor.take()
    targets = [read.expression()]
    if cursor.accept(","):
        targets.append(read.expression())
    named = dict[str, Expression]()
    while cursor.accept(",") or cursor.next.kind != NEWLINE:
        if cursor.accept("WITH"):
            while True:
                target = read.expression()
                cursor.expect("=")
                named[f"WITH {len(named)}"] = Constant((target, read.expression()))
                if not cursor.accept(","):
                    break
            continue
        word_after = cursor.expect_kind("name", "a word for the corner").text.upper()
        if not word_after.startswith("C_") and word_after not in ("#TOOL", "#BASE"):
            raise BadSyntax(
                f"{word_after} is not read", where=str(line), valid="C_DIS, C_PTP, WITH, or nothing"
            )
        named[word_after] = Constant(True)
    return Call(word, tuple(targets), named, line)


def routines_beside(words: Sequence[Token], kinds: Sequence[Mapping[str, str]]) -> list[Routine]:
    """What an interrupt or a trigger may change, as a routine: `DO n = 2`, or `DO sub(n)` of a procedure.

    An input is one too that gives a variable a value again and again: `ANIN ON n = 2 * $ANIN[1]`.

    Args:
        kinds: as of `Expressions`.
    """
    texts = [one.text.upper() for one in words]
    do = "ON" if texts[0] in ("ANIN", "DIGIN") else "DO"
    behind = [*words][texts.index(do) + 1 :] if do in texts else []
    if len(behind) < 2 or behind[0].kind != "name":
        return []
    name, line, body = GRAMMAR.folded(behind[0].text), behind[0].line, list[Statement]()
    read = Expressions(Cursor(behind, folds=True), GRAMMAR)
    read.kinds = kinds
    if behind[1].text == "(" and name not in (*PACKAGES, SYSTEM):
        call = read.expression()
        if isinstance(call, Call) and any(assigned(one) for one in call.args):
            body.append(Do(line, call))
    elif behind[1].text != "(" and any(one.text == "=" for one in behind) and name != "$ANOUT":
        target = assigned(read.expression()) or Name(name, line)
        is_group = any(own.get(target.name) == "SIGNAL" for own in kinds)
        targets = (target, Name("$OUT", line)) if is_group else (target,)  # which is not read
        body += [Assign(line, one, Constant(Unknown("it is given beside"))) for one in targets]
    return [Routine(f"{name} at {line}", line, (), tuple(body))] if body else []


def named(words: list[Token], own: set[str], module: str) -> list[Token]:
    """Words, in which a module's own names have its name behind them; parts of aggregates are no such names."""
    found, opened = list[Token](), list[str]()
    for i, one in enumerate(words):
        if one.text in ("{", "[", "("):
            opened.append(one.text)
        elif one.text in ("}", "]", ")") and opened:
            opened.pop()
        before = [word.text for word in words[max(0, i - 3) : i]]
        begins = before[-1:] in (["{"], [","]) or (before[:1] == ["{"] and before[2:] == [":"])
        is_part = before[-1:] == ["."] or (opened[-1:] == ["{"] and begins)
        is_own = one.kind == "name" and not is_part and one.text.upper() in own
        found.append(one._replace(text=f"{one.text}{OF}{module}") if is_own else one)
    return found
