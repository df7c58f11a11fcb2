"""The last answer of each pair: valid as long as neither of its bodies has moved.

Pairs of bodies that rest, as a base on its stand or an arm that waits for another, are measured once. Not for:
bounds on bodies that have moved (`sweep`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats3, Integers, Integers2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import row
from clearance.kernels.features.face_pair import Hit, write_points

NEVER = -1


class AnswerCache(NamedTuple):
    """The last answers.

    Attributes:
        asked: (p,) the moves of both bodies when the pair was measured, or `NEVER` without an answer.
        gaps_sq, lower_bounds: (p,) [m^2] the squared distance, [m] the proven bound.
        faces: (p, 2). points: (p, 2, 3) in the world [m].
    """

    asked: Integers
    gaps_sq: Floats
    lower_bounds: Floats
    faces: Integers2
    points: Floats3


@inline
def no_answers(n_pairs):
    """A cache without answers."""
    return AnswerCache(
        np.full(n_pairs, NEVER), np.empty(n_pairs), np.empty(n_pairs),
        np.empty((n_pairs, 2), dtype=np.int64), np.empty((n_pairs, 2, 3)),
    )  # fmt: skip


@inline(force=True)
def is_still_valid(answers, pair, moves, gap):
    """True if the last answer of a pair is valid and within `gap` [m].

    Args:
        moves: the number of moves of both bodies so far.
    """
    return answers.asked[pair] == moves and answers.gaps_sq[pair] <= gap * gap


@inline
def was_contact(answers, pair):
    """True if the surfaces of a pair met when it was last measured."""
    return (
        answers.asked[pair] != NEVER
        and answers.gaps_sq[pair] == 0.0
        and answers.faces[pair, 0] >= 0
    )


@inline
def answer_of(answers, pair):
    """(the hit, the proven bound [m]) of a pair."""
    face_a, face_b = answers.faces[pair]
    p, q = row(answers.points[pair], 0), row(answers.points[pair], 1)
    return Hit(answers.gaps_sq[pair], face_a, face_b, p, q), answers.lower_bounds[pair]


@inline
def note_answer(answers, pair, moves, hit, lower_bound):
    """Stores the answer of a pair; `hit.face_a` is 2**62 if there is none. `moves` as above."""
    answers.asked[pair] = NEVER
    if hit.face_a == 2**62:
        return
    answers.asked[pair] = moves
    answers.gaps_sq[pair], answers.lower_bounds[pair] = hit.gap_sq, lower_bound
    answers.faces[pair, 0], answers.faces[pair, 1] = hit.face_a, hit.face_b
    write_points(hit, answers.points[pair])
