"""The places of contacts on a partition: the clip faces and the curves in them.

A `Join` is one contact together with its clip faces, the outer faces on which the clip vanishes identically, and the
pieces behind them, which carry the contact.  A clip vanishes on a face iff the face's plane divides it; what is left of
the clip, its cofactor, says on which side the clip is negative and where else it may cut the surface.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations

import numpy as np

from pas.algebra.bracket import zeros_of_columns
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, dot, three
from pas.arrays import Floats, Integers
from pas.bernstein.signs import SignResult, apart_on
from pas.contacts.cones import first_met, nappe, nappe_rays
from pas.contacts.contact import Contact
from pas.errors import GeometryError
from pas.partition.cells import Partition
from pas.partition.complex import Indices, OuterFace
from pas.verdicts import Status

CURVE_LATTICE = 24
"""Subdivisions of a clip face's edge when its curve is sampled: some fifty points a curve."""


@dataclass(frozen=True)
class ClipPlane:
    """The clip faces in one plane, `plane > 0` outside the region, where `clip = plane * cofactor`."""

    plane: Polynomial
    faces: tuple[OuterFace, ...]
    cofactor: Polynomial

    @property
    def simple(self) -> bool:
        """Whether the clip changes its sign at the plane, not having it for a factor twice."""
        return not _divides(self.plane, self.cofactor)

    def rim(self, partition: Partition) -> list[tuple[Vector, Vector]]:
        """The edges that bound the union of the faces."""
        owners = Counter(edge for face in self.faces for edge in combinations(face.vertices, 2))
        a = partition.vertices
        return [(a[i], a[j]) for (i, j), times in owners.items() if times == 1]


