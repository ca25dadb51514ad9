"""Members along rays from the centre: where each ray meets the surface, and how steeply.

The rays end at the points of a uniform lattice on every outer face.  They never change, and the
symmetries of a partition are theirs: so what is found with them depends on the member alone, not
on the way to it, and neither on the last bits of its coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from math import gcd

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Exponents, Floats, exponents, homogeneous_exponents, monomial_values
from pas.fairing.sampled import Inequalities, SampledConstraints, lattice_weights
from pas.kernels.library import Functions

SAMPLES = 32
"""Values of f on each ray between which its zeros are looked for; halved steps found the same."""

LEVELS = 3
"""Values that are looked for, each of which a ray may pass once in a step: -band, 0 and band."""


@dataclass(frozen=True)
class RayCrossings:
    """Where a member takes the values 0 and +-band: ray numbers (N,), shares of the rays (N,), and
    the derivative along the ray there as a multiple of what `Margins.sheet = 1` would ask (N,)."""

    rays: NDArray[np.intp]
    shares: Floats
    steepness: Floats

    def below(self, steepness: float) -> RayCrossings:
        """The crossings less steep than that."""
        chosen = self.steepness < steepness
        return RayCrossings(self.rays[chosen], self.shares[chosen], self.steepness[chosen])

    def __len__(self) -> int:
        return len(self.rays)


class RayLattice:
    """Rays from the centre to a lattice of the outer faces (none where the partition has no centre)."""

    def __init__(self, guard: SampledConstraints, subdivisions: int) -> None:
        self.guard, self.degree = guard, guard.basis.degree
        ends = _ends(guard, subdivisions)
        self.pieces = sorted(ends)
        self.ends = np.concatenate([np.empty((0, 3)), *(ends[piece] for piece in self.pieces)])
        self.piece_of = np.repeat(self.pieces, [len(ends[piece]) for piece in self.pieces])
        self._monomials = {piece: monomial_values(points, self.degree) for piece, points in ends.items()}
        degrees = [sum(e) for e in exponents(self.degree)]
        self._degrees = np.equal.outer(np.arange(self.degree + 1), degrees).astype(float)
        self._lengths = np.sqrt((self.ends * self.ends).sum(axis=1))
        self._shares = np.arange(SAMPLES + 1) / SAMPLES

    def crossings(self, unknowns: Floats, band: float) -> RayCrossings:
        """Where the member with these coefficients is 0 or +-band, each to a step's second order."""
        rays, shares, slopes = crossed(self._profiles(unknowns), self._shares, band)
        return RayCrossings(rays, shares, slopes * self.guard.radius / (self.guard.reach * self._lengths[rays]))

    def rows(self, crossings: RayCrossings, margin: float) -> Inequalities:
        """Rows that ask for the sheet condition at crossings."""
        rows = Inequalities.none(self.guard.basis.size)
        points, pieces = self.ends[crossings.rays] * crossings.shares[:, None], self.piece_of[crossings.rays]
        for piece in np.unique(pieces).tolist():
            rows += self.guard.sheet(piece, points[pieces == piece], margin)
        return rows

    def _profiles(self, unknowns: Floats) -> Floats:
        """The coefficients of the member as a polynomial in the share of each ray: (n + 1, rays)."""
        blocks = [np.empty((self.degree + 1, 0))]
        for piece in self.pieces:
            terms = self._degrees * (unknowns @ self.guard.basis.coefficients[piece])
            blocks.append(terms @ self._monomials[piece])
        return np.concatenate(blocks, axis=1)


def crossed(profiles: Floats, shares: Floats, band: float) -> tuple[NDArray[np.intp], Floats, Floats]:
    """Where polynomials, columns of `profiles` (n + 1, N), pass -band, 0 and band between shares (S,) that are evenly
    apart from 0 on, at most 65: columns, shares and slopes, (M,) each, by rising columns, shares and levels."""
    room = LEVELS * (len(shares) - 1) * profiles.shape[1]
    rays, number = np.empty(room, dtype=np.intp), np.zeros(1, dtype=np.intp)
    places, slopes = np.empty(room), np.empty(room)
    sizes = (len(profiles) - 1, profiles.shape[1])
    _functions().call("pas_levels", *sizes, profiles, len(shares), shares, float(band), rays, places, slopes, number)
    found = int(number[0])
    return rays[:found].copy(), places[:found].copy(), slopes[:found].copy()


@cache
def _functions() -> Functions:
    return Functions()


def _ends(guard: SampledConstraints, subdivisions: int) -> dict[int, Floats]:
    """The lattice points of the outer faces by piece, those that faces share once."""
    local = guard.placed.local
    if local.center is None:
        return {}
    seen: set[tuple[tuple[int, int, int], ...]] = set()
    ends: dict[int, list[Floats]] = {}
    for face in local.outer_faces:
        corners = local.points[list(face.vertices)]
        parts = guard.parts(corners, subdivisions)
        inner, edges = _of_lattice(parts)
        new = []
        for number, index in edges:
            lowest = ((v, i, gcd(i, parts)) for v, i in zip(face.vertices, index, strict=True) if i)
            key = tuple(sorted((v, i // d, parts // d) for v, i, d in lowest))
            if key not in seen:
                seen.add(key)
                new.append(number)
        ends.setdefault(face.piece, []).append(lattice_weights(parts, 3)[sorted([*inner, *new])] @ corners)
    return {piece: np.concatenate(parts) for piece, parts in ends.items()}


@lru_cache(maxsize=16)
def _of_lattice(parts: int) -> tuple[list[int], list[tuple[int, Exponents]]]:
    """The numbers of a triangle's lattice points within it, and those on its edges with their indices."""
    indices = list(enumerate(homogeneous_exponents(parts, 3)))
    return [number for number, index in indices if min(index)], [(n, index) for n, index in indices if not min(index)]
