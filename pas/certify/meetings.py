"""How the patches of a surface meet a contact on its clip faces.

In each clip plane each patch is divided by the contact's surface in powers of the plane (see
`pas.certify.expansion`).  Where that fails, the surface's factors on the plane are told apart: those
without a zero on the faces have no part in the curve there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import fmpq_mpoly

from pas.algebra.polynomial import RING, Polynomial
from pas.bernstein.forms import rounded_forms
from pas.bernstein.search import Limits
from pas.bernstein.signs import SignResult, prove_positive
from pas.certify.expansion import Division, divide, powers
from pas.contacts.joins import ClipPlane, Join
from pas.partition.complex import OuterFace
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status


@dataclass(frozen=True)
class Meeting:
    """How a patch meets a contact on its clip faces in one plane.

    `factors` are those irreducible factors of the contact's surface on the plane, of multiplicity 1,
    that are not proved to have no zero on the faces; found only where the division by all fails.
    """

    faces: tuple[OuterFace, ...]
    division: Division
    factors: tuple[fmpq_mpoly, ...] = ()


def meetings(surface: PiecewisePolynomial, join: Join, order: int) -> list[Meeting]:
    """How each patch behind clip faces meets a contact, as far as GC^`order`."""
    return [
        _meeting(surface.patches[piece], join, plane, piece, order)
        for plane in join.planes
        for piece in dict.fromkeys(face.piece for face in plane.faces)
    ]


def alpha_signs(
    surface: PiecewisePolynomial,
    join: Join,
    *,
    on_curve: bool,
    limits: Limits | None = None,
    beside: Sequence[Join] = (),
) -> SignResult:
    """Branch and bound for alpha > 0 on the clip faces (or on the curve), where `patch = alpha f_i`.

    Contacts `beside` it whose curves lie in the same faces have their surfaces divided out of alpha:
    what is left is positive where the patch is negative inside one of the curves alone.  Raises
    `ValueError` where the patch does not vanish on the contact's curve.
    """
    values, zeros, points = [], [], []
    for meeting in meetings(surface, join, 0):
        if meeting.division.alpha is None:
            raise ValueError("alpha is defined where the contact is met only")
        exact = [join.partition.corners(face.vertices) for face in meeting.faces]
        alpha = _without(meeting.division.alpha, [other for other in beside if other is not join], meeting.faces[0])
        values.append(rounded_forms(alpha, exact, surface.degree))
        zeros.append(rounded_forms(join.contact.surface.raw, exact))
        points.append(join.partition.points[[face.vertices for face in meeting.faces]])
    where_zero = np.concatenate(zeros) if on_curve else None
    return prove_positive(np.concatenate(values), np.concatenate(points), where_zero, limits)


def _without(alpha: fmpq_mpoly, others: Sequence[Join], face: OuterFace) -> fmpq_mpoly:
    """What remains of alpha on a clip face without the factors that are other contacts' surfaces there."""
    for other in others:
        if any(plane.plane == face.plane for plane in other.planes):
            quotient, remainder = divmod(alpha, powers(other.contact.surface.raw, face.plane, 1)[0])
            alpha = quotient if remainder.is_zero() else alpha
    return alpha


def unmet(join: Join, meeting: Meeting) -> SignResult | None:
    """A refutation with points of the curve on the faces where the obstacle is not zero, if one is found."""
    obstacle = RING.constant(0) if meeting.division.obstacle is None else meeting.division.obstacle
    for factor in meeting.factors:
        # equal to the obstacle on the curve, and of its size there, however small that is
        remainder = divmod(obstacle, factor)[1]
        for sign in (1, -1) if not remainder.is_zero() else ():
            result = on_faces(remainder * sign, join, meeting.faces, factor)
            if result.status is Status.REFUTED:
                return result
    return None


def on_faces(value: fmpq_mpoly, join: Join, faces: Sequence[OuterFace], zero: fmpq_mpoly | None = None) -> SignResult:
    """Branch and bound for `value > 0` on some outer faces, or only where `zero` vanishes."""
    exact = [join.partition.corners(face.vertices) for face in faces]
    corners = join.partition.points[[face.vertices for face in faces]]
    where_zero = None if zero is None else rounded_forms(zero, exact)
    return prove_positive(rounded_forms(value, exact), corners, where_zero)


def _meeting(patch: Polynomial, join: Join, plane: ClipPlane, piece: int, order: int) -> Meeting:
    faces = tuple(face for face in plane.faces if face.piece == piece)
    f, g = (powers(p.raw, plane.plane, order + 1) for p in (join.contact.surface, patch))
    division = divide(g, f, f[0], RING.constant(1))
    if division.obstacle is None:
        return Meeting(faces, division)
    unit, factors = RING.constant(1), []
    for factor, times in f[0].factor()[1]:
        sign = _constant_sign(factor, join, faces)
        if sign:
            unit *= (factor * sign) ** times
        elif times == 1:
            factors.append(factor)
    return Meeting(faces, divide(g, f, divmod(f[0], unit)[0], unit), tuple(factors))


def _constant_sign(polynomial: fmpq_mpoly, join: Join, faces: Sequence[OuterFace]) -> int:
    """1 or -1 where a polynomial is proved to have that sign on all of some faces, else 0."""
    for sign in (1, -1):
        if on_faces(polynomial * sign, join, faces).status is Status.PROVED:
            return sign
    return 0
