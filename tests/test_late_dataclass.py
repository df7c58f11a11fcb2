"""A data class whose methods come late is what the standard library makes of the same lines."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError, field

import pytest

from clearance.late_dataclass import dataclass as late_dataclass


def classes(decorate):
    """Classes of all kinds that the package has, by one of the two decorators."""

    @decorate(frozen=True)
    class Frozen:
        """With a default, one that is made, one that is not told, and one that is not compared."""

        a: int
        b: str = "b"
        c: list = field(default_factory=list)
        d: float = field(default=0.5, repr=False)
        e: float = field(default=0.25, compare=False)

        def __post_init__(self) -> None:
            if self.a < 0:
                raise ValueError("negative")

    @decorate(frozen=True, eq=False)
    class Same:
        """Equal only to itself."""

        a: int
        b: Frozen | None = None

    @decorate
    class Open:
        """Whose fields may change, one of them set afterwards."""

        a: int
        made: list = field(default_factory=list)
        later: int = field(init=False)

        def __post_init__(self) -> None:
            self.later = 2 * self.a

    @decorate(frozen=True)
    class Child(Frozen):
        """With the fields of another before its own."""

        f: int = 3

    @decorate(frozen=True)
    class Own:
        """With methods of its own."""

        a: int

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return True

        def __hash__(self) -> int:
            return 7

    @decorate(frozen=True)
    class OwnEqual:
        """With one of two that go together."""

        a: int

        def __eq__(self, other: object) -> bool:
            return True

    @decorate(frozen=True, eq=False, init=False)
    class OwnInit:
        """Made in a way of its own."""

        a: int

        def __init__(self, twice: int) -> None:
            object.__setattr__(self, "a", twice // 2)

    @decorate(frozen=True)
    class Empty:
        """Without a field."""

    return (Frozen, Same, Open, Child, Own, OwnEqual, OwnInit, Empty)


ARGUMENTS = (
    (1,),
    (1, "x"),
    (1, "x", [2]),
    (1, "x", [2], 1.5, 2.5),
    (-1,),
    (),
    (1, 2, 3, 4, 5, 6, 7),
)
LATE, LIBRARY = classes(late_dataclass), classes(dataclasses.dataclass)
PAIRS = [pytest.param(*pair, id=pair[0].__name__) for pair in zip(LATE, LIBRARY, strict=True)]


def outcome(ask):
    """What a question gives, or the name of the fault that it ends with."""
    try:
        return ask()
    except Exception as fault:
        return type(fault)


def told(value):
    return (
        value
        if isinstance(value, type)
        else (repr(value), {k: repr(v) for k, v in vars(value).items()})
    )


@pytest.mark.parametrize("late, library", PAIRS)
@pytest.mark.parametrize("given", ARGUMENTS)
def test_it_is_made_and_told_alike(late, library, given):
    made, expected = outcome(lambda: late(*given)), outcome(lambda: library(*given))
    assert told(made) == told(expected)


@pytest.mark.parametrize("late, library", PAIRS)
def test_it_is_compared_and_hashed_alike(late, library):
    def asked(kind):
        given = [
            kind(*g) for g in ARGUMENTS[:4] if not isinstance(outcome(lambda g=g: kind(*g)), type)
        ]
        given += [] if given else [kind()]
        equal = [[a == b for b in given] for a in given]
        hashes = [outcome(lambda a=a: hash(a) == hash(copy.copy(a))) for a in given]
        return equal, hashes, [a == 1 for a in given]

    assert asked(late) == asked(library)


def test_equality_leaves_out_what_is_not_compared_and_other_classes():
    frozen, _, _, child, *_ = LATE
    assert frozen(1, "b", [], 0.5, 1.0) == frozen(1)
    assert frozen(1, "b", [], 1.0) != frozen(1)
    assert child(1) != frozen(1)


@pytest.mark.parametrize("late, library", PAIRS)
def test_what_is_frozen_stays_so(late, library):
    def asked(kind):
        made = kind() if kind.__name__ == "Empty" else kind(1)
        return [
            outcome(lambda: setattr(made, "a", 2)),
            outcome(lambda: setattr(made, "other", 2)),
            outcome(lambda: delattr(made, "a")),
        ]

    assert asked(late) == asked(library)


def test_a_plain_class_may_add_to_a_frozen_one():
    class More(LATE[0]):
        def __init__(self) -> None:
            super().__init__(1)
            self.more = 2

    made = More()
    with pytest.raises(FrozenInstanceError):
        made.a = 3
    assert (made.a, made.more) == (1, 2)


@pytest.mark.parametrize("late, library", PAIRS)
def test_its_signature_and_fields_are_the_same_before_any_is_made(late, library):
    late, library = (
        next(c for c in classes(of) if c.__name__ == late.__name__)
        for of in (late_dataclass, dataclasses.dataclass)
    )
    own = [list(inspect.signature(kind).parameters) for kind in (late, library)]
    assert own[0] == own[1]
    assert [f.name for f in dataclasses.fields(late)] == [
        f.name for f in dataclasses.fields(library)
    ]
    assert late.__match_args__ == library.__match_args__


def test_the_librarys_frozen_classes_may_inherit_from_it_and_others_not():
    kind = dataclasses.make_dataclass("Kind", [("g", int, 3)], bases=(LATE[0],), frozen=True)
    assert (kind(1).g, kind(1).b) == (3, "b")
    for decorate in (dataclasses.dataclass, late_dataclass):
        with pytest.raises(TypeError, match="non-frozen"):
            decorate(type("Kind", (LATE[0],), {}))


def test_copies_and_replacements_are_made():
    frozen, *_ = LATE
    made = dataclasses.replace(frozen(1), b="c")
    assert made == frozen(1, "c") and copy.deepcopy(made) == made
    assert dataclasses.asdict(made) == {"a": 1, "b": "c", "c": [], "d": 0.5, "e": 0.25}


def test_a_library_that_a_method_calls_may_import():
    """As numpy does for the first array that it tells of, by the builtins of the method that has called it."""
    for method in (LATE[0].__init__, LATE[0].__eq__, LATE[0].__hash__):
        assert method.__globals__["__builtins__"]["__import__"] is __import__


@late_dataclass(frozen=True)
class Travelling:
    """One that another process may meet before it has made any."""

    a: int


def test_one_that_comes_from_another_process_is_whole():
    content = pickle.dumps(Travelling(1))
    assert pickle.loads(content) == Travelling(1)
    with pytest.raises(FrozenInstanceError):
        pickle.loads(content).a = 2
