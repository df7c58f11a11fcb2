"""Listings of FANUC's teach pendant programs (`.ls`): from text to statements and positions.

Not for: what instructions do (`fanuc`).
"""

from __future__ import annotations

import operator
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain

from clearance.errors import BadProgram, BadSyntax
from clearance.formats.program.blocks import BlockReader
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    ExpressionReader,
    Name,
    Operation,
    Unknown,
)
from clearance.formats.program.fanuc_positions import Position, positions_of
from clearance.formats.program.fanuc_words import (
    ANY_REGISTER,
    MOVES,
    OUTPUTS,
    QUIET,
    WAIT,
    Motion,
    named,
)
from clearance.formats.program.grammar import Grammar, ranked
from clearance.formats.program.passes import require_one_each
from clearance.formats.program.statements import (
    JUMP,
    RETURN,
    STOP,
    Assign,
    Do,
    For,
    If,
    Label,
    Leave,
    Routine,
    Statement,
    Unreadable,
    While,
    within,
)
from clearance.formats.program.tokens import END, Cursor, Line, Token, text_of, tokens_of

_WORD = re.compile(
    r"""(?P<skip>[ \t]+)
    |(?P<number>[0-9]+\.?[0-9]*|\.[0-9]+)
    |(?P<string>'[^']*')
    |(?P<name>[A-Z$_][A-Z0-9_$.]*(?:\[(?:[^\[\]]|\[[^\]]*\])*\])?)
    |(?P<mark><>|<=|>=|[-+*/=<>!(),])""",
    re.VERBOSE | re.IGNORECASE,
)


_GRAMMAR = Grammar(
    binary=ranked("OR", "AND", "= <> < > <= >=", "+ -", "* / DIV MOD"),
    unary={"!": (6, operator.not_), "-": (6, operator.neg)},
    constants={"ON": True, "OFF": False, "TRUE": True, "FALSE": False},
    index="\0\0",
    fold=named,
)

_REGISTERED = r"A?R\s*\[(?:[^\[\]]|\[[^\]]*\])*\]"
_NUMBER = r"\[((?:[^\[\]:]|\[(?:[^\[\]]|\[[^\]]*\])*\])*)(?::[^\]]*)?\]"
_POINT = rf"(PR?)\s*{_NUMBER}"
_LABEL, _JUMP = (
    re.compile(rf"{word}\s*{_NUMBER}", re.IGNORECASE) for word in ("LBL", r"JMP\s+LBL")
)
_MOTION = re.compile(rf"([JLCAS])\s+{_POINT}(?:\s*{_POINT})?\s*(.*)", re.IGNORECASE | re.DOTALL)
_SPEED = re.compile(
    r"\s*([0-9]+\.?[0-9]*|\.[0-9]+|A?R\s*\[[^\]]*\]|\w+)\s*(mm/sec|cm/min|inch/min|deg/sec|msec|sec|%)?\s*(.*)",
    re.IGNORECASE | re.DOTALL,
)
_END = re.compile(r"(FINE|(?:CNT|CR|CD)\s*(?:R\s*\[[^\]]*\]|[\w.]+))\s*", re.IGNORECASE)
_ASSIGNED = re.compile(r"(?is)((?:R|P|UFRAME|UTOOL)\s*\[[^\[\]]*\]|U(?:FRAME|TOOL)_NUM)\s*=(.*)")
_SIGNAL = re.compile(r"(?is)(\w+\s*\[(?:[^\[\]]|\[[^\]]*\])*\])\s*=(.*)")
_POINT_CHANGED = re.compile(r"(?i)(?<![A-Z])P\s*\[(?:[^\[\]]|\[[^\]]*\])*\]\s*=(?!=)")
_REGISTER = re.compile(r"(?is)PR\s*\[\s*(\d+)\s*(?:,\s*([1-6])\s*)?(?::[^\]]*)?\]\s*=(.*)")
_OFFSET = re.compile(rf"(?i)\b((?:TOOL_)?OFFSET)\s*,\s*PR\s*{_NUMBER}")
_JUMPS = re.compile(r"\b(?:JMP|LBL|CALL)\b", re.IGNORECASE)
_TIMED = re.compile(
    r"(?i)\b(TA|TB|DB)\s+[-+0-9.R\[\]]+\s*(sec|mm)\s*,\s*"
    r"(P-SPS\b|CALL\s+[\w-]+(\s*\([^()]*\))?|\w+\s*\[[^\]]*\]\s*=\s*[^\s,]+)"
)


_ARGUMENTS = tuple(f"AR[{i}]" for i in range(1, 11))