@dataclass(frozen=True)
class Join:
    """A contact, the clip faces it passes through and the partition they belong to."""

    contact: Contact
    faces: tuple[OuterFace, ...]
    partition: Partition

    @property
    def pieces(self) -> tuple[int, ...]:
        """The pieces that carry the contact."""
        if len(self.partition.pieces) == 1 or self.opening:
            return tuple(range(len(self.partition.pieces)))
        return tuple(dict.fromkeys(face.piece for face in self.faces))

    @cached_property
    def planes(self) -> tuple[ClipPlane, ...]:
        """The planes of the clip faces, each with its faces."""
        clip = self.contact.clip.raw
        planes = dict.fromkeys(face.plane for face in self.faces)
        return tuple(
            ClipPlane(
                plane,
                tuple(face for face in self.faces if face.plane == plane),
                Polynomial.from_raw(divmod(clip, plane.raw)[0]),
            )
            for plane in planes
        )

    def rim(self) -> list[tuple[Vector, Vector]]:
        """The edges that bound the clip faces, in each of their planes."""
        return [edge for plane in self.planes for edge in plane.rim(self.partition)]

    @cached_property
    def rest(self) -> Polynomial:
        """The clip without the planes of its clip faces: what may cut the surface elsewhere."""
        rest = self.contact.clip.raw
        for plane in self.planes:
            quotient, remainder = divmod(rest, plane.plane.raw)
            rest = quotient if remainder.is_zero() else rest
        return Polynomial.from_raw(rest)

    @cached_property
    def elsewhere(self) -> SignResult:
        """The proof that in the region the contact's curve is in the clip faces only.

        Not proved where the clip has no face, as a curved one, or has another factor or a plane
        that passes through the region and meets the surface there.
        """
        where = [(self.rest, self.partition.cells)] if self.rest.degree > 0 else []
        where += [(plane.plane, cells) for plane in self.planes if (cells := self._cut_by(plane))]
        results = (self._apart(polynomial, cells) for polynomial, cells in where)
        nothing = apart_on((), ())
        return next((result for result in results if result.status is not Status.PROVED), nothing)

    @property
    def confined(self) -> bool:
        """Whether the contact's curve is proved to be in its clip faces alone, or the region opens through it."""
        return self.opening or (bool(self.faces) and self.elsewhere.status is Status.PROVED)

    @cached_property
    def opening(self) -> bool:
        """Whether the clip is a cone of degree 2 around the centre of a region that is open (see `openings`)."""
        return not self.faces and opens(self.partition, self.contact)

    def _apart(self, polynomial: Polynomial, simplices: Sequence[Indices]) -> SignResult:
        """The proof that a polynomial and the surface have no common zero on simplices."""
        exact = [self.partition.corners(s) for s in simplices]
        return apart_on(exact, (self.contact.surface.raw, polynomial.raw))

    def _cut_by(self, plane: ClipPlane) -> tuple[Indices, ...]:
        """The cells that a clip plane meets elsewhere than in a clip face (none in a convex region)."""
        signs = [plane.plane.raw(*v) for v in self.partition.vertices]
        known = [set(face.vertices) for face in plane.faces]
        return tuple(
            cell
            for cell in self.partition.cells
            if any(signs[v] > 0 for v in cell)
            or not any({v for v in cell if signs[v] == 0} <= vertices for vertices in known)
        )

    def curve(self) -> Floats:
        """Points (m, 3) of the contact curve, spread along it, to about 1e-14."""
        return np.concatenate([np.empty((0, 3)), *(points for points, _ in self.measured_curves())])

    def measured_curves(self, subdivisions: int = CURVE_LATTICE) -> list[tuple[Floats, Floats]]:
        """For each clip face, the points (m, 3) of the curve on it, and how much of the curve each stands for, (m,).

        An opening has one such curve, though no face.

        Points are those where the curve crosses a lattice of so many `subdivisions` of the face's edges.

        Curves are measured in their face: by the sum of the changes of the barycentric coordinates, so that
        a small face counts as much as a large one.  Sums with these weights are integrals along
        the curve, and depend on it continuously, even where it passes through points of the lattice.
        """
        return self._through_opening if self.opening else self._on_faces(subdivisions)

    @cached_property
    def rays(self) -> Floats:
        """Unit vectors (m, 3) from the centre, 0, to points spread along the curve of an opening, in order."""
        opening_points = 96  # of the curve through which a region is open
        return nappe_rays(self.nappe, opening_points)

    @cached_property
    def nappe(self) -> Floats:
        """The axes (3, 3) of the nappe of an opening that is in the region, see `cones.nappe`."""
        return nappe(self.contact.clip, self.partition.points.mean(axis=0))

    @cached_property
    def _through_opening(self) -> list[tuple[Floats, Floats]]:
        """The measured curve of an opening, which is in no face: weights are shares of its length."""
        points = self.rays * first_met(self.contact.surface, self.rays)[:, None]
        steps = np.sqrt(((points - np.roll(points, 1, axis=0)) ** 2).sum(axis=1))
        return [(points, (steps + np.roll(steps, -1)) / (2 * steps.sum()))]

    @cached_property
    def _on_faces(self) -> Callable[[int], list[tuple[Floats, Floats]]]:
        surface, triangles = self.contact.surface, [self.partition.points[list(face.vertices)] for face in self.faces]
        return cache(lambda subdivisions: [_zeros_on_triangle(surface, t, subdivisions) for t in triangles])

    @cached_property
    def radius(self) -> float:
        """The smallest distance of the curve from its mean point (a circle's radius)."""
        curve = self.curve()
        if not len(curve):
            return np.inf
        return float(np.linalg.norm(curve - curve.mean(axis=0), axis=1).min())

    def inside_point(self) -> Vector | None:
        """An exact point of a clip face where the surface is negative, if a lattice has one."""
        for face in self.faces:
            corners = self.partition.corners(face.vertices)
            for weights in reversed(homogeneous_exponents(CURVE_LATTICE, 3)):
                point = three(dot(weights, values) / CURVE_LATTICE for values in zip(*corners, strict=True))
                if self.contact.surface.at(point) < 0:
                    return point
        return None


