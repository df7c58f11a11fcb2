"""`dataclass` as the standard library has it, whose methods are written when they are first asked for.

That of the library writes and compiles up to seven functions for each class while its module is imported: those of
130 classes took a tenth of a short run, which calls a quarter of them. Here a class gets its fields at once, and
each method at its first use. `fields`, `replace`, `asdict` and pattern matching are those of the library. Not for:
`slots`, keyword-only fields and `InitVar`, which nothing of this package has.
"""

from __future__ import annotations

import builtins
import dataclasses
from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError
from reprlib import recursive_repr
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(
        cls: type | None = None, /, *, init: bool = True, eq: bool = True, frozen: bool = False
    ) -> Any:
        """A class with its fields, or what makes it of one."""

        def decorated(cls: type) -> type:
            return _with_late_methods(cls, init, eq, frozen)

        return decorated if cls is None else decorated(cls)


class _LateMethod:
    """Stands in a class for a method, until that is asked for."""

    __slots__ = ("cls", "frozen", "name")

    def __init__(self, cls: type, name: str, frozen: bool) -> None:
        self.cls, self.name, self.frozen = cls, name, frozen

    def __get__(self, instance: object, owner: type | None = None) -> Any:
        method = _WRITERS[self.name](self.cls, self.frozen)
        method.__name__, method.__module__ = self.name, self.cls.__module__
        method.__qualname__ = f"{self.cls.__qualname__}.{self.name}"
        setattr(self.cls, self.name, method)
        return method.__get__(instance, owner)


def _with_late_methods(cls: type, init: bool, eq: bool, frozen: bool) -> type:
    own = vars(cls)
    gives_hash = own.get("__hash__") is not None  # None stands there beside an `__eq__` as well
    names = [*(["__init__"] if init else []), "__repr__", *(["__eq__"] if eq else [])]
    names = [name for name in names if name == "__init__" or name not in own]
    inherits = any(map(dataclasses.is_dataclass, cls.__mro__[1:]))
    made: Any = dataclasses.dataclass(init=False, repr=False, eq=False, frozen=frozen and inherits)(
        cls
    )
    made.__dataclass_params__.frozen = (
        frozen  # so that the library lets frozen classes inherit from it
    )
    for name in names:
        setattr(made, name, _LateMethod(made, name, frozen))
    if eq and not gives_hash:
        made.__hash__ = _LateMethod(made, "__hash__", frozen) if frozen else None
    if frozen:
        made.__setattr__, made.__delattr__ = _refuse_to_set, _refuse_to_delete
    return made


def _refuse_to_set(self: object, name: str, value: object) -> None:
    if _is_frozen(self, name):
        raise FrozenInstanceError(f"cannot assign to field {name!r}")
    object.__setattr__(self, name, value)


def _refuse_to_delete(self: object, name: str) -> None:
    if _is_frozen(self, name):
        raise FrozenInstanceError(f"cannot delete field {name!r}")
    object.__delattr__(self, name)


def _is_frozen(instance: object, name: str) -> bool:
    """True for every attribute of a data class, and for the fields of one that a plain class adds others to."""
    kind: type = type(instance)
    return "__dataclass_fields__" in vars(kind) or any(
        field.name == name for field in dataclasses.fields(kind)
    )


def _init_of(cls: type, frozen: bool) -> Callable:
    values: dict[str, Any] = {"set_field": object.__setattr__, "not_given": MISSING}
    parameters, defaults, lines = [], [], []
    for field in dataclasses.fields(cls):
        name, is_made = field.name, field.default_factory is not MISSING
        if is_made:
            values[f"make_{name}"] = field.default_factory
        if field.init and (is_made or field.default is not MISSING):
            parameters.append(f"{name}=None")
            defaults.append(MISSING if is_made else field.default)
        elif field.init:
            parameters.append(name)
        value = _value_of(name, field.init, is_made)
        if value is not None:
            lines.append(
                f"set_field(self, {name!r}, {value})" if frozen else f"self.{name} = {value}"
            )
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    made = _written(f"__init__(self, {', '.join(parameters)})", lines or ["pass"], values)
    made.__defaults__ = tuple(defaults)
    given = [field for field in dataclasses.fields(cls) if field.init]
    made.__annotations__ = {**{field.name: field.type for field in given}, "return": None}
    return made


def _value_of(name: str, is_given: bool, is_made: bool) -> str | None:
    """What a field is set to; None for one that only `__post_init__` sets, or that the class holds."""
    if not is_made:
        return name if is_given else None
    return f"make_{name}() if {name} is not_given else {name}" if is_given else f"make_{name}()"


def _repr_of(cls: type, frozen: bool) -> Callable:
    names = [field.name for field in dataclasses.fields(cls) if field.repr]
    told = ", ".join(f"{name}={{self.{name}!r}}" for name in names)
    line = f"return f'{{self.__class__.__qualname__}}({told})'"
    return recursive_repr()(_written("__repr__(self)", [line], {}))


def _eq_of(cls: type, frozen: bool) -> Callable:
    names = [field.name for field in dataclasses.fields(cls) if field.compare]
    lines = [
        "if other.__class__ is not self.__class__:",
        "    return NotImplemented",
        f"return {_tuple_of('self', names)} == {_tuple_of('other', names)}",
    ]
    return _written("__eq__(self, other)", lines, {})


def _hash_of(cls: type, frozen: bool) -> Callable:
    fields = dataclasses.fields(cls)
    names = [f.name for f in fields if (f.compare if f.hash is None else f.hash)]
    return _written("__hash__(self)", [f"return hash({_tuple_of('self', names)})"], {})


def _tuple_of(owner: str, names: list[str]) -> str:
    return f"({''.join(f'{owner}.{name}, ' for name in names)})"


def _written(head: str, lines: list[str], values: dict[str, Any]) -> FunctionType:
    """The function of a head and the lines of its body, which sees `values`."""
    source = f"def {head}:\n" + "".join(f"    {line}\n" for line in lines)
    (code,) = (c for c in compile(source, _PLACE, "exec").co_consts if isinstance(c, CodeType))
    return FunctionType(code, {"__builtins__": builtins.__dict__, "__name__": __name__, **values})


_PLACE = "<late_dataclass>"
"""Where tracebacks say that a method was written."""

_WRITERS: dict[str, Callable[[type, bool], Callable]] = {
    "__init__": _init_of,
    "__repr__": _repr_of,
    "__eq__": _eq_of,
    "__hash__": _hash_of,
}
