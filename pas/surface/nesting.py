"""The proof that one piecewise surface is inside another: what a hollow node promises.

Both surfaces are seen from one centre, and no ray from there changes cells (see `pas.partition.cells`).  The directions
in which rays leave the inner region through a face and the outer one through another make a cone, which is cut into
triangles exactly; over each of these the inner region is a tetrahedron in which both surfaces are one polynomial, f of
the outer one and g of the inner one.  Claims:

Inside: where g <= 0 in the inner region, f < 0, and the point lies in the outer region, behind its outer face in that
direction (unless both faces are in one plane).  So the inner body, with its sections in the clip faces, is in the
interior of the outer one, relative to these faces.

End: at each contact both clips are the same plane, and on the inner clip faces the outer contact's surface is negative
wherever the inner one's is not positive.  So the wall ends in what is between two curves without a common point.

All inequalities are proved by Bernstein branch and bound with rounding accounted for (see `pas.bernstein.signs`).  What
is not promised: a thickness of the wall, which can only be measured (see `pas.pipeline.hollow`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, dot, to_floats
from pas.bernstein.forms import nearby_forms
from pas.bernstein.signs import Limits, SignResult, prove_positive_inside
from pas.partition.cells import OuterFace, Partition
from pas.surface.contact_proofs import from_signs
from pas.surface.piecewise import PiecewiseSurface
from pas.verdicts import Status, Verdict

INSIDE = "inside"
"""The claim that the inner surface is inside the outer one."""

HALVINGS = Limits(halvings=30)
"""Fewer than other proofs have: where the surfaces cross there is a refutation, and where they touch no end."""


@dataclass(frozen=True)
class Common:
    """A tetrahedron of the inner region over a triangle of directions, which leave both regions through one face each.

    `corners` are its exact points in the outer surface's local coordinates, the centre first; `inner` and `outer` are
    the pieces, and `beyond` is the plane of the outer region's face, positive outside, None where that is the plane of
    the inner one's.
    """

    corners: tuple[Vector, ...]
    inner: int
    outer: int
    beyond: Polynomial | None


def nesting(inner: PiecewiseSurface, outer: PiecewiseSurface) -> tuple[Verdict, ...]:
    """The verdicts on one surface being inside another: inside, and each end of the wall."""
    ends = tuple(_end(inner, outer, number) for number in range(max(len(inner.contacts), len(outer.contacts))))
    return (_inside(inner, outer), *ends)


def _inside(inner: PiecewiseSurface, outer: PiecewiseSurface) -> Verdict:
    """Where the inner surface's function is not positive, the outer one's is negative, all over the inner region."""
    if not inner.partition.cells or not outer.partition.cells:
        return Verdict(Status.UNDECIDED, INSIDE, "one of the surfaces has no region")
    if inner.partition.center is None or inner.partition.center != outer.partition.center:
        return Verdict(Status.UNDECIDED, INSIDE, "the two surfaces are not seen from one centre")
    if not all(join.confined for surface in (inner, outer) for join in surface.joins):
        return Verdict(Status.UNDECIDED, INSIDE, "a clip passes through a region, so that a part of it only is in use")
    parts = common_parts(_in_frame_of(inner.partition, outer.partition), outer.local)
    below = [outer.partition.frame.localise(p).raw for p in inner.polynomials]
    corners = [part.corners for part in parts]
    values = [-outer.patches[part.outer].raw for part in parts]
    found = _prove(values, outer.degree, [below[part.inner] for part in parts], inner.degree, corners)
    reason = "the inner surface is not inside the outer one"
    if found.status is not Status.PROVED:
        return from_signs(outer, INSIDE, reason, found)
    examined = found.simplices
    walls = [(part, -part.beyond.raw) for part in parts if part.beyond is not None]
    if walls:
        narrow = [below[part.inner] for part, _ in walls]
        found = _prove([raw for _, raw in walls], 1, narrow, inner.degree, [part.corners for part, _ in walls])
        examined += found.simplices
        if found.status is not Status.PROVED:
            return from_signs(outer, INSIDE, "the inner surface is not in the region of the outer one", found)
    where = "where the inner function is not positive, the outer one is negative"
    return Verdict(Status.PROVED, INSIDE, f"{where}; {examined} tetrahedra", measure=examined)


def _end(inner: PiecewiseSurface, outer: PiecewiseSurface, number: int) -> Verdict:
    """The wall ends at a contact between two nested curves in one plane."""
    claim = f"end {number + 1}"
    if number >= min(len(inner.contacts), len(outer.contacts)):
        return Verdict(Status.REFUTED, claim, "only one of the two surfaces ends there")
    ours, theirs = inner.joins[number], outer.joins[number]
    if len(ours.planes) != 1 or len(theirs.planes) != 1 or not ours.confined or not theirs.confined:
        return Verdict(Status.UNDECIDED, claim, "one of the surfaces does not end in a plane there")
    frame = outer.partition.frame
    plane = frame.localise(inner.partition.frame.globalise(ours.planes[0].plane)).primitive()
    if plane not in (theirs.planes[0].plane, -theirs.planes[0].plane):
        return Verdict(Status.REFUTED, claim, "the two surfaces end in different planes")
    local = _in_frame_of(inner.partition, outer.partition)
    corners = [local.corners(face.vertices) for face in ours.faces]
    narrow, wide = frame.localise(inner.contacts[number].surface).raw, -theirs.contact.surface.raw
    count = len(corners)
    found = _prove([wide] * count, int(wide.total_degree()), [narrow] * count, int(narrow.total_degree()), corners)
    if found.status is not Status.PROVED:
        return from_signs(outer, claim, "the inner contact is not inside the outer one", found)
    reason = "both end in one plane, the inner section in the interior of the outer one"
    return Verdict(Status.PROVED, claim, reason, measure=found.simplices)


def _prove(
    values: Sequence[fmpq_mpoly],
    degree: int,
    inside: Sequence[fmpq_mpoly],
    other: int,
    corners: Sequence[Sequence[Vector]],
) -> SignResult:
    """That values are positive where other polynomials are not, on simplices."""
    forms, off = nearby_forms(values, corners, degree)
    below, error = nearby_forms(inside, corners, other)
    points = np.array([[to_floats(corner) for corner in simplex] for simplex in corners])
    return prove_positive_inside(forms, below, points, HALVINGS, max(off, error))


def _in_frame_of(partition: Partition, other: Partition) -> Partition:
    """A partition in the local coordinates of another one."""
    if partition is other:
        return other.local
    points = [other.frame.local_point(v) for v in partition.vertices]
    center = None if partition.center is None else other.frame.local_point(partition.center)
    return Partition(points, partition.cells, center, partition.pieces)


def common_parts(inner: Partition, outer: Partition) -> list[Common]:
    """The inner region cut along the directions of both regions' outer faces; both around the origin, in one frame."""
    theirs = [(face, _turned(outer, face)) for face in outer.outer_faces]
    parts = []
    for face in inner.outer_faces:
        triangle = _turned(inner, face)
        for other, window in theirs:
            shared = _clipped(triangle, window)
            wall = None if other.plane == face.plane else other.plane
            for i in range(1, len(shared) - 1):
                ends = [_on_plane(ray, face.plane) for ray in (shared[0], shared[i], shared[i + 1])]
                if dot(ends[0], cross(ends[1], ends[2])) != 0:
                    parts.append(Common(((fmpq(0), fmpq(0), fmpq(0)), *ends), face.piece, other.piece, wall))
    return parts


