"""Exact similarities that take some curves' centres and planes to others: what makes two nodes the same.

Rotations, reflections, scales and translations with rational entries are found; irrational ones are not, and of
anchors in one plane none whose scale is irrational.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import isqrt
from typing import TypeAlias

from flint import fmpq, fmpq_mat

from pas.algebra.affine import ORIGIN, Affine
from pas.algebra.rational import Vector, cross, dot, minus
from pas.contacts.contact import Contact

Matrix: TypeAlias = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Anchor:
    """A point and a direction that move with a contact: the centre of its curve and the normal of its plane."""

    point: Vector
    normal: Vector

    @classmethod
    def of(cls, contact: Contact) -> Anchor:
        """That of a contact; raises `GeometryError` where it has no plane curve."""
        return cls(contact.rim.center, contact.rim.normal)


def similarities(before: Sequence[Anchor], after: Sequence[Anchor]) -> Iterator[tuple[Affine, fmpq]]:
    """Exact similarities with their scales that may take some anchors to others, in whatever order.

    As many anchors as span the space, or the plane that all lie in, are tried in all places.  Where all are on one
    line, a reflection takes the one line to the other.
    """
    if len(before) != len(after):
        return
    sizes = range(2, len(before) + 1)
    ranks = [fmpq_mat([list(v) for v in _vectors(before[:size])]).rank() for size in sizes]
    base = before[: sizes[ranks.index(max(ranks))]]
    for chosen in permutations(after, len(base)):
        found = linear_maps(_vectors(base), _vectors(chosen))
        if found is not None:
            for matrix, scale in found:
                image = Affine(matrix, ORIGIN).exact(base[0].point)
                x, y, z = (b - a for a, b in zip(image, chosen[0].point, strict=True))
                yield Affine(matrix, (x, y, z)), scale


def _vectors(anchors: Sequence[Anchor]) -> list[Vector]:
    """Vectors that move with anchors: differences of points, and the first of these along the normals."""
    first, *others = anchors
    ways = [minus(other.point, first.point) for other in others]
    along = [_times(a.normal, dot(ways[0], a.normal) / dot(a.normal, a.normal)) for a in anchors]
    return [*ways, *along]


def linear_maps(before: list[Vector], after: list[Vector]) -> list[tuple[Matrix, fmpq]] | None:
    """The linear similarities that take some vectors to others, and their scales; None where there is none."""
    scale = _root(dot(after[0], after[0]) / dot(before[0], before[0]))
    if scale is None:
        return None
    if any(dot(a, after[0]) != dot(b, before[0]) * scale**2 for a, b in zip(after, before, strict=True)):
        return None
    pivots = _independent(before)
    ours, theirs = [before[i] for i in pivots], [after[i] for i in pivots]
    if len(pivots) == 1:
        return [(_reflected(_times(ours[0], scale), theirs[0], scale), scale)]
    if len(pivots) == 3:
        choices = [(ours, theirs)]
    else:
        normal, image = cross(*ours), _times(cross(*theirs), 1 / scale)
        choices = [([*ours, normal], [*theirs, image]), ([*ours, normal], [*theirs, _times(image, fmpq(-1))])]
    found = []
    for columns, images in choices:
        matrix = _columns(images) * _columns(columns).inv()
        if matrix.transpose() * matrix == fmpq_mat(3, 3, [scale**2 * (i == j) for i in range(3) for j in range(3)]):
            found.append((_rows(matrix), scale))
    return found


def _independent(vectors: Sequence[Vector]) -> list[int]:
    """The numbers of the first vectors that are independent of those before them."""
    chosen: list[int] = []
    for number in range(len(vectors)):
        rows = [list(vectors[i]) for i in (*chosen, number)]
        if fmpq_mat(rows).rank() == len(rows):
            chosen.append(number)
    return chosen


def _reflected(old: Vector, new: Vector, scale: fmpq) -> Matrix:
    """A reflection that takes a vector to another of its length (Householder 1958), or none, times the scale."""
    w = minus(new, old)
    square = dot(w, w)
    rows = [[scale * ((i == j) - (2 * w[i] * w[j] / square if square else 0)) for j in range(3)] for i in range(3)]
    return _rows(fmpq_mat(rows))


def _columns(vectors: Sequence[Vector]) -> fmpq_mat:
    return fmpq_mat([list(v) for v in vectors]).transpose()


def _rows(matrix: fmpq_mat) -> Matrix:
    x, y, z = ((matrix[i, 0], matrix[i, 1], matrix[i, 2]) for i in range(3))
    return x, y, z


def _root(square: fmpq) -> fmpq | None:
    """The rational square root of a positive number; None where it is irrational."""
    p, q = isqrt(int(square.p)), isqrt(int(square.q))
    return fmpq(p, q) if fmpq(p * p, q * q) == square else None


def _times(a: Vector, factor: fmpq) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor
