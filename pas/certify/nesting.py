"""The proof that one piecewise surface is inside another: what a hollow node promises.

The claims, that the inner body is inside and that the wall ends between nested curves, are those of
docs/theory/verdicts.md, under hollow blends.  Each surface is seen from a centre, and no ray from there changes cells
(see `pas.partition.cells`).  So the directions in which rays from the outer centre leave the outer region through a
face make a cone in which the outer surface is one polynomial f; and between the inner centre and an outer face of the
inner region, in a tetrahedron, the inner surface is one polynomial g.  What such a cone and such a tetrahedron have in
common is cut into tetrahedra exactly.

All inequalities are proved by Bernstein branch and bound with rounding accounted for (see `pas.bernstein.signs`).  What
is not promised: a thickness of the wall (see `pas.certify.thickness`), and of open regions what is outside the cones of
their openings.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from flint import fmpq_mpoly

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, dot, moved, three
from pas.bernstein.search import Limits
from pas.bernstein.signs import Exact, SignResult, alike, positive_on
from pas.certify.certificate import Proposition
from pas.partition.cells import Partition
from pas.partition.complex import OuterFace
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict

LIMITS = Limits(depth=30)
"""Fewer than other proofs have: where the surfaces cross there is a refutation, and where they touch no end."""

TOGETHER = 256
"""Simplices that a search begins with: so many give up together, when too many are open.  Around one centre there are
fewer, around two some thousand."""


Triangle: TypeAlias = "tuple[Vector, Vector, Vector]"
Tetrahedron: TypeAlias = "tuple[Vector, Vector, Vector, Vector]"


@dataclass(frozen=True)
class Common:
    """A tetrahedron of the inner region in which rays from each centre leave their region through one face.

    `corners` are its exact points in the outer surface's local coordinates; `inner` and `outer` are the pieces, and
    `beyond` is the plane of the outer region's face, positive outside, None where that is the plane of the inner one's.
    """

    corners: Tetrahedron
    inner: int
    outer: int
    beyond: Polynomial | None


def nesting(inner: PiecewisePolynomial, outer: PiecewisePolynomial) -> tuple[Verdict, ...]:
    """The verdicts on one surface being inside another: inside, and each end of the wall."""
    ends = tuple(_end(inner, outer, number) for number in range(max(len(inner.contacts), len(outer.contacts))))
    return (_inside(inner, outer), *ends)


def _inside(inner: PiecewisePolynomial, outer: PiecewisePolynomial) -> Verdict:
    """Where the inner surface's function is not positive, the outer one's is negative, all over the inner region."""
    claim = Proposition(outer, "inside")
    if not inner.partition.cells or not outer.partition.cells:
        return claim.undecided("one of the surfaces has no region")
    if inner.partition.center is None or outer.partition.center is None:
        return claim.undecided("one of the surfaces is not seen from a centre")
    if not all(join.confined for surface in (inner, outer) for join in surface.joins):
        return claim.undecided("a clip passes through a region, so that a part of it only is in use")
    if not all(_one_nappe(inner, outer, number) for number, join in enumerate(outer.joins) if join.opening):
        return claim.undecided("the outer region is open, and the inner one not in its direction from its centre")
    frame = outer.partition.frame
    parts = common_parts(in_frame_of(inner.partition, outer.partition), outer.local)
    below = [frame.localise(p).raw for p in inner.polynomials]
    opened = ((s, number) for s in (inner, outer) for number, join in enumerate(s.joins) if join.opening)
    cones = dict.fromkeys(frame.localise(s.contacts[number].clip) for s, number in opened)
    above = [-p.raw for p in outer.patches]

    def proved(some: Sequence[Common], values: Sequence[fmpq_mpoly], degree: int) -> SignResult:
        inside = [([below[part.inner] for part in some], inner.degree), *(alike(q.raw, some) for q in cones)]
        return prove_inside([part.corners for part in some], (values, degree), inside)

    found = proved(parts, [above[part.outer] for part in parts], outer.degree)
    if (failed := claim.failed(found, "the inner surface is not inside the outer one")) is not None:
        return failed
    examined = found.examined
    walls = [(part, -part.beyond.raw) for part in parts if part.beyond is not None]
    if walls:
        found = proved([part for part, _ in walls], [raw for _, raw in walls], 1)
        examined += found.examined
        if (failed := claim.failed(found, "the inner surface is not in the region of the outer one")) is not None:
            return failed
    where = "where the inner function is not positive, the outer one is negative"
    return claim.proved(f"{where}; {examined} tetrahedra", examined)


def _end(inner: PiecewisePolynomial, outer: PiecewisePolynomial, number: int) -> Verdict:
    """The wall ends at a contact between two nested curves in one plane."""
    claim = Proposition(outer, f"end {number + 1}")
    if number >= min(len(inner.contacts), len(outer.contacts)):
        return claim.refuted("only one of the two surfaces ends there")
    ours, theirs = inner.joins[number], outer.joins[number]
    if ours.opening and theirs.opening:
        return _open_end(claim, inner, outer, number)
    if len(ours.planes) != 1 or len(theirs.planes) != 1 or not ours.confined or not theirs.confined:
        return claim.undecided("one of the surfaces does not end in a plane there")
    frame = outer.partition.frame
    plane = frame.localise(inner.partition.frame.globalise(ours.planes[0].plane)).primitive()
    if plane not in (theirs.planes[0].plane, -theirs.planes[0].plane):
        return claim.refuted("the two surfaces end in different planes")
    local = in_frame_of(inner.partition, outer.partition)
    corners = [local.corners(face.vertices) for face in ours.faces]
    return _nested(claim, inner, number, corners, (), "one plane, the inner section in the interior of the outer one")


def _open_end(claim: Proposition, inner: PiecewisePolynomial, outer: PiecewisePolynomial, number: int) -> Verdict:
    """The wall ends at an opening between two nested curves, on one cone or on two, one around the other."""
    if not _one_nappe(inner, outer, number):
        return claim.refuted("the two surfaces do not end in nappes of cones from one point")
    frame, local = outer.partition.frame, in_frame_of(inner.partition, outer.partition)
    clips = [s.contacts[number].clip for s in (outer, inner)]
    narrow, wide = (frame.localise(clip).raw for clip in clips)
    corners, words = [local.corners(cell) for cell in local.cells], "one cone"
    if clips[0].primitive() != clips[1].primitive():
        words = "two cones, the inner one around the outer one"
        faces = [local.corners(face.vertices) for face in local.outer_faces]
        around = prove_inside(faces, alike(-wide, faces), [alike(narrow, faces)])
        below = [frame.localise(inner.polynomials[piece]).raw for piece in local.piece_of.tolist()], inner.degree
        beside = [below, alike(wide, corners), alike(-narrow, corners)]
        between = prove_inside(corners, alike(-outer.joins[number].contact.surface.raw, corners), beside)
        if (failed := claim.failed(around, "the inner cone is not around that of the outer one")) is not None:
            return failed
        if (failed := claim.failed(between, "between the cones the inner surface is not inside")) is not None:
            return failed
    return _nested(claim, inner, number, corners, (wide, -wide), f"{words}, the inner curve inside the outer surface")


def _nested(
    claim: Proposition,
    inner: PiecewisePolynomial,
    number: int,
    corners: Sequence[Sequence[Vector]],
    walls: Sequence[fmpq_mpoly],
    words: str,
) -> Verdict:
    """The verdict that on simplices, where no wall is positive, a contact's inner surface is inside its outer one."""
    outer = claim.surface
    narrow = outer.partition.frame.localise(inner.contacts[number].surface).raw
    wide = -outer.joins[number].contact.surface.raw
    inside = [alike(p, corners) for p in (narrow, *walls)]
    found = prove_inside(corners, alike(wide, corners), inside)
    return claim.settled(found, "the inner contact is not inside the outer one", f"both end in {words}")


