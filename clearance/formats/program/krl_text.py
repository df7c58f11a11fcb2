"""KRL, the language of KUKA's controllers: from `.src` and `.dat` files to statements.

Not for: what instructions do (`krl`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import Any

from clearance.errors import BadProgram, BadSyntax, DuplicateName
from clearance.formats.program.blocks import BlockReader
from clearance.formats.program.controller_program import ProgramRequest
from clearance.formats.program.expressions import (
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
    OF,
    QUIET,
    SIGNALS,
    SPLINE,
    TYPES,
    WAIT,
    WORD,
    Expressions,
    as_integer,
    as_real,
    called_beside,
    move_of,
    named,
    parameters_of,
    routines_beside,
)
from clearance.formats.program.krl_settings import FIRST
from clearance.formats.program.krl_system import remedy_of
from clearance.formats.program.passes import require_one_each
from clearance.formats.program.statements import (
    BREAK,
    JUMP,
    RETURN,
    Assign,
    Do,
    Label,
    Leave,
    Routine,
    Statement,
    Unreadable,
    While,
    assigned,
)
from clearance.formats.program.tokens import END, NEWLINE, Cursor, Line, Token, text_of, tokens_of

_BLOCKS = ("IF", "SWITCH", "WHILE", "FOR", "REPEAT", "LOOP", SPLINE, "PTP_SPLINE")

_HEADS = ("DEF", "DEFFCT")

_ENDS = (
    *("END", "ENDFCT", *_HEADS, "ELSE", "ENDIF", "CASE", "DEFAULT", "ENDSWITCH", "ENDFOR"),
    *("ENDWHILE", "UNTIL", "ENDLOOP"),
)


@dataclass(frozen=True)
class Module:
    """A file.

    Attributes:
        routines: by name in capitals, in order. public: those that others may call. declared: what stands outside.
    """

    routines: dict[str, Routine]
    public: tuple[str, ...]
    declared: tuple[Statement, ...]


def _module_of(rows: Iterable[list[Token]], types: dict[str, str]) -> Module:
    """The statements of a file.

    Args:
        rows: the words of each line, with its end. types: of the variables of all files, INT and REAL; those of
            this one are added.

    Raises:
        BadSyntax: a block or a procedure without its end, a move that cannot be read: with the line.
    """
    words, public, last = list[Token](), set[Line](), Line(1)
    for row in rows:
        last = row[0].line
        is_public = row[0].text.upper() == "GLOBAL" and row[1].text.upper() in _HEADS
        public |= {last} if is_public else set()
        words += row[is_public:]
    cursor = Cursor([*words, Token(END, "", last)], folds=True)
    return _Reader(Expressions(cursor, GRAMMAR), types, public).module()


class _Reader(BlockReader):
    """Reads the lines of a file."""

    ends = _ENDS

    def __init__(
        self, expressions: Expressions, types: dict[str, str], public: Collection[Line]
    ) -> None:
        super().__init__(expressions)
        self._types, self._own, self._in_routine = types, dict[str, str](), False
        self._kinds = expressions.kinds = (self._own, types)
        self._public, self._beside = public, dict[str, Routine]()

    def module(self) -> Module:
        """All of it."""
        routines, declared, public = dict[str, Routine](), list[Statement](), set[str]()
        while self.cursor.next.kind != END:
            declared += self.body()
            if self.cursor.next.kind != END:
                is_public = self.cursor.next.line in self._public
                routine = self._routine()
                name = GRAMMAR.folded(routine.name)
                _add(routines, {name: routine})
                public.update([name] if is_public else [])
        first = [*routines][:1]
        return Module({**routines, **self._beside}, (*public, *first), tuple(declared))

    def _routine(self) -> Routine:
        """A procedure or a function, at whose head this is."""
        cursor = self.cursor
        head = cursor.expect(*_HEADS)
        end = "END" if head.text.upper() == "DEF" else "ENDFCT"
        names = [cursor.expect_kind("name", "a name")]
        while not cursor.is_at("("):
            if cursor.next.kind == NEWLINE:
                cursor.refuse("'('")
            names.append(cursor.take())
        parameters, returned = parameters_of(cursor)
        self._row()
        self._own.clear()
        self._own.update(dict.fromkeys(parameters, ""))
        self._in_routine = True
        body = self.block(head.line, names[-1].text, end)
        self._in_routine = False
        cursor.take()
        own = tuple(one for one in body if _declared(one) not in parameters)
        require_one_each(body)
        return Routine(names[-1].text, head.line, parameters, own, returned=returned)

    def _row(self) -> list[Token]:
        """The words of a line from here, and its end, which are then behind."""
        found = [self.cursor.take()]
        while found[-1].kind not in (NEWLINE, END):
            found.append(self.cursor.take())
        return found

    def statement(self) -> list[Statement]:
        """The statements of the next line, and of the block that begins there."""
        cursor, first = self.cursor, self.cursor.next
        word, line = GRAMMAR.folded(first.text), first.line
        if cursor.accept(*_BLOCKS):
            return [self._block(word, line)]
        row = self._row()
        if [one.text.upper() for one in row[:2]] == ["GLOBAL", "INTERRUPT"]:
            word = "INTERRUPT"
        read = Expressions(Cursor(row, folds=True), GRAMMAR)
        read.kinds = self._kinds
        if word in ("DECL", "GLOBAL", *TYPES):
            return self._declared(read)
        if word == "IMPORT" and len(row) > 3:  # `IMPORT INT n IS /R1/other..n`
            unread = Constant(Unknown("IMPORT is not read"))
            return [Assign(line, Name(GRAMMAR.folded(row[2].text), line), unread)]
        if word == "SIGNAL" and len(row) > 3:  # `SIGNAL gripper_open $IN[5]`
            name = Name(GRAMMAR.folded(row[1].text), line)
            place = "".join(one.text for one in row[2:-1])  # of several bits, `$IN[1]TO$IN[8]`
            kind = f"{word} {place.upper()}" if place.count("$") == 1 else word
            (self._own if self._in_routine else self._types)[name.name] = kind
            return [Assign(line, name, self._of_type(name, name), self._in_routine)]
        if word == "PULSE" and len(row) > 3:
            read.cursor.take(), read.cursor.take()
            unread = Constant(Unknown(f"PULSE sets it at {line}"))
            return [Do(line, Call(word, (read.expression(), unread), {}, line))]
        if word in QUIET:
            more = routines_beside(row, self._kinds)
            self._beside |= {one.name: one for one in more}
            calls = (called_beside(row), *((Constant(one.name),) for one in more))
            return [Do(line, Call(word, one, {}, line)) for one in calls]
        if word in NOTHING:
            return []
        try:
            return self._simple(word, line, read)
        except BadSyntax:
            marks = {one.text for one in row}
            if word in (*MOVES, "WAIT") or "{" in marks:
                raise
            if "=" in marks and "(" not in marks:
                unread = Constant(Unknown(f"{word} is given what is not read"))
                return [Assign(line, Name(word, line), unread)]
            jumps = word in ("RETURN", "EXIT", "GOTO", "RESUME")
            return [Unreadable(line, word, jumps)] if self._in_routine else []

    def _block(self, word: str, line: Line) -> Statement:
        """The statement that a block is, whose first word is taken."""
        match word:
            case "IF":
                return self.branches(line, word, self.expression(), "THEN", "", "ENDIF")
            case "SWITCH":
                return self.cases(line, word, "ENDSWITCH")
            case "WHILE":
                return self.loop(line, word, "", "ENDWHILE")
            case "FOR":
                found = self.counted(line, word, "=", "")
                whole = Assign(line, found.name, Operation(as_integer, (found.name,), line))
                return replace(found, body=(whole, *found.body))
            case "REPEAT" | "LOOP":
                end = "UNTIL" if word == "REPEAT" else "ENDLOOP"
                body = self.block(line, word, end)
                self.cursor.take()
                condition = self.expression() if word == "REPEAT" else Constant(True)
                return While(line, word, condition, body, at_end=word == "REPEAT")
        while not self.cursor.is_at("ENDSPLINE", *_ENDS) and self.cursor.next.kind != END:
            self._row()
        self.cursor.accept("ENDSPLINE")
        return Do(line, Call(SPLINE, (), {}, line))  # it is refused when it is run

    def _simple(self, word: str, line: Line, read: Expressions) -> list[Statement]:
        """A statement of one line."""
        cursor = read.cursor
        if cursor.after(1).text == ":" and cursor.after(2).kind == NEWLINE:
            return [Label(line, word)] if self._in_routine else []
        if word in ("RETURN", "EXIT"):
            cursor.take()
            value = read.expression() if cursor.next.kind != NEWLINE else None
            return [Leave(line, word, RETURN if word == "RETURN" else BREAK, value)]
        if word == "GOTO":
            cursor.take()
            label = GRAMMAR.folded(cursor.expect_kind("name", "a label").text)
            _require_end(cursor)
            return [Leave(line, word, JUMP, Constant(label))]
        if word == "RESUME":
            return [Unreadable(line, word, True)]
        if word == "WAIT":
            return [self._wait(line, read)]
        if word in MOVES:
            return [Do(line, move_of(word, line, read))]
        target = read.expression()
        if cursor.accept("="):
            return self._assign(line, target, read)
        _require_end(cursor)
        call = target if isinstance(target, Call) else Call(word, (), {}, line)
        return [Do(line, call)]

    def _declared(self, read: Expressions) -> list[Statement]:
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
            own = self._in_routine and not is_global
            (self._own if own else self._types)[name.name] = kind
            if cursor.accept("="):
                value = self._of_type(name, read.expression())
                found.append(Assign(name.line, name, value, own, is_global))
            else:
                fault, key = f"{name.name} is given no value", "" if own else remedy_of(name.name)
                start: Any = {} if is_array else Unknown(fault, remedy=key)
                found.append(Assign(name.line, name, Constant(start), own, is_global))
            if not cursor.accept(","):
                break
        return found

    def _kind(self, name: Name) -> str:
        """The type of a variable, as far as it counts; empty of others."""
        return self._own.get(name.name) or self._types.get(name.name, "")

    def _of_type(self, target: Expression, value: Expression) -> Expression:
        """A value as a variable of its type takes it."""
        name = assigned(target)
        kind = "" if name is None else self._kind(name)
        if name is not None and kind == "SIGNAL":  # others may set the same output by its number
            return Constant(Unknown(f"only the controller knows the signal {name.name}"))
        act = {"INT": as_integer, "REAL": as_real}.get(kind)
        return value if act is None or name is None else Operation(act, (value,), name.line)

    def _assign(self, line: Line, target: Expression, read: Expressions) -> list[Statement]:
        """A value for a variable, or for an output, which moves nothing."""
        name = assigned(target)
        root = "" if name is None else name.name.partition("[")[0]
        value = read.expression()
        _require_end(read.cursor)
        if root in SIGNALS:
            return [Do(line, Call(root, (target, value), {}, line))]
        given = self._of_type(target, value)
        found: list[Statement] = [Assign(line, target, given)]
        if name is not None and self._kind(name) == "SIGNAL":  # of several bits: which is not read
            found.append(Do(line, Call("$OUT", (Name("$OUT", line), given), {}, line)))
        return found

    def _wait(self, line: Line, read: Expressions) -> Statement:
        read.cursor.take()
        if read.cursor.expect("SEC", "FOR").text.upper() == "SEC":
            return Do(line, Call(WAIT, (read.expression(),), {}, line))
        return While(line, "WAIT FOR", read.expression(), (), at_end=True)


def _declared(one: Statement) -> str:
    """The variable that a statement declares without a value: of a parameter, the caller gives it."""
    match one:
        case Assign(target=Name(name=name), value=Constant(), is_own=True):
            return name
    return ""


def _require_end(cursor: Cursor) -> None:
    if cursor.next.kind != NEWLINE:
        cursor.refuse("the end of the line")


def files_of(asked: ProgramRequest) -> Module:
    """The routines and declarations of a program and of the files beside it; those of its own file are public.

    Each module, a `.src` with its `.dat`, has points and procedures of its own.

    Raises:
        BadProgram: the program is none. BadSyntax: as of a `_Reader`.
    """
    groups, types = dict[str, list[list[list[Token]]]](), dict[str, str]()
    for file, data in (*asked.beside.items(), ("", asked.data)):
        stem = PurePosixPath(file or asked.shown).stem.upper()
        groups.setdefault(stem, []).append([*_rows(data, file)])
    module = PurePosixPath(asked.shown).stem.upper()
    own = groups.pop(module)
    files = [rows for name, group in groups.items() for rows in _named_rows(name, group, types)]
    files += _named_rows(module, own, types, {*FIRST})
    every = [_module_of(rows, types) for rows in files]
    if not every[-1].routines:
        raise BadProgram("no DEF is in it", valid="a program in KRL (.src)")
    routines = dict[str, Routine]()
    for one in every:
        _add(routines, one.routines)
    declared = tuple(one for module in every for one in module.declared)
    return Module(routines, tuple(every[-1].routines), declared)


def _add(routines: dict[str, Routine], more: dict[str, Routine]) -> None:
    for name, one in more.items():
        if name in routines:
            first = f"one of them: the other is at {routines[name].line}"
            raise DuplicateName(f"{name!r} is there twice", where=str(one.line), valid=first)
        routines[name] = one


def _named_rows(
    name: str, group: list[list[list[Token]]], types: dict[str, str], of_all: Collection[str] = ()
) -> list[list[list[Token]]]:
    """The words of a module's files; names that are its own have the module's behind them.

    Data without procedures (`$config.dat`) are for all.

    Args:
        types: as of `_module_of`. of_all: variables of the controller, which the program's own data may give too.
    """
    found, own = dict[str, str](), set[str]()
    plain = [_module_of(rows, found) for rows in group]
    if any(module.routines for module in plain):
        own = {one for module in plain for one in _own_names(module)}.difference(of_all)
    for one, kind in found.items():
        types[f"{one}{OF}{name}".upper() if one in own else one] = kind
    return [[named(row, own, name) for row in rows] for rows in group]


def _own_names(module: Module) -> set[str]:
    """The variables and procedures of a file that only its module knows."""
    statements = [one for one in module.declared if isinstance(one, Assign) and not one.is_of_all]
    names = [assigned(one.target) for one in statements]
    private = module.routines.keys() - {*module.public}
    variables = {one.name for one in names if one is not None and not one.name.startswith("$")}
    return variables | private


def _rows(data: bytes, file: str) -> Iterator[list[Token]]:
    """The words of each line that has any, and its end; heads (`&ACCESS`) are left out."""
    for number, row in enumerate(text_of(data, file).split("\n"), 1):
        words = [] if row.lstrip().startswith("&") else tokens_of(row, WORD)[:-1]
        line = Line(number, file)
        if words:
            yield [*(Token(one.kind, one.text, line) for one in words), Token(NEWLINE, "\n", line)]
