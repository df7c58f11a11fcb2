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
from clearance.sketch.equations import CODES, OF_LENGTH, CircleCircle, Linear, are, places
from clearance.sketch.graph.graph import (
    DIRECTION,
    FREEDOMS,
    MERGED,
    OFFSET,
    SLIDE,
    Merged,
    components,
    edges,
    graph_of,
    members,
    merge,
    vertices,
)
from clearance.sketch.graph.plan import make_plan
from clearance.sketch.graph.steps import ConstructionPlan
from clearance.sketch.solve.system import System

RESIDUAL = 1e-12
"""[-] Largest residual of a solved sketch relative to its size: some hundred roundings of a
coordinate."""

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
    together: list[tuple[int, int]]
    numbers: np.ndarray
    """(constraints,) current dimension of every constraint; 0 for those without."""

    @property
    def value(self) -> np.ndarray:
        """(m,) the value of every row."""
        return self.offset + self.scale * self.numbers[self.owner]

    def only(self, chosen: np.ndarray) -> Tables:
        """The tables of the constraints (by index) that `chosen` marks."""
        rows = chosen[self.owner] if self.owner.size else np.zeros(0, bool)
        together = [pair for pair in self.together if chosen[pair[0]]]
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
        np.array(lists.dimensions()),
    )


@dataclass(eq=False)
class Problem:
    """Everything about a sketch that a solve needs and that does not depend on where it starts.

    `alias` (n,) is the variable that stands for each; `weight` (n,) how many variables it stands
    for (0 for those stood for). `free` (parts,) are the remaining freedoms, `fixing` how each part hangs
    on the ground. `limit` is when searches stop.
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

    @property
    def regular(self) -> System:
        """The system as it is regular at a solution, where points of contact are double roots otherwise."""
        return self.system if self.contacts is None else self.contacts.regular(self.system)

    @property
    def is_rigid(self) -> np.ndarray:
        """(parts,) whether nothing is free in a part beyond placing it as a whole."""
        return self.free == np.array([3, 2, 0])[self.fixing]


def entities_of(sketch, problem: Problem) -> dict[str, Entity]:
    """The entities by name that a sketch had when the problem was made of it."""
    n = problem.tables.role.size
    return {name: e for name, e in sketch.entities.items() if e.variable < n}


def joined(tables: Tables) -> tuple[np.ndarray, np.ndarray, list[int]]:
    """(alias, weight, rows of coincidences that others imply)."""
    n = tables.role.shape[0]
    alias = np.arange(n)
    if not tables.together:
        return alias, np.ones(n), []
    row_at = {int(o): k for k, o in reversed(list(enumerate(tables.owner)))}
    repeated = []
    group: dict[int, int] = {}

    def find(i: int) -> int:
        while group.setdefault(i, i) != i:
            i = group[i]
        return i

    for index, _ in tables.together:
        row = row_at[index]
        same = places(Linear, tables.var[row])
        a, b = find(int(same.a)), find(int(same.b))
        if a == b:
            repeated.append(row)
        group[max(a, b)] = min(a, b)
    for i in group:
        alias[i], alias[i + 1] = find(i), find(i) + 1
    return alias, np.bincount(alias, minlength=n).astype(float), repeated


def problem_of(tables: Tables, x: np.ndarray, like: Problem | None = None) -> Problem:
    """The problem of these tables; x only sets the size. `like`, with the same structure, saves the
    plan."""
    value = tables.value
    size = size_of(tables, x, value)
    if like is None:
        alias, weight, repeated = joined(tables)
        var = np.where(tables.var >= 0, alias[tables.var], -1)
        turning = tables.role[np.maximum(places(Linear, var).a, 0)] == DIRECTION
        angular = are(tables.code, Linear) & turning
    else:
        alias, weight, repeated, var = like.alias, like.weight, like.repeated, like.system.var
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
    same = _NumberAliases(alias, weight, repeated)
    return _fresh(tables, same, merged, var, coef, value, size, length_scale)


def inner_and_outer(tables: Tables, var, parent: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """(m, 4) the coefficients; of two circles, one within the other, the given radii say which.

    The drawing says it where a radius is not known: how large a circle is drawn is often rough.
    """
    coef, n = tables.coef, tables.role.size
    inside = are(tables.code, CircleCircle) & (coef[:, 0] * coef[:, 1] < 0.0)
    circles = places(CircleCircle, var)
    first, second = circles.r, circles.s
    inside &= (parent[first] == n) & (parent[second] == n) & (shift[first] != shift[second])
    if not inside.any():
        return coef
    larger = np.where(shift[first] > shift[second], 1.0, -1.0)[inside]
    coef = coef.copy()
    coef[inside, 0], coef[inside, 1] = larger, -larger
    return coef


class _NumberAliases(NamedTuple):
    """(n,) which number stands for each, and for how many each stands; rows that say so once more."""

    alias: np.ndarray
    weight: np.ndarray
    repeated: list[int]


def _fresh(tables, same: _NumberAliases, merged: Merged, var, coef, value, size, length_scale):
    """The problem with a plan of its own."""
    vertex_of, kind, root = vertices(tables.role, merged.parent, same.weight > 0)
    ends = edges(var, tables.ground, merged.fate, vertex_of)
    start, member = members(vertex_of, tables.role, kind.size)
    theta_of = np.zeros(kind.size, np.int64)
    slides = np.flatnonzero(kind == SLIDE)
    theta_of[slides] = vertex_of[root[slides] - 1]
    ground = _grounded(tables, var, merged.fate, vertex_of, ends)
    system = System(
        tables.code, var, coef, value, kind, root, merged.parent, merged.scale, merged.shift,
        start, member, vertex_of, ends,
    )  # fmt: skip
    plan = make_plan(graph_of(kind, ends, ground, theta_of))
    part, n_parts, fixing = components(kind, ends, theta_of, ground)
    row_part = _row_parts(var, part, vertex_of)
    free = _remaining_freedoms(kind, ends, part, n_parts, plan.dependent)
    plain = (tables.scale == 0.0) & (tables.offset == 0.0)
    return Problem(
        tables, *same, system, merged.fate, ground, plan, part, n_parts, fixing,
        free, row_part, length_scale, size,
        contacts_of(tables.code, var, plain, ~np.isin(row_part, row_part[plan.dependent])),
    )  # fmt: skip


def _grounded(tables: Tables, var, fate, vertex_of, ends) -> np.ndarray:
    """(m,) how every row refers to the ground: those of known offsets by position; `ends` then begin with it."""
    placed = (tables.role == OFFSET) & (vertex_of == 0)
    if not placed.any():
        return tables.ground
    ground = np.where((placed[var] & (var >= 0)).any(axis=1) & (fate == 0), 1, tables.ground)
    first_is_ground = (ground == 1) & (tables.ground == 0)
    ends[first_is_ground] = np.array([_ground_first(e) for e in ends[first_is_ground]]).reshape(
        -1, 5
    )
    return ground


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


def _ground_first(ends: np.ndarray) -> list[int]:
    """The vertices of an edge with the ground in front, as rows that name a place have it."""
    rest = [int(v) for v in ends if v > 0]
    return ([0, *rest] + [-1] * 5)[:5]


def size_of(tables: Tables, x: np.ndarray, value: np.ndarray) -> float:
    """[m] the largest coordinate, radius or dimension in lengths; 1 for an empty sketch."""
    lengths = x[(tables.role != DIRECTION)]
    size = float(np.abs(lengths).max()) if lengths.size else 0.0
    plain = value[are(tables.code, *OF_LENGTH)]
    if plain.size:
        size = max(size, float(np.abs(plain).max()))
    return size or 1.0
