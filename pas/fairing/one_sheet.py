"""The condition of one sheet: where members fail it along rays from the centre, and what is asked of them there.

The rays end at the points of a uniform lattice on every outer face.  They never change, and the
symmetries of a partition are theirs: so what is found with them depends on the member alone, not
on the way to it, and neither on the last bits of its coefficients.
"""

from __future__ import annotations

from functools import lru_cache
from math import gcd

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Exponents, Floats, exponents, homogeneous_exponents, monomial_values
from pas.fairing.constraints import Inequalities, Margins, SampledConstraints, lattice_weights
from pas.kernels.library import compiled

SAMPLES = 32
"""Values of f on each ray between which its zeros are looked for; halved steps found the same."""

LEVELS = 3
"""Values that are looked for, each of which a ray may pass once in a step: -band, 0 and band."""


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

    def missed(self, member: Floats, margins: Margins, share: float) -> Inequalities:
        """The condition where a member takes the values 0 and +-band, to a step's second order, and rises by less than
        a share of what margins ask."""
        guard, lengths = self.guard, self._lengths
        rays, shares, slopes = crossed(self._profiles(member), self._shares, margins.band * guard.reach)
        asked = margins.sheet * guard.reach * lengths / guard.radius
        flat = slopes < share * asked[rays]
        rays, shares = rays[flat], shares[flat]
        points, pieces = self.ends[rays] * shares[:, None], self.piece_of[rays]
        found = Inequalities.none(guard.basis.size)
        for piece in np.unique(pieces).tolist():
            here = pieces == piece
            found += Inequalities(guard.basis.radial(piece, points[here]), (shares * asked[rays])[here])
        return found

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
    compiled().call("pas_levels", *sizes, profiles, len(shares), shares, float(band), rays, places, slopes, number)
    found = int(number[0])
    return rays[:found].copy(), places[:found].copy(), slopes[:found].copy()


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