def _turned(partition: Partition, face: OuterFace) -> tuple[Vector, Vector, Vector]:
    """The corners of an outer face, counterclockwise seen from outside."""
    a, b, c = partition.corners(face.vertices)
    return (a, b, c) if dot(a, cross(b, c)) > 0 else (a, c, b)


def _on_plane(ray: Vector, plane: Polynomial) -> Vector:
    """Where a ray from the origin meets a plane."""
    constant = plane.raw(0, 0, 0)
    share = -constant / (plane.raw(*ray) - constant)
    return ray[0] * share, ray[1] * share, ray[2] * share


def _clipped(triangle: Sequence[Vector], window: Sequence[Vector]) -> list[Vector]:
    """The rays of the cone that two triangles of directions have in common; empty without an inside.

    Sutherland and Hodgman (1974), in exact numbers.
    """
    rays = list(triangle)
    for i in range(3):
        normal = cross(window[i], window[(i + 1) % 3])
        sides = [dot(normal, ray) for ray in rays]
        if not any(side > 0 for side in sides):
            return []
        kept: list[Vector] = []
        for j, (ray, side) in enumerate(zip(rays, sides, strict=True)):
            before, last = rays[j - 1], sides[j - 1]
            if side * last < 0:
                x, y, z = (abs(last) * a + abs(side) * b for a, b in zip(ray, before, strict=True))
                kept.append((x, y, z))
            if side >= 0:
                kept.append(ray)
        rays = kept
    return rays