def _one_nappe(inner: PiecewisePolynomial, outer: PiecewisePolynomial, number: int) -> bool:
    """Whether both regions are open at a contact from one centre, and the inner one holds points of the outer nappe.

    Of a cone that is negative inside, two points inside are in one nappe iff its bilinear form is negative for both.
    """
    if number >= len(inner.joins) or not inner.joins[number].opening:
        return False
    if inner.partition.center != outer.partition.center:
        return False
    cone = outer.joins[number].contact.clip.raw
    v, w = (next((v for v in s.local.vertices if cone(*v) < 0), None) for s in (inner, outer))
    if v is None or w is None:
        return False
    return bool(cone(*moved(v, (1, w))) < cone(*v) + cone(*w))


def prove_inside(simplices: Sequence[Sequence[Vector]], values: Exact, inside: Sequence[Exact]) -> SignResult:
    """Prove that polynomials are positive where no other polynomials are, on exact simplices."""
    worst, examined = None, 0
    for start in range(0, max(1, len(simplices)), TOGETHER):
        some = slice(start, start + TOGETHER)
        value, *others = ((raws[some], degree) for raws, degree in (values, *inside))
        found = positive_on(simplices[some], value, others, inside=True, near=True, limits=LIMITS)
        examined += found.examined
        if found.status is Status.REFUTED or worst is None or worst.status is Status.PROVED:
            worst = found
        if found.status is Status.REFUTED:
            break
    assert worst is not None
    return replace(worst, examined=examined)