def listing_of(data: bytes, file: str = "") -> tuple[Routine, ...]:
    """The program in a file, its name in capitals, and what its motions do on their way.

    Args:
        file: as of a `Line`.

    Raises:
        BadProgram: a part that is not there; BadSyntax: an instruction without its end: with the line.
    """
    text = text_of(data, file)
    head = re.search(r"^/PROG\s+(\S+)", text, re.MULTILINE)
    start, points, end = (
        re.search(rf"^/{part}\b.*$", text, re.MULTILINE) for part in ("MN", "POS", "END")
    )
    if head is None or start is None or end is None:
        missing = "/PROG" if head is None else "/MN" if start is None else "/END"
        raise BadProgram(
            f"no {missing} is in it",
            where=file,
            valid="a whole listing: this one is none, or cut off",
        )
    body_end = end.start() if points is None else points.start()
    positions = {} if points is None else positions_of(text[points.end() : end.start()])
    rows = text[start.end() : body_end].split("\n")
    first = text.count("\n", 0, start.end()) + 1
    instructions = [*_instructions(rows, first, file), Token(END, "", Line(first, file))]
    reader = _Reader(instructions, positions)
    return Routine(head[1].upper(), Line(1), _ARGUMENTS, reader.all()), *reader.blocks


def _instructions(rows: list[str], first: int, file: str) -> Iterator[Token]:
    """The text of each instruction without its number, and its line; remarks are left out."""
    parts, line = list[str](), Line(first, file)
    for number, row in enumerate(rows, first):
        part = re.sub(r"^\s*\d*\s*:", "", row).strip()
        if not part:
            continue
        own = re.match(r"\s*(\d+)\s*:", row)
        if parts and own:
            break  # the one before has no end
        line = line if parts else Line(number, file, int(own[1]) if own else 0)
        parts.append(part)
        if part.endswith(";"):
            text = " ".join(parts)[:-1].strip()
            if text and (not text.startswith(("!", "//", "--")) or not text.strip("-")):
                yield Token("instruction", text, line)
            parts = []
    if parts:
        fault = f"{' '.join(parts)!r:.60} has no end"
        raise BadSyntax(fault, where=str(line), valid="';', in a whole file")


class _Instructions(Cursor):
    """Goes through instructions, each of which counts as its first word."""

    def is_at(self, *words: str) -> bool:
        return self.next.kind != END and _first(self.next.text) in words


