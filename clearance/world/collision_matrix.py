"""Which pairs of one robot's links are excused from self-clearance, and why: the allowed collision matrix."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

ADJACENT, DEFAULT, NEVER = "Adjacent", "Default", "Never"
"""Reasons of an SRDF: a joint joins them, they touch at home, they were not seen to meet."""

PARENT = "MuJoCo's filter of parent and child"
"""The reason of a parent and a child that more than one joint joins: MuJoCo excuses them too, named by nobody."""

BY_DEFAULT = "off by default"
"""The reason of a pair that is excused since one of its links is, with all others."""


@dataclass(frozen=True)
class CollisionMatrix:
    """Which pairs of links an SRDF, or the robot's own file, excuses.

    The order of precedence is MoveIt's: a link that is off by default is excused with every other link; pairs
    that are enabled are not; pairs that are disabled are, whatever was said before.
    Source: MoveIt 2, `moveit_core/collision_detection/src/collision_matrix.cpp`.

    Attributes:
        off_by_default: links.
        enabled: pairs of links.
        disabled: pairs of links with a reason each; of several rows for a pair the last counts.
        notes: omissions, one line each.
        other: the robot that the file names, if it is not the one whose links it is read for.
    """

    off_by_default: tuple[str, ...] = ()
    enabled: tuple[tuple[str, str], ...] = ()
    disabled: tuple[tuple[str, str, str], ...] = ()
    notes: tuple[str, ...] = ()
    other: str = ""

    def reason(self, link_a: str, link_b: str) -> str | None:
        """Why a pair is excused, in either order; None if it is not."""
        pair = frozenset((link_a, link_b))
        if pair in self._disabled:
            return self._disabled[pair]
        if pair in self._enabled or self._off.isdisjoint(pair):
            return None
        return BY_DEFAULT

    @cached_property
    def _disabled(self) -> dict[frozenset[str], str]:
        return {frozenset((a, b)): reason for a, b, reason in self.disabled}

    @cached_property
    def _enabled(self) -> frozenset[frozenset[str]]:
        return frozenset(frozenset(pair) for pair in self.enabled)

    @cached_property
    def _off(self) -> frozenset[str]:
        return frozenset(self.off_by_default)
