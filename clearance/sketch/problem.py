"""A sketch lowered to flat arrays, its constraint graph and its plan; made anew when the structure
changes.

Coincident points share their variables. A problem can also be made of some of the constraints only,
which is how conflicts are searched.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.kernels.sketch.equations import CIRCLE_CIRCLE
from clearance.kernels.sketch.graph.core import components
from clearance.kernels.sketch.graph.graph import (
    DIRECTION,
    IN_GRAPH,
    MERGED,
    OFFSET,
    SLIDE,
    X,
    edges,
    members,
    merge,
    vertices,
)
from clearance.kernels.sketch.graph.plan import ConstructionPlan, make_plan, peeled_plan
from clearance.kernels.sketch.solve.place import System
from clearance.kernels.sketch.solve.start import counts, row_parts
from clearance.sketch.contacts import Contacts, contacts_of
from clearance.sketch.effort import UNLIMITED, TimeLimit

RESIDUAL = 1e-12
"""[-] Largest residual of a solved sketch relative to its size: some hundred roundings of a
coordinate."""

SETTLED = 2e-13
"""[-] Equations that hold to this, relative to the size, are left alone: a solved sketch solves to
itself."""

DEPENDENT = 1e-9
"""[-] How far a dimension that others imply may be off, relative to the size, and still agree with
them: a long circuit loses digits by its condition."""

FREEDOMS = np.array([3, 2, 1, 1, 1])
"""Degrees of freedom by kind of vertex."""


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
    return Tables(
        np.array(lists.roles, np.int64),
        np.array(lists.codes, np.int64)[order],
        np.array(lists.variables, np.int64).reshape(-1, 8)[order],
        np.array(lists.coefficients, float).reshape(-1, 4)[order],
        np.array(lists.scales, float)[order],
        np.array(lists.offsets, float)[order],
        np.array(lists.grounds, np.int64)[order],
        np.array(lists.owners, np.int64)[order],
        np.array(lists.line_ends, np.int64).reshape(-1, 3),
        list(lists.together),
        np.array(lists.dimensions()),
    )


@dataclass(eq=False)
class Problem:
    """Everything about a sketch that a solve needs and that does not depend on where it starts.

    `alias` (n,) is the variable that stands for each; `weight` (n,) how many variables it stands
    for (0 for those stood for). `free` (parts,) are the freedoms left, `hold` how each part hangs
    on the ground. `limit` is when searches stop.
    """

    tables: Tables
    alias: np.ndarray
    weight: np.ndarray
    repeated: list[int]
    system: System
    fate: np.ndarray
    absolute: np.ndarray
    theta_of: np.ndarray
    plan: ConstructionPlan
    part: np.ndarray
    n_parts: int
    hold: np.ndarray
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
        return self.free == np.array([3, 2, 0])[self.hold]


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
        a, b = find(int(tables.var[row, 0])), find(int(tables.var[row, 1]))
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
        turning = tables.role[np.maximum(var[:, 0], 0)] == DIRECTION
        angular = (tables.code == 6) & turning
    else:
        alias, weight, repeated, var = like.alias, like.weight, like.repeated, like.system.var
        angular = like.length_scale != 1.0
    length_scale = np.where(angular, size * 1.0000001, 1.0)
    parent, scale, shift, fate = merge(
        tables.code, var, tables.coef, value, tables.role, length_scale, DEPENDENT * size
    )
    coef = inner_and_outer(tables, var, parent, shift)
    if (
        like is not None
        and np.array_equal(parent, like.system.parent)
        and np.array_equal(fate, like.fate)
    ):
        system = like.system._replace(coef=coef, value=value, scale=scale, shift=shift)
        out = Problem(**{**vars(like), "tables": tables, "system": system})
        out.size, out.length_scale = size, length_scale
        return out
    if tables.together:
        rows = np.flatnonzero((var[:, 0] == var[:, 1]) & (var[:, 0] >= 0) & (tables.code == 6))
        fate[rows] = MERGED
    same, merged = (
        _NumberAliases(alias, weight, repeated),
        _MergedNumbers(parent, scale, shift, fate),
    )
    out = _fresh(tables, same, merged, var, value, size, length_scale)
    out.system = out.system._replace(coef=coef)
    return out


def inner_and_outer(tables: Tables, var, parent: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """(m, 4) the coefficients; of two circles, one within the other, the given radii say which.

    The drawing says it where a radius is not known: how large a circle is drawn is often rough.
    """
    coef, n = tables.coef, tables.role.size
    inside = (tables.code == CIRCLE_CIRCLE) & (coef[:, 0] * coef[:, 1] < 0.0)
    first, second = var[:, 4], var[:, 5]
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


class _MergedNumbers(NamedTuple):
    """(n + 1,) each number is `scale` times that of `parent`, plus `shift`; (m,) what became of each row."""

    parent: np.ndarray
    scale: np.ndarray
    shift: np.ndarray
    fate: np.ndarray


def _fresh(tables, same: _NumberAliases, merged: _MergedNumbers, var, value, size, length_scale):
    """The problem with a plan of its own."""
    alias, weight, repeated = same
    parent, scale, shift, fate = merged
    vertex_of, kind, root = vertices(tables.role, parent, weight > 0)
    ends = edges(var, tables.ground, fate, vertex_of)
    start, member = members(vertex_of, tables.role, parent, kind.shape[0])
    theta_of = np.zeros(kind.shape[0], np.int64)
    slides = np.flatnonzero(kind == SLIDE)
    theta_of[slides] = vertex_of[root[slides] - 1]
    system = System(
        tables.code,
        var,
        tables.coef,
        value,
        kind,
        root,
        parent,
        scale,
        shift,
        start,
        member,
        vertex_of,
        ends,
    )
    placed = (tables.role == OFFSET) & (vertex_of == 0)
    ground = np.where((placed[var] & (var >= 0)).any(axis=1) & (fate == 0), 1, tables.ground)
    first_is_ground = (ground == 1) & (tables.ground == 0)
    ends[first_is_ground] = np.array([_ground_first(e) for e in ends[first_is_ground]]).reshape(
        -1, 5
    )
    plan, whole = peeled_plan(kind, ends, ground, theta_of)
    if not whole:
        plan = make_plan(kind, ends, ground, theta_of)
    part, n_parts, hold = components(kind, ends, theta_of, ground)
    free = counts(kind, ends, part, n_parts, plan.dependent, FREEDOMS)
    row_part = row_parts(ends, var, part, vertex_of)
    plain = (tables.scale == 0.0) & (tables.offset == 0.0)
    return Problem(
        tables, alias, weight, repeated, system, fate, ground, theta_of, plan, part, n_parts, hold,
        free, row_part, length_scale, size,
        contacts_of(tables.code, var, plain, ~np.isin(row_part, row_part[plan.dependent])),
    )  # fmt: skip


def _ground_first(ends: np.ndarray) -> list[int]:
    """The vertices of an edge with the ground in front, as rows that name a place have it."""
    rest = [int(v) for v in ends if v > 0]
    return ([0, *rest] + [-1] * 5)[:5]


def size_of(tables: Tables, x: np.ndarray, value: np.ndarray) -> float:
    """[m] the largest coordinate, radius or dimension in lengths; 1 for an empty sketch."""
    lengths = x[(tables.role != DIRECTION)]
    size = float(np.abs(lengths).max()) if lengths.size else 0.0
    plain = value[(tables.code <= 5)]
    if plain.size:
        size = max(size, float(np.abs(plain).max()))
    return size or 1.0


def is_point(role: np.ndarray) -> np.ndarray:
    """(n,) marks the first variable of every point."""
    return role == X


__all__ = [
    "IN_GRAPH",
    "Problem",
    "Tables",
    "is_point",
    "joined",
    "problem_of",
    "size_of",
    "tables_of",
]