class _Reader(BlockReader):
    """Reads the instructions of a listing."""

    ends = ("ENDIF", "ELSE", "ENDFOR", "=")

    def __init__(self, instructions: Sequence[Token], positions: Mapping[int, Position]) -> None:
        super().__init__(ExpressionReader(_Instructions(instructions), _GRAMMAR))
        self.positions, self.blocks = positions, list[Routine]()
        self.moves_points = any(_POINT_CHANGED.search(one.text) for one in instructions)

    def all(self) -> tuple[Statement, ...]:
        """All statements.

        Raises:
            BadSyntax: the end of a block that is none.
        """
        found, last = self.body(), self.cursor.next
        if last.kind != END:
            fault = f"{last.text!r:.60} ends nothing"
            raise BadSyntax(fault, where=str(last.line), valid="a whole file")
        require_one_each(found)
        return found

    def statement(self) -> list[Statement]:
        """The statements of the next instruction, and of the block that it begins."""
        _, text, line = self.cursor.take()
        word = _first(text)
        if word == "FOR":
            return [self._for(line, text)]
        if word == "SELECT":
            return [self._select(line, text)]
        found = re.fullmatch(r"IF\b(.*)\bTHEN", text, re.IGNORECASE | re.DOTALL)
        return [self._if(line, found[1])] if found else self._simple(line, text)

    def _if(self, line: Line, condition: str) -> If:
        branches = [(_condition(condition, line), self.block(line, "IF", "ELSE", "ENDIF"))]
        if self.cursor.accept("ELSE"):
            branches.append((Constant(True), self.block(line, "IF", "ENDIF")))
        self.cursor.take()
        return If(line, "IF", tuple(branches))

    def _select(self, line: Line, text: str) -> If:
        """`SELECT R[1]=1,…`, and the instructions after it that begin with `=` or `ELSE`."""
        condition, action = _split(text[len("SELECT") :])
        value, _, first = condition.partition("=")
        branches = [(_condition(f"{value}={first}", line), self._action(line, action))]
        while case := self.cursor.accept("=", "ELSE"):
            condition, action = _split(case.text)
            is_other = _first(case.text) == "ELSE"
            asked = Constant(True) if is_other else _condition(f"{value}{condition}", case.line)
            branches.append((asked, self._action(case.line, action)))
        return If(line, "SELECT", tuple(branches))

    def _for(self, line: Line, text: str) -> For:
        found = re.fullmatch(
            r"FOR\s+(R\[[^\]]*\])\s*=(.*?)\b(TO|DOWNTO)\b(.*)", text, re.IGNORECASE | re.DOTALL
        )
        if found is None:
            fault = f"{text!r:.60} cannot be read"
            raise BadSyntax(fault, where=str(line), valid="FOR R[1]=1 TO 3")
        first, last = (_condition(found[i], line) for i in (2, 4))
        step = Constant(1.0 if found[3].upper() == "TO" else -1.0)
        body = self.block(line, "FOR", "ENDFOR")
        self.cursor.take()
        return For(line, "FOR", Name(named(found[1]), line), first, last, step, body)

    def _action(self, line: Line, text: str) -> tuple[Statement, ...]:
        """The statements that a condition decides on; they hold no further one."""
        if _first(text) == "IF":
            return (Unreadable(line, "IF", jumps=True),)
        return tuple(self._simple(line, text))

    def _simple(self, line: Line, text: str) -> list[Statement]:
        """A statement that holds no other."""
        word = _first(text)
        if word in MOVES and (motion := _MOTION.fullmatch(text)):
            return [self._motion(line, motion)]
        if word == "-":
            return []
        if (label := _LABEL.fullmatch(text)) and label[1].strip().isdecimal():
            return [Label(line, int(label[1]))]
        if jump := _JUMP.fullmatch(text):
            return [Leave(line, word, JUMP, _index(jump[1], line))]
        if word in ("END", "ABORT"):
            return [Leave(line, word, RETURN if word == "END" else STOP)]
        if word == "IF":
            condition, action = _split(text[2:])
            return [If(line, word, ((_condition(condition, line), self._action(line, action)),))]
        if word == "WAIT":
            return _wait(line, text[4:].strip())
        if word == "RUN":
            other = Constant(text[3:].strip().upper())
            return [Unreadable(line, word), Do(line, Call(word, (other,), {}, line))]
        if word == "CALL":
            return [_call(line, text[4:].strip())]
        if word == "PR" and "=" in text:
            return [self._register(line, text)]
        assigned = _ASSIGNED.match(text)
        if assigned is not None and not re.search(r"\[GP|,", named(assigned[1])):
            name = Name(named(assigned[1]), line)
            return [Assign(line, name, _condition(assigned[2], line), is_of_all=True)]
        if word in OUTPUTS and (signal := _SIGNAL.fullmatch(text)):
            target = Name(named(signal[1]), line)
            return [Do(line, Call(word, (target, _condition(signal[2], line)), {}, line))]
        if word in QUIET:
            share = re.fullmatch(r"(?is)OVERRIDE\s*=\s*(.*?)\s*%?", text)
            args = () if share is None else (_condition(share[1], line),)
            return [Do(line, Call(word, args, {}, line))]
        return [Unreadable(line, word, bool(_JUMPS.search(text)))]

    def _register(self, line: Line, text: str) -> Assign:
        """A value for a position register, or for one of its values."""
        found = _REGISTER.fullmatch(text)
        if found is None:
            unread = Constant(Unknown(f"{text!r:.40} is not read"))
            return Assign(line, Name(ANY_REGISTER, line), unread, is_of_all=True)
        name, value = Name(f"PR[{int(found[1])}]", line), found[3].strip()
        point = re.fullmatch(rf"(?i)(PR?)\s*{_NUMBER}", value)
        if found[2]:
            parts = (name, Constant(int(found[2])), _condition(value, line))
            given: Expression = Operation(Position.with_element, parts, line)
        elif point and point[1].upper() == "PR":
            given = _condition(value, line)
        elif (
            point
            and point[2].strip().isdecimal()
            and int(point[2]) in self.positions
            and not self.moves_points
        ):
            given = Constant(self.positions[int(point[2])])
        else:
            given = Constant(Unknown(f"{value!r:.40} is not read"))
        return Assign(line, name, given, is_of_all=True)

    def _motion(self, line: Line, found: re.Match[str]) -> Do:
        """A motion; its speed is the second argument.

        Raises:
            BadSyntax: no speed, or no end, as in a file that is cut off.
        """
        points = [(found[2].upper(), _index(found[3], line))]
        if found[4] is not None:
            points.append((found[4].upper(), _index(found[5], line)))
        speed = _SPEED.fullmatch(found[6])
        end = None if speed is None else _END.match(speed[3])
        if speed is None or end is None:
            fault = f"{found[0]!r:.60} has no speed and end"
            raise BadSyntax(fault, where=str(line), valid="as in L P[1] 100mm/sec FINE")
        further = speed[3][end.end() :]
        offsets = tuple((one[1].upper(), _index(one[2], line)) for one in _OFFSET.finditer(further))
        further = _OFFSET.sub("", further)
        options = tuple(_TIMED.sub("", further).upper().replace(",", " ").split())
        timed = (self._on_the_way(line, one[3]) for one in _TIMED.finditer(further))
        unit = (speed[2] or "").lower()
        ends = (tuple(points), self.positions, unit, named(end[1]))
        motion = Motion(*ends, options, tuple(chain(*timed)), offsets)
        args = (Constant(motion), _condition(speed[1], line))
        return Do(line, Call(found[1].upper(), args, {}, line))

    def _on_the_way(self, line: Line, text: str) -> list[Statement]:
        """What a motion does on its way: one statement, or for `P-SPS` a call of those that follow up to dashes.

        Raises:
            BadSyntax: there are no dashes.
        """
        if text.upper() != "P-SPS":
            return self._simple(line, text)
        body = list[Statement]()
        while not self.cursor.accept("-"):
            if self.cursor.next.kind == END:
                raise BadSyntax("P-SPS has no end", where=str(line), valid="a line of dashes")
            body += self.statement()
        leaves = [one for one in within(tuple(body)) if isinstance(one, Leave) and one.what != STOP]
        body += (Unreadable(one.line, one.word, jumps=True) for one in leaves)
        name = f"P-SPS of {line}"
        self.blocks.append(Routine(name, line, (), tuple(body)))
        return [Do(line, Call(name, (), {}, line))]


