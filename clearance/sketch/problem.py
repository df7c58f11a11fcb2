"""A sketch lowered to flat arrays, its constraint graph and its plan; made anew when the structure
changes.

Coincident points share their variables. A problem can also be made of some of the constraints only,
which is how conflicts are searched.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from clearance.sketch.contacts import Contacts, contacts_of
from clearance.sketch.effort import UNLIMITED, TimeLimit
from clearance.sketch.entities import Entity
from clearance.sketch.equations import CODES, OF_LENGTH, FromCircle, Linear, are, places
from clearance.sketch.graph.graph import (
    DIRECTION,
    FREEDOMS,
    IN_GRAPH,
    MERGED,
    OFFSET,
    SLIDE,
    ConstructionPlan,
    Merged,
    components,
    edges,
    graph_of,
    members,
    merge,
    vertices,
)
from clearance.sketch.graph.plan import make_plan
from clearance.sketch.solve.newton import StoppingRule
from clearance.sketch.solve.system import System

RESIDUAL = 1e-12
"""[-] Largest residual of a solved sketch relative to its size: some hundred roundings of a
coordinate."""

FLOOR = 2e-16
"""[-] What a numeric cluster aims at, relative to the size: about one rounding of a coordinate."""

SETTLED = 2e-13
"""[-] Equations that hold to this, relative to the size, stay untouched: a solved sketch solves to
itself."""

DEPENDENT = 1e-9
"""[-] How far a dimension that others imply may be off, relative to the size, and still agree with
them: a long circuit loses digits by its condition."""


@dataclass(eq=False)
class Tables:
    """The flat lists of a sketch as arrays: what does not change when a dimension does."""

    role: np.ndarray
    code: np.ndarray
    var: np.ndarray
    coef: np.ndarray
    scale: np.ndarray
    offset: np.ndarray
    ground: np.ndarray
    owner: np.ndarray
    line_ends: np.ndarray
    together: list[int]
    numbers: np.ndarray
    """(constraints,) current dimension of every constraint; 0 for those without."""

    @property
    def value(self) -> np.ndarray:
        """(m,) the value of every row."""
        return self.offset + self.scale * self.numbers[self.owner]

    def first_rows(self, constraints: list[int]) -> list[int]:
        """The first row of each of some constraints (by index)."""
        at = dict(zip(reversed(self.owner.tolist()), reversed(range(self.owner.size)), strict=True))
        return [at[k] for k in constraints]

    def only(self, chosen: np.ndarray) -> Tables:
        """The tables of the constraints (by index) that `chosen` marks."""
        rows = chosen[self.owner] if self.owner.size else np.zeros(0, bool)
        together = [k for k in self.together if chosen[k]]
        return Tables(
            self.role, self.code[rows], self.var[rows], self.coef[rows], self.scale[rows],
            self.offset[rows], self.ground[rows], self.owner[rows], self.line_ends, together,
            self.numbers,
        )  # fmt: skip


def tables_of(sketch) -> Tables:
    """The tables of a sketch.

    The rows are in the order of their ranks: where some follow from others, it is the last that do.
    """
    lists = sketch._lists
    order = np.argsort(np.array(lists.ranks, np.int64), kind="stable")
    rows = [lists.rows[i] for i in order]
    var = [row.equation + (-1,) * (8 - len(row.equation)) for row in rows]
    return Tables(
        np.array(lists.roles, np.int64),
        np.array([CODES[type(row.equation)] for row in rows], np.int64),
        np.array(var, np.int64).reshape(-1, 8),
        np.array([row.coef + (0.0,) * (4 - len(row.coef)) for row in rows]).reshape(-1, 4),
        np.array([row.scale for row in rows], float),
        np.array([row.offset for row in rows], float),
        np.array([row.ground for row in rows], np.int64),
        np.array(lists.owners, np.int64)[order],
        np.array(lists.line_ends, np.int64).reshape(-1, 3),
        list(lists.together),
        lists.dimensions(),
    )


@dataclass(eq=False)
class Problem:
    """Everything about a sketch that a solve needs and that does not depend on where it starts.

    `alias` (n,) is the variable that stands for each; `weight` (n,) how many variables it stands
    for (0 for those stood for). `free` (parts,) are the remaining freedoms, `fixing` how each part hangs
    on the ground. `limit` is when searches stop. Changes of radii count `weight_of_radii` as movement.
    """

    tables: Tables
    alias: np.ndarray
    weight: np.ndarray
    repeated: list[int]
    system: System
    fate: np.ndarray
    absolute: np.ndarray
    plan: ConstructionPlan
    part: np.ndarray
    n_parts: int
    fixing: np.ndarray
    free: np.ndarray
    row_part: np.ndarray
    length_scale: np.ndarray
    size: float
    contacts: Contacts | None = None
    limit: TimeLimit = UNLIMITED
    weight_of_radii: float = 1.0

    @property
    def regular(self) -> System:
        """The system as it is regular at a solution, where points of contact are double roots otherwise."""
        return self.system if self.contacts is None else self.contacts.regular(self.system)

    def vertices_of(self, part: int) -> np.ndarray:
        """The vertices of a part."""
        return np.flatnonzero(self.part == part)

    def numbers_of(self, part: int) -> np.ndarray:
        """(n,) marks the numbers of a part."""
        vertex_of = self.system.vertex_of
        return (vertex_of > 0) & (self.part[vertex_of] == part)

    def independent_rows(self, part: int) -> np.ndarray:
        """The equations of a part that are edges of the graph and that no others imply by the count."""
        chosen = (self.row_part == part) & (self.fate == IN_GRAPH)
        chosen[self.plan.dependent] = False
        return np.flatnonzero(chosen)

    def errors(self, x: np.ndarray) -> np.ndarray:
        """(m,) [m] how far every equation is off at x (n,); infinite where that is no number."""
        error = np.abs(self.system.all_rows.errors(x)) * self.length_scale
        return np.where(error <= 1.7e308, error, np.inf)

    def residual(self, x: np.ndarray) -> tuple[float, int]:
        """The largest residual [m] of all equations, and its row; (0, -1) where all are 0."""
        error = self.errors(x)
        largest = float(error.max(initial=0.0))
        return largest, int(np.argmax(error)) if largest > 0.0 else -1

    def rule(self, attempts: int) -> StoppingRule:
        """When the search for a cluster's place ends, at the problem's size."""
        size = self.size
        return StoppingRule(FLOOR * size, RESIDUAL * size, attempts, self.limit, SETTLED * size)

    @property
    def is_rigid(self) -> np.ndarray:
        """(parts,) whether nothing is free in a part beyond placing it as a whole."""
        return self.free == np.array([3, 2, 0])[self.fixing]


def entities_of(sketch, problem: Problem) -> dict[str, Entity]:
    """The entities by name that a sketch had when the problem was made of it."""
    n = problem.tables.role.size
    return {name: e for name, e in sketch.entities.items() if e.variable < n}


class NumberAliases(NamedTuple):
    """(n,) which number stands for each, and for how many each stands; rows that say so once more."""

    alias: np.ndarray
    weight: np.ndarray
    repeated: list[int]


def joined(tables: Tables) -> NumberAliases:
    """The numbers that stand for those of coincident points."""
    n = tables.role.shape[0]
    alias = np.arange(n)
    if not tables.together:
        return NumberAliases(alias, np.ones(n), [])
    repeated = []
    group: dict[int, int] = {}

    def find(i: int) -> int:
        while group.setdefault(i, i) != i:
            i = group[i]
        return i

    for row in tables.first_rows(tables.together):
        same = places(Linear, tables.var[row])
        a, b = find(int(same.a)), find(int(same.b))
        if a == b:
            repeated.append(row)
        group[max(a, b)] = min(a, b)
    for i in group:
        alias[i], alias[i + 1] = find(i), find(i) + 1
    return NumberAliases(alias, np.bincount(alias, minlength=n).astype(float), repeated)


def problem_of(tables: Tables, x: np.ndarray, like: Problem | None = None) -> Problem:
    """The problem of these tables; x only sets the size. `like`, with the same structure, saves the
    plan."""
    value = tables.value
    size = size_of(tables, x, value)
    if like is None:
        same = joined(tables)
        var = np.where(tables.var >= 0, same.alias[tables.var], -1)
        turning = tables.role[np.maximum(places(Linear, var).a, 0)] == DIRECTION
        angular = are(tables.code, Linear) & turning
    else:
        same = NumberAliases(like.alias, like.weight, like.repeated)
        var = like.system.var
        angular = like.length_scale != 1.0
    length_scale = np.where(angular, size * 1.0000001, 1.0)
    merged = merge(
        tables.code, var, tables.coef, value, tables.role, length_scale, DEPENDENT * size
    )
    coef = inner_and_outer(tables, var, merged.parent, merged.shift)
    if (
        like is not None
        and np.array_equal(merged.parent, like.system.parent)
        and np.array_equal(merged.fate, like.fate)
    ):
        system = like.system.replaced(
            coef=coef, value=value, scale=merged.scale, shift=merged.shift
        )
        return replace(like, tables=tables, system=system, size=size, length_scale=length_scale)
    if tables.together:
        of = places(Linear, var)
        merged.fate[are(tables.code, Linear) & (of.a == of.b) & (of.a >= 0)] = MERGED
    return _fresh(tables, same, merged, var, coef, value, size, length_scale)


def inner_and_outer(tables: Tables, var, parent: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """(m, 4) the coefficients; of two circles, one within the other, the given radii say which.

    The drawing says it where a radius is not known: how large a circle is drawn is often rough.
    """
    coef, n = tables.coef, tables.role.size
    inside = are(tables.code, FromCircle) & (coef[:, 0] * coef[:, 1] < 0.0)
    circles = places(FromCircle, var)
    first, second = circles.r, circles.s
    inside &= (parent[first] == n) & (parent[second] == n) & (shift[first] != shift[second])
    if not inside.any():
        return coef
    larger = np.where(shift[first] > shift[second], 1.0, -1.0)[inside]
    coef = coef.copy()
    coef[inside, 0], coef[inside, 1] = larger, -larger
    return coef


def replanned(problem: Problem, last: frozenset[int]) -> Problem:
    """The problem with another plan: of the equations that follow from others, those of `last` are left out."""
    s = problem.system
    ways = _directions_of(s.kind, s.root, s.vertex_of)
    plan = make_plan(graph_of(s.kind, s.ends, problem.absolute, ways), last)
    free = _remaining_freedoms(s.kind, s.ends, problem.part, problem.n_parts, plan.dependent)
    contacts = _contacts(problem.tables, s, problem.row_part, plan.dependent)
    return replace(problem, plan=plan, free=free, contacts=contacts)


def _fresh(tables, same: NumberAliases, merged: Merged, var, coef, value, size, length_scale):
    """The problem with a plan of its own."""
    vertex_of, kind, root = vertices(tables.role, merged.parent, same.weight > 0)
    ground = _grounded(tables, var, merged.fate, vertex_of)
    ends = edges(var, ground, merged.fate, vertex_of)
    start, member = members(vertex_of, tables.role, kind.size)
    theta_of = _directions_of(kind, root, vertex_of)
    system = System(
        tables.code, var, coef, value, kind, root, merged.parent, merged.scale, merged.shift,
        start, member, vertex_of, ends,
    )  # fmt: skip
    plan = make_plan(graph_of(kind, ends, ground, theta_of))
    part, n_parts, fixing = components(kind, ends, theta_of, ground)
    row_part = _row_parts(var, part, vertex_of)
    free = _remaining_freedoms(kind, ends, part, n_parts, plan.dependent)
    return Problem(
        tables, *same, system, merged.fate, ground, plan, part, n_parts, fixing,
        free, row_part, length_scale, size, _contacts(tables, system, row_part, plan.dependent),
    )  # fmt: skip


def _directions_of(kind, root, vertex_of) -> np.ndarray:
    """(v,) the class of directions of every class of offsets; 0 for other vertices."""
    out = np.zeros(kind.size, np.int64)
    slides = np.flatnonzero(kind == SLIDE)
    out[slides] = vertex_of[root[slides] - 1]
    return out


def _contacts(tables: Tables, system: System, row_part, dependent) -> Contacts | None:
    """The points of contact in the parts in which no equation follows from others."""
    plain = (tables.scale == 0.0) & (tables.offset == 0.0)
    return contacts_of(system, plain, ~np.isin(row_part, row_part[dependent]))


def _grounded(tables: Tables, var, fate, vertex_of) -> np.ndarray:
    """(m,) how every row refers to the ground: those of known offsets by position."""
    placed = (tables.role == OFFSET) & (vertex_of == 0)
    if not placed.any():
        return tables.ground
    return np.where((placed[var] & (var >= 0)).any(axis=1) & (fate == 0), 1, tables.ground)


def _row_parts(var, part, vertex_of) -> np.ndarray:
    """The connected part of every equation; -1 for those of known numbers only."""
    if not var.shape[0]:
        return np.zeros(0, np.int64)
    named = np.where(var >= 0, vertex_of[var], 0)
    first = np.argmax(named > 0, axis=1)
    named = named[np.arange(var.shape[0]), first]
    return np.where(named > 0, part[np.maximum(named, 0)], -1)


def _remaining_freedoms(kind, ends, part, n_parts: int, dependent) -> np.ndarray:
    """Remaining degrees of freedom of every part: those of its vertices less its independent equations."""
    out = np.bincount(part[1:], np.array(FREEDOMS)[kind[1:]], n_parts)
    chosen = (ends > 0).any(axis=1)
    chosen[dependent] = False
    first = ends[chosen, np.argmax(ends[chosen] > 0, axis=1)]
    return (out - np.bincount(part[first], minlength=n_parts)).astype(np.int64)


def size_of(tables: Tables, x: np.ndarray, value: np.ndarray) -> float:
    """[m] the largest coordinate, radius or dimension in lengths; 1 for an empty sketch."""
    lengths = x[(tables.role != DIRECTION)]
    size = float(np.abs(lengths).max()) if lengths.size else 0.0
    plain = value[are(tables.code, *OF_LENGTH)]
    if plain.size:
        size = max(size, float(np.abs(plain).max()))
    return size or 1.0
