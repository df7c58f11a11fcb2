"""KRL, the language of KUKA's controllers: from the text of `.src` and `.dat` files to statements.

Not for: what instructions do (`krl`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from clearance.errors import BadSyntax
from clearance.formats.program.expressions import (
    MOST_DEPTH,
    Call,
    Constant,
    Expression,
    Name,
    Operation,
    Unknown,
)
from clearance.formats.program.krl_expressions import (
    GRAMMAR,
    MOVES,
    NOTHING,
    QUIET,
    SPLINE,
    TYPES,
    WAIT,
    Expressions,
    called_beside,
    parameters_of,
)
from clearance.formats.program.krl_values import as_integer, as_real
from clearance.formats.program.statements import (
    BREAK,
    RETURN,
    Assign,
    Do,
    For,
    If,
    Leave,
    Routine,
    Statement,
    Unreadable,
    While,
    assigned,
)
from clearance.formats.program.tokens import NEWLINE, Cursor, Line, Token

_Branch = tuple[Expression | None, tuple[Statement, ...]]

_JUMPS = ("RETURN", "EXIT", "GOTO", "BRAKE", "RESUME")  # decide which lines run

_ENDS = ("END", "ENDFCT", "DEF", "DEFFCT")


@dataclass(frozen=True)
class Module:
    """A file.

    Attributes:
        routines: by name in capitals, in order. public: those that others may call. declared: what stands outside.
    """

    routines: dict[str, Routine]
    public: frozenset[str]
    declared: tuple[Statement, ...]


def module_of(lines: Sequence[list[Token]], types: dict[str, str]) -> Module:
    """The statements of a file.

    Args:
        lines: the words of each, with its end. types: of the variables of all files, INT and REAL; those of this
            one are added.

    Raises:
        BadSyntax: a block or a procedure without its end, a move that cannot be read: with the line.
    """
    return _Reader(list(lines), types).module()


class _Reader:
    """Reads the lines of a file."""

    def __init__(self, lines: list[list[Token]], types: dict[str, str]) -> None:
        self._lines, self._at = lines, 0
        self._types, self._own = types, dict[str, str]()
        self._public, self._depth = set[str](), 0

    def module(self) -> Module:
        """All of it."""
        routines, declared = dict[str, Routine](), list[Statement]()
        while self._at < len(self._lines):
            if self._word in ("DEF", "DEFFCT") or self._second in ("DEF", "DEFFCT"):
                routine = self._routine()
                routines.setdefault(routine.name.upper(), routine)
            else:
                declared += self._body(("DEF", "DEFFCT"), within_routine=False)
        public = frozenset(self._public) | frozenset([*routines][:1])
        return Module(routines, public, tuple(declared))

    @property
    def _word(self) -> str:
        return self._lines[self._at][0].text.upper()

    @property
    def _second(self) -> str:
        """The word after GLOBAL."""
        return self._lines[self._at][1].text.upper() if self._word == "GLOBAL" else ""

    def _taken(self) -> Expressions:
        """The words of the next line, which is then behind."""
        self._at += 1
        return Expressions(Cursor(self._lines[self._at - 1], folds=True), GRAMMAR)

    def _routine(self) -> Routine:
        """A procedure or a function, at whose head this is."""
        cursor = self._taken().cursor
        is_public = cursor.accept("GLOBAL")
        head = cursor.expect("DEF", "DEFFCT")
        end = "END" if head.text.upper() == "DEF" else "ENDFCT"
        names = [cursor.expect_kind("name", "a name")]
        while not cursor.is_at("("):
            names.append(cursor.take())
            if names[-1].kind == NEWLINE:
                cursor.refuse("'('")
        parameters, returned = parameters_of(cursor)
        self._own = {}
        self._public.update([names[-1].text.upper()] if is_public else [])
        body = [one for one in self._body(_ENDS) if _declared(one) not in parameters]
        if self._at >= len(self._lines) or self._word != end:
            raise BadSyntax(
                f"{names[-1].text} has no {end}",
                where=str(head.line),
                valid="a whole file: this one is cut off",
            )
        self._at += 1
        return Routine(names[-1].text, head.line, parameters, tuple(body), returned=returned)

    def _body(self, ends: Sequence[str], within_routine: bool = True) -> list[Statement]:
        """Statements up to one of some words."""
        found = list[Statement]()
        while self._at < len(self._lines) and self._word not in ends and self._second not in ends:
            found += self._statement(within_routine)
        return found

    def _until(self, line: Line, word: str, *ends: str) -> list[Statement]:
        """The statements of a block up to one of its ends, which is not taken.

        Raises:
            BadSyntax: it has none, or is too deep in others.
        """
        self._depth += 1
        if self._depth > MOST_DEPTH:
            raise BadSyntax(f"{word} within {MOST_DEPTH} blocks", where=str(line), valid="fewer")
        found = self._body((*ends, *_ENDS))
        self._depth -= 1
        if self._at >= len(self._lines) or self._word not in ends:
            raise BadSyntax(
                f"{word} has no {ends[-1]}",
                where=str(line),
                valid="a whole file: this one is cut off",
            )
        return found

    def _statement(self, within_routine: bool) -> list[Statement]:
        """The statements of the next line, and of the block that begins there."""
        word, line = self._word, self._lines[self._at][0].line
        if (block := self._block(word, line)) is not None:
            return [block]
        read = self._taken()
        if word == "GLOBAL" and read.cursor.after(1).text.upper() == "INTERRUPT":
            word = "INTERRUPT"
        if word in ("DECL", "GLOBAL", *TYPES):
            return self._declared(read, within_routine)
        if word in QUIET:
            return [Do(line, Call(word, called_beside(self._lines[self._at - 1]), {}, line))]
        if word in NOTHING:
            return []
        try:
            return self._simple(word, line, read)
        except BadSyntax:
            marks = {one.text for one in self._lines[self._at - 1]}
            if word in (*MOVES, "WAIT") or "{" in marks:
                raise
            if "=" in marks and "(" not in marks:
                unread = Constant(Unknown(f"{word} is given what is not read"))
                return [Assign(line, Name(word, line), unread)]
            return [Unreadable(line, word, word in _JUMPS)] if within_routine else []

    def _block(self, word: str, line: Line) -> Statement | None:
        """The statement that a block is, which begins with a word; None for another one."""
        match word:
            case "IF":
                return self._if(line)
            case "SWITCH":
                return self._switch(line)
            case "FOR":
                return self._for(line)
            case "WHILE":
                return self._while(line)
            case "REPEAT":
                return self._repeat(line)
            case "LOOP":
                return self._loop(line)
            case "SPLINE" | "PTP_SPLINE":
                return self._spline(line)
        return None

    def _simple(self, word: str, line: Line, read: Expressions) -> list[Statement]:
        """A statement of one line."""
        cursor = read.cursor
        if cursor.after(1).text == ":" and cursor.after(2).kind == NEWLINE:
            return []  # the target of a jump
        if word in ("RETURN", "EXIT"):
            cursor.take()
            value = read.expression() if cursor.next.kind != NEWLINE else None
            return [Leave(line, word, RETURN if word == "RETURN" else BREAK, value)]
        if word in (*_JUMPS, "HALT"):
            return [Unreadable(line, word, word != "HALT")]
        if word == "WAIT":
            return [self._wait(line, read)]
        if word in MOVES:
            return [Do(line, _move(word, line, read))]
        target = read.expression()
        if cursor.accept("="):
            return [self._assign(line, target, read)]
        _require_end(cursor)
        call = target if isinstance(target, Call) else Call(word, (), {}, line)
        return [Do(line, call)]

    def _declared(self, read: Expressions, within_routine: bool) -> list[Statement]:
        """The values that a declaration gives; an array begins empty."""
        cursor, found = read.cursor, list[Statement]()
        is_global = False
        while cursor.is_at("DECL", "GLOBAL", "CONST"):
            is_global |= cursor.take().text.upper() == "GLOBAL"
        kind = cursor.take().text.upper()
        while cursor.next.kind == "name":
            name = Name(GRAMMAR.folded(cursor.take().text), cursor.next.line)
            is_array = cursor.is_at("[")
            while cursor.next.kind != NEWLINE and not cursor.is_at(",", "="):
                if cursor.take().text == "[":
                    while cursor.next.kind != NEWLINE and not cursor.accept("]"):
                        cursor.take()
            own = within_routine and not is_global
            (self._own if own else self._types)[name.name] = kind
            if cursor.accept("="):
                value = self._of_type(name, read.expression())
                found.append(Assign(name.line, name, value, own, is_global))
            else:
                start: Any = {} if is_array else Unknown(f"{name.name} is given no value")
                found.append(Assign(name.line, name, Constant(start), own, is_global))
            if not cursor.accept(","):
                break
        return found

    def _of_type(self, target: Expression, value: Expression) -> Expression:
        """A value as a variable of its type takes it."""
        name = assigned(target)
        kind = "" if name is None else self._own.get(name.name) or self._types.get(name.name, "")
        act = {"INT": as_integer, "REAL": as_real}.get(kind)
        return value if act is None or name is None else Operation(act, (value,), name.line)

    def _assign(self, line: Line, target: Expression, read: Expressions) -> Statement:
        """A value for a variable, or for an output, which moves nothing."""
        name = assigned(target)
        if name is not None and name.name in ("$OUT", "$ANOUT"):
            return Do(line, Call("$OUT", (), {}, line))
        value = read.expression()
        _require_end(read.cursor)
        return Assign(line, target, self._of_type(target, value))

    def _wait(self, line: Line, read: Expressions) -> Statement:
        cursor = read.cursor
        cursor.take()
        if cursor.expect("SEC", "FOR").text.upper() == "SEC":
            return Do(line, Call(WAIT, (read.expression(),), {}, line))
        return While(line, "WAIT FOR", read.expression(), (), at_end=True)

    def _if(self, line: Line) -> If:
        read = self._taken()
        read.cursor.take()
        condition = read.expression()
        read.cursor.expect("THEN")
        branches: list[_Branch] = [(condition, tuple(self._until(line, "IF", "ELSE", "ENDIF")))]
        if self._word == "ELSE":
            self._at += 1
            branches.append((None, tuple(self._until(line, "IF", "ENDIF"))))
        self._at += 1
        return If(line, "IF", tuple(branches))

    def _switch(self, line: Line) -> If:
        read = self._taken()
        read.cursor.take()
        value = read.expression()
        self._until(line, "SWITCH", "CASE", "DEFAULT", "ENDSWITCH")
        branches = list[_Branch]()
        while self._word != "ENDSWITCH":
            case = self._taken()
            condition: Expression | None = None
            if case.cursor.take().text.upper() == "CASE":
                condition = _one_of(value, case)
            branches.append(
                (condition, tuple(self._until(line, "SWITCH", "CASE", "DEFAULT", "ENDSWITCH")))
            )
        self._at += 1
        return If(line, "SWITCH", tuple(branches))

    def _for(self, line: Line) -> For:
        read = self._taken()
        cursor = read.cursor
        cursor.take()
        name = Name(GRAMMAR.folded(cursor.expect_kind("name", "a variable").text), line)
        cursor.expect("=")
        first = read.expression()
        cursor.expect("TO")
        last = read.expression()
        step = read.expression() if cursor.accept("STEP") else None
        whole = Assign(line, name, Operation(as_integer, (name,), line))
        body = (whole, *self._until(line, "FOR", "ENDFOR"))
        self._at += 1
        return For(line, "FOR", name, first, last, step, body)

    def _while(self, line: Line) -> While:
        read = self._taken()
        read.cursor.take()
        condition = read.expression()
        body = tuple(self._until(line, "WHILE", "ENDWHILE"))
        self._at += 1
        return While(line, "WHILE", condition, body)

    def _repeat(self, line: Line) -> While:
        self._at += 1
        body = tuple(self._until(line, "REPEAT", "UNTIL"))
        read = self._taken()
        read.cursor.take()
        return While(line, "REPEAT", read.expression(), body, at_end=True)

    def _loop(self, line: Line) -> While:
        self._at += 1
        body = tuple(self._until(line, "LOOP", "ENDLOOP"))
        self._at += 1
        return While(line, "LOOP", Constant(True), body)

    def _spline(self, line: Line) -> Do:
        """A spline, whose parts are passed over: it is refused when it is run."""
        while self._at < len(self._lines) and self._word not in ("ENDSPLINE", *_ENDS):
            self._at += 1
        self._at += 1
        return Do(line, Call(SPLINE, (), {}, line))


def _move(word: str, line: Line, read: Expressions) -> Call:
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


def _declared(one: Statement) -> str:
    """The variable that a statement declares without a value: of a parameter, the caller gives it."""
    match one:
        case Assign(target=Name(name=name), value=Constant(), is_own=True):
            return name
    return ""


def _require_end(cursor: Cursor) -> None:
    if cursor.next.kind != NEWLINE:
        cursor.refuse("the end of the line")


def _one_of(value: Expression, read: Expressions) -> Expression:
    """True where a value is one of those that a CASE lists."""
    line, cases = read.cursor.next.line, [read.expression()]
    while read.cursor.accept(","):
        cases.append(read.expression())
    return Operation(lambda found, *given: found in given, (value, *cases), line)