def joins(partition: Partition, contacts: Sequence[Contact]) -> tuple[Join, ...]:
    """The place of each contact on the partition.

    A single piece carries every contact, wherever its clip lies, and all pieces carry one through which the region is
    open; else a contact needs a face: raises `GeometryError` for a clip that vanishes on no outer face.
    """
    result = []
    for number, contact in enumerate(contacts, start=1):
        clip = contact.clip
        faces = tuple(
            face
            for face in partition.outer_faces
            if all(clip.raw(*p) == 0 for p in partition.corners(face.vertices))
            and (clip.degree == 1 or _divides(face.plane, clip))
        )
        if not faces and len(partition.pieces) > 1 and not opens(partition, contact):
            what = "lies in its clip plane" if clip.degree == 1 else "is a face of its clip"
            raise GeometryError(
                f"contact {number}: no outer face of the partition ({partition.name}) {what} {clip} = 0"
            )
        result.append(Join(contact, faces, partition))
    return tuple(result)


def opens(partition: Partition, contact: Contact) -> bool:
    """Whether a contact's clip is a cone of degree 2 whose apex is the centre of a partition, at a corner of it."""
    if not partition.sides or contact.clip.degree != 2 or partition.center is None:
        return False
    clip = contact.clip
    return not any(p.raw(*partition.center) for p in (clip, *map(clip.diff, range(3))))


def _divides(plane: Polynomial, polynomial: Polynomial) -> bool:
    return bool(divmod(polynomial.raw, plane.raw)[1].is_zero())


@cache
def _lattice(n: int) -> tuple[Floats, Integers, Integers]:
    """The uniform lattice on a triangle: barycentric coordinates (m, 3) of its points, the edges (e, 2) of its small
    triangles, and these by the numbers of their edges (n^2, 3)."""
    place = {index: k for k, index in enumerate(reversed(homogeneous_exponents(n, 3)))}
    edges: dict[tuple[int, int], int] = {}
    for (i, j, k), start in place.items():
        for end in ((i + 1, j, k - 1), (i, j + 1, k - 1), (i + 1, j - 1, k)):
            if end in place:
                edges[start, place[end]] = len(edges)
    triangles = []
    for i, j, k in place:
        for step in (1, -1):  # upward and downward triangles
            corners = sorted(place.get(c, -1) for c in ((i, j, k), (i + step, j - step, k), (i + step, j, k - step)))
            if corners[0] >= 0:
                triangles.append([edges[pair] for pair in combinations(corners, 2)])
    return np.array([*place]) / n, np.array([*edges]), np.array(triangles)


def _zeros_on_triangle(surface: Polynomial, corners: Floats, subdivisions: int) -> tuple[Floats, Floats]:
    weights, pairs, edges = _lattice(subdivisions)
    points = weights @ corners
    negative = surface(points) < 0
    crossed = negative[pairs[:, 0]] != negative[pairs[:, 1]]
    first, second = pairs[crossed].T
    first, second = np.where(negative[first], first, second), np.where(negative[first], second, first)
    start, way = points[first], points[second] - points[first]
    places = np.arange(surface.degree + 1) / max(surface.degree, 1)
    values = np.array([surface(start + place * way) for place in places])
    shares = zeros_of_columns(np.linalg.solve(np.vander(places, increasing=True), values))  # by the shares of edges
    zeros = start + shares[:, None] * way
    inverse = np.linalg.pinv(np.vstack([corners.T, np.ones(3)]))
    barycentric = np.concatenate([zeros, np.ones((len(zeros), 1))], axis=1) @ inverse.T
    number = np.cumsum(crossed) - 1
    # the curve crosses two edges of a small triangle, or none: half of the piece between belongs to each
    ends = number[edges[crossed[edges]]].reshape(-1, 2)
    pieces = np.abs(barycentric[ends[:, 0]] - barycentric[ends[:, 1]]).sum(axis=1)
    lengths = np.bincount(ends.ravel(), weights=np.repeat(pieces / 2, 2), minlength=len(zeros)).astype(float)
    return zeros, lengths
