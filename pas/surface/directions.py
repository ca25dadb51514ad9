"""The rays along which a surface is sampled while it is made fair: from the centre, spread evenly over the surface.

The outer faces are quartered until no triangle sees more than its share of the surface's area; those
that a contact curve crosses are quartered further.  Each triangle stands for one ray, through its centroid, with
its exact solid angle (van Oosterom and Strackee 1983).  Rays that leave through the inside of a contact are
dropped: what is left is the domain over which the surface is a graph, and it is the same for all members.

The symmetries of the partition and of the member are those of the rays, to rounding.

Plane sections are looked at along rays from the centre, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import log
from typing import Any

import numpy as np

from pas.algebra.bracket import zeros_of_columns
from pas.arrays import Bools, Floats, Integers
from pas.limits import checkpoint
from pas.mesh.rows import quarters
from pas.partition.cells import Partition
from pas.surface.geometry import derivative_batch, profile_batch
from pas.surface.placed import PlacedContacts

EVEN, DEEPEST, FACES = 3, 8, 12
"""Quarterings of every outer face, and of those on a contact curve: seen from the centre, neighbours are foreshortened
there, so that the area near their curves is the least certain.  That is for so many outer faces, as six tetrahedra
have; of more, which are smaller, each is quartered less often."""

AT_ONCE = 256
"""Rays whose faces are looked for together, so that memory is bounded."""

NOTHING = 1e-9
"""The share of the largest value up to which one counts as none: curves through a corner of a triangle are common."""


@dataclass(frozen=True)
class Directions:
    """Rays from the centre: unit `directions` (N, 3), `solid_angles` (N,), and by piece, in the order of `slices`.

    `distances` (N,) are those at which the member that they were made for meets them, in local units.
    """

    directions: Floats
    solid_angles: Floats
    distances: Floats
    slices: tuple[tuple[int, slice], ...]

    @classmethod
    def of(
        cls,
        placed: PlacedContacts,
        columns: Sequence[Floats],
        degree: int,
        number: int,
        even: int = EVEN,
        deepest: int = DEEPEST,
    ) -> Directions:
        """About `number` rays or more for a surface of one sheet around the centre, where it is in use.

        `columns` are the coefficients of its pieces, all in local coordinates; all outer faces are quartered `even`
        times, and triangles on a contact curve `deepest` times, where these are `FACES`.
        """
        share = 1.6  # area of the surface that one ray may stand for, over the mean for the number of rays asked for
        local = placed.local
        less = max(0, round(log(len(local.outer_faces) / FACES, 4)))
        even, deepest = max(1, even - less), max(1, deepest - less)
        triangles = np.array([local.points[list(face.vertices)] for face in local.outer_faces])
        pieces = np.array([face.piece for face in local.outer_faces], dtype=np.intp)
        for _ in range(even):
            triangles, pieces = _quartered(triangles, pieces)
        member, found = _Member(columns, degree), list[tuple[Any, ...]]()
        limit = 0.0
        for level in range(even, deepest + 1):
            checkpoint("sending rays")
            centroids = triangles.mean(axis=1)
            distances, areas = member.met(centroids, pieces)
            angles = solid_angles(triangles)
            areas = areas * angles
            limit = limit or share * float(areas.sum()) / number
            corners = triangles.reshape(-1, 3)
            values = member.values(corners, np.repeat(pieces, 3))[:, 0]
            beyond = (values > NOTHING * np.abs(values).max()).reshape(-1, 3)
            crossed = beyond.any(axis=1) & ~beyond.all(axis=1)
            finer = ((areas > limit) | crossed) & (level < deepest)
            units = centroids / np.linalg.norm(centroids, axis=1)[:, None]
            kept = ~finer & (distances > 0) & placed.in_use(units)
            found.append((units[kept], angles[kept], distances[kept], pieces[kept]))
            triangles, pieces = _quartered(triangles[finer], pieces[finer])
            if not len(triangles):
                break
        units, angles, distances, numbers = (np.concatenate(parts) for parts in zip(*found, strict=True))
        order, slices = _by_piece(numbers, len(columns))
        return cls(units[order], angles[order], distances[order], slices)

    @property
    def pieces(self) -> Integers:
        """The piece in which each ray meets the surface, (N,)."""
        pieces = np.array([piece for piece, _ in self.slices], dtype=np.intp)
        return np.repeat(pieces, [here.stop - here.start for _, here in self.slices])

    def some(self, chosen: Integers, times: float = 1.0) -> Directions:
        """Some of the rays, by rising numbers, each with so many times its solid angle."""
        ends = [(p, *np.searchsorted(chosen, (here.start, here.stop)).tolist()) for p, here in self.slices]
        slices = tuple((p, slice(a, b)) for p, a, b in ends if b > a)
        return Directions(self.directions[chosen], times * self.solid_angles[chosen], self.distances[chosen], slices)

    @classmethod
    def along(
        cls, placed: PlacedContacts, columns: Sequence[Floats], degree: int, units: Floats
    ) -> tuple[Directions, Integers]:
        """Rays of solid angle 0 along given unit vectors (N, 3), and the numbers of those that meet the surface where
        it is in use."""
        used = np.flatnonzero(placed.in_use(units))
        ends, pieces = _ends(placed.local, units[used])
        distances, _ = _Member(columns, degree).met(ends, pieces)
        met = np.flatnonzero(distances > 0)
        order, slices = _by_piece(pieces[met], len(columns))
        met = met[order]
        kept = used[met]
        return cls(units[kept], np.zeros(len(kept)), distances[met], slices), kept


def solid_angles(triangles: Floats) -> Floats:
    """The solid angles (N,) at which triangles (N, 3, 3) are seen from 0 (van Oosterom and Strackee 1983)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = np.abs((a * np.cross(b, c)).sum(axis=1))
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return 2 * np.arctan2(above, below)