def in_frame_of(partition: Partition, other: Partition) -> Partition:
    """A partition in the local coordinates of another one."""
    return other.local if partition is other else partition.in_frame(other.frame)


def common_parts(inner: Partition, outer: Partition) -> list[Common]:
    """The inner region cut along the cones from the outer centre, 0, to the outer region's faces; both in one frame."""
    theirs = [(face, _turned(outer, face)) for face in outer.outer_faces]
    center = inner.center
    assert center is not None
    parts = []
    for face in inner.outer_faces:
        triangle = _turned(inner, face)
        for other, window in theirs:
            wall = None if other.plane == face.plane else other.plane
            cut = _cut((center, *triangle), window)
            parts += [Common(corners, face.piece, other.piece, wall) for corners in cut]
    return parts


def _cut(tetrahedron: Tetrahedron, window: Triangle) -> list[Tetrahedron]:
    """The part of a tetrahedron in the cone from 0 over a triangle: one plane after the other cuts what there is."""
    kept = [tetrahedron]
    for i in range(3):
        normal = cross(window[i], window[(i + 1) % 3])
        kept = [part for whole in kept for part in _beside(whole, normal)]
    return kept


def _beside(tetrahedron: Tetrahedron, normal: Vector) -> Iterator[Tetrahedron]:
    """The part of a tetrahedron where `normal . x >= 0`, cut into tetrahedra; nothing where that has no inside."""
    sides = [dot(normal, corner) for corner in tetrahedron]
    there = [i for i in range(4) if sides[i] > 0]
    away = [i for i in range(4) if sides[i] < 0]
    if not there:
        return
    if not away:
        yield tetrahedron
        return
    on = [tetrahedron[i] for i in range(4) if sides[i] == 0]
    corners = [tetrahedron[i] for i in there]

    def met(i: int, j: int) -> Vector:
        share = sides[i] / (sides[i] - sides[j])
        return three(a + share * (b - a) for a, b in zip(tetrahedron[i], tetrahedron[j], strict=True))

    if len(away) == 1:  # between the triangle of what is there and its image on the plane, on which corners may be
        yield from _between((*on, *corners), (*on, *(met(i, away[0]) for i in there)))
    elif len(there) == 1:
        a, b, c = (*on, *(met(there[0], j) for j in away))
        yield corners[0], a, b, c
    else:
        first, second = there
        yield from _between((corners[0], *(met(first, j) for j in away)), (corners[1], *(met(second, j) for j in away)))


def _between(first: Sequence[Vector], second: Sequence[Vector]) -> Iterator[Tetrahedron]:
    """A prism between two triangles, of which leading corners may be the same, as a stack of tetrahedra."""
    chain = (*first, *second)
    for start in range(3):
        a, b, c, d = chain[start : start + 4]
        if first[start] != second[start]:
            yield a, b, c, d


def _turned(partition: Partition, face: OuterFace) -> Triangle:
    """The corners of an outer face, counterclockwise seen from outside."""
    a, b, c = partition.corners(face.vertices)
    return (a, b, c) if dot(a, cross(b, c)) > 0 else (a, c, b)