def _first(text: str) -> str:
    """The first word of an instruction, in capitals."""
    found = re.match(r"\s*([A-Za-z_$][\w$.]*|=|-)", text)
    return found[1].upper() if found else text[:1]


def _split(text: str) -> tuple[str, str]:
    """A condition and what is done then, parted by the first comma outside of brackets."""
    depth = 0
    for i, letter in enumerate(text):
        depth += (letter in "([") - (letter in ")]")
        if letter == "," and depth == 0:
            return text[:i].strip(), text[i + 1 :].strip()
    return text, ""


def _index(text: str, line: Line) -> Expression:
    """The number of a point, a label or a register: as it is, or in a register."""
    if re.fullmatch(rf"(?i)\s*(\d+|{_REGISTERED})\s*", text):
        return _condition(text, line)
    return Constant(Unknown(f"{text.strip()!r:.40} is not read"))


def _condition(text: str, line: Line) -> Expression:
    """The expression in a text; what cannot be read is not known."""
    tokens = [one._replace(line=line) for one in tokens_of(text.strip(), _WORD)]
    reader = ExpressionReader(Cursor(tokens, folds=True), _GRAMMAR)
    try:
        found = reader.expression()
        if reader.cursor.next.kind == END:
            return found
    except BadSyntax:
        pass
    return Constant(Unknown(f"{text.strip()!r:.40} is not read"))


def _wait(line: Line, text: str) -> list[Statement]:
    """A wait: for some time, or for what only the controller knows, with a jump if that does not come in time."""
    seconds = re.fullmatch(
        r"([0-9]*\.?[0-9]+|R\s*\[[^\]]*\])\s*(?:\(?\s*sec\s*\)?)?", text, re.IGNORECASE
    )
    if seconds is not None:
        return [Do(line, Call(WAIT, (_condition(seconds[1], line),), {}, line))]
    condition, _, late = text.partition("TIMEOUT")
    waits = While(line, "WAIT", _condition(condition, line), (), at_end=True)
    if not late:
        return [waits]
    label = re.fullmatch(rf"(?i)\s*,\s*LBL\s*{_NUMBER}\s*", late)
    if label is None:
        return [Unreadable(line, "TIMEOUT", jumps=True)]
    in_time = Constant(
        Unknown(f"only the controller knows whether {condition.strip()} comes in time")
    )
    jump = Leave(line, "TIMEOUT", JUMP, _index(label[1], line))
    return [If(line, "TIMEOUT", ((in_time, (jump,)),)), waits]


def _call(line: Line, text: str) -> Statement:
    """A call of another program."""
    found = re.fullmatch(r"([\w-]+)\s*(?:\((.*)\))?", text, re.DOTALL)
    if found is None:
        return Unreadable(line, "CALL", jumps=True)
    given = [] if not (found[2] or "").strip() else found[2].split(",")
    return Do(line, Call(found[1].upper(), tuple(_condition(one, line) for one in given), {}, line))
