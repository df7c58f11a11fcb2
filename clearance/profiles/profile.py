"""A profile: closed outlines of lines and arcs in a plane, and for a sweep what it was made from and how sure."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.planar.curve import Curve
from clearance.profiles.contour import Contour, joined

if TYPE_CHECKING:
    from clearance.profiles.region import Region


@dataclass(frozen=True, eq=False)
class Origin:
    """The part of a motion that made each piece of a profile.

    Attributes:
        links: names; `link` counts in them.
        link, step: (n,) for all pieces of all contours in order: the link, and the step at or after which
            it swept there. A piece that several reach is given to the first.
    """

    links: tuple[str, ...]
    link: np.ndarray
    step: np.ndarray


NOT_CLOSED = "is not closed: its cut is that of its surface"
"""The end of a note: what an open body encloses is not in its section."""

NOT_SWEPT = "not swept"
"""The start of a note: the profile leaves something out."""

MOVING = f"{NOT_SWEPT}, though moving by themselves:"
"""The start of a note: obstacles that no link carries and that nobody asked for."""

IN_DOUBT = "in doubt"
"""The start of a note: suspect input that the case does not accept, motion not proven, or joints nobody gives."""


@dataclass(frozen=True, eq=False)
class Profile:
    """The sweep of a motion in a plane, or any set of closed outlines.

    Attributes:
        contours: outer ones counter-clockwise, holes clockwise.
        name: the case, or the file.
        plane: as given: "xy", "xz", "yz" or a point and a normal.
        plane_origin: (3,) [m] world point of the coordinates (0, 0). plane_axes: (2, 3) their directions.
        section: [m] the height of the cut, or None for the silhouette.
        tolerance: [m] that was given.
        bound: [m] the profile contains everything that is swept, and no point of it is farther than this from
            something that is (for a section: in space). 0 for drawn outlines.
        facets: [m] how far the polygons of round shapes stand outside the shapes; not in `bound`.
        n_steps: steps of the motion.
        origin: which link and step made each piece, or None.
        parts: profiles of single links by name, on request.
        notes: what had to be assumed, one line each.
    """

    contours: tuple[Contour, ...]
    name: str = ""
    plane: str = "xy"
    plane_origin: np.ndarray = field(default_factory=lambda: np.zeros(3))
    plane_axes: np.ndarray = field(default_factory=lambda: np.eye(3)[:2])
    section: float | None = None
    tolerance: float = 0.0
    bound: float = 0.0
    facets: float = 0.0
    n_steps: int = 0
    origin: Origin | None = None
    parts: dict[str, Profile] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @cached_property
    def curve(self) -> Curve:
        """All contours as one curve [m]; pieces in the order of `contours`."""
        return joined(self.contours)

    @cached_property
    def region(self) -> Region:
        """The enclosed region, arcs as chords within 1e-6 m; for areas and pictures, not for bounds."""
        from clearance.profiles.region import region_of

        return region_of([contour.flattened(1e-6) for contour in self.contours])

    @property
    def open_cuts(self) -> tuple[str, ...]:
        """The notes on bodies of which only the surface is cut."""
        return tuple(note for note in self.notes if note.endswith(NOT_CLOSED))

    @property
    def left_out(self) -> tuple[str, ...]:
        """The notes on motion, links and obstacles that are not swept."""
        return tuple(note for note in self.notes if note.startswith(NOT_SWEPT))

    @property
    def doubts(self) -> tuple[str, ...]:
        """The notes on suspect input and on motion that is not proven."""
        return tuple(note for note in self.notes if note.startswith(IN_DOUBT))

    @property
    def content(self) -> str:
        """Its content for certain, in words."""
        text = "the surfaces that are swept" if self.open_cuts else "all that is swept"
        text += " but for what its notes leave out" if self.left_out else ""
        return f"{text}, if what its notes doubt is right" if self.doubts else text

    @property
    def promise(self) -> str:
        """The bounds in one sentence, as a file or a terminal has it."""
        return f"contains {self.content}; exceeds it by at most {self.bound * 1000:.4g} mm"

    @property
    def n_pieces(self) -> int:
        """Lines and arcs."""
        return sum(contour.n_pieces for contour in self.contours)

    @property
    def area(self) -> float:
        """[m^2] enclosed, less holes."""
        return sum(contour.area for contour in self.contours)

    @property
    def length(self) -> float:
        """[m] of all contours."""
        return sum(contour.length for contour in self.contours)

    def maker(self, i_piece: int) -> tuple[str, int] | None:
        """The link and the step that made a piece (counted over all contours); None for a drawn outline."""
        if self.origin is None:
            return None
        return self.origin.links[self.origin.link[i_piece]], int(self.origin.step[i_piece])