def _by_piece(numbers: Integers, count: int) -> tuple[Integers, tuple[tuple[int, slice], ...]]:
    """An order in which the rays of a piece follow one another, and where those of each piece then are."""
    order = np.argsort(numbers, kind="stable")
    starts = np.searchsorted(numbers[order], np.arange(count + 1))
    return order, tuple((p, slice(int(a), int(b))) for p, (a, b) in enumerate(pairwise(starts)) if b > a)


def _ends(local: Partition, units: Floats) -> tuple[Floats, Integers]:
    """Where rays along unit vectors leave the region, and in which piece: the outer face each is most inside of."""
    corners = np.array([local.points[list(face.vertices)] for face in local.outer_faces])
    inverse = np.linalg.inv(corners.transpose(0, 2, 1))
    pieces = np.array([outer.piece for outer in local.outer_faces], dtype=np.intp)
    ends, faces = [], []
    for some in np.array_split(units, 1 + len(units) // AT_ONCE):
        weights = np.einsum("fij,nj->nfi", inverse, some)
        face = weights.min(axis=2).argmax(axis=1)
        ends.append(some / weights[np.arange(len(some)), face].sum(axis=1)[:, None])
        faces.append(face)
    return np.concatenate(ends), pieces[np.concatenate(faces)]


def _quartered(triangles: Floats, pieces: Integers) -> tuple[Floats, Integers]:
    return quarters(triangles).swapaxes(0, 1).reshape(-1, 3, 3), np.tile(pieces, 4)


class _Member:
    """A piecewise polynomial: its values and gradients, and its coefficients along rays from the centre."""

    def __init__(self, columns: Sequence[Floats], degree: int) -> None:
        self.values, self.gradients = (derivative_batch(columns, (order,)) for order in (0, 1))
        self.profiles = profile_batch(columns, degree)

    def met(self, ends: Floats, pieces: Integers) -> tuple[Floats, Floats]:
        """Where rays to given ends meet it, 0 for those that end inside, and the area for a unit of solid angle."""
        steep = 0.05  # cosines between ray and normal count as at least this much where areas are estimated
        profiles = self.profiles(ends, pieces).T
        shares = zeros_of_columns(profiles)
        lengths = np.linalg.norm(ends, axis=1)
        values = profiles.sum(axis=0)
        distances = np.where(values > NOTHING * np.abs(values).max(initial=0.0), shares * lengths, 0.0)
        gradients = self.gradients(ends * shares[:, None], pieces)
        cosines = (gradients * ends).sum(axis=1) / np.maximum(np.linalg.norm(gradients, axis=1) * lengths, 1e-300)
        return distances, distances**2 / np.maximum(cosines, steep)


AROUND = 720
"""Directions of a plane section."""


def planes(means: Sequence[Floats]) -> Iterator[tuple[Floats, Floats]]:
    """Orthonormal pairs that span the planes of two neighbours' directions each."""
    for a, b in combinations(means, 2):
        first = a / np.linalg.norm(a)
        rest = b - (b @ first) * first
        if np.linalg.norm(rest) > 1e-6 * np.linalg.norm(b):
            yield first, rest / np.linalg.norm(rest)


def circle(first: Floats, second: Floats) -> Floats:
    """The unit vectors (AROUND, 3) along which a section in the plane of two orthonormal ones is sampled."""
    angles = (np.arange(AROUND) + 0.5) * 2 * np.pi / AROUND
    return np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * second


def runs(there: Bools) -> list[Integers]:
    """Runs of True round a circle (n,), as index arrays."""
    order = (np.arange(len(there)) + (~there).argmax()) % len(there)
    breaks = np.flatnonzero(np.diff(there[order].astype(int)))
    parts = np.split(order, breaks + 1)
    return [part for part in parts if there[part[0]]]
