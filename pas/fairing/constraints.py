"""Sampled constraints on members: inequalities, with a margin, for the conditions that the proofs ask everywhere.

`f > 0` on the outer walls, `alpha > 0` on the clip faces and along the cones through openings, `f < 0` at the centre.
The condition of one sheet is asked at points of the surface, which are not known beforehand: where members fail it on
rays from the centre to the points of a uniform lattice on every outer face.  These never change, and the symmetries of
a partition are theirs: so what is found with them depends on the member alone, not on the way to it, and neither on the
last bits of its coefficients.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import _lru_cache_wrapper, cached_property, lru_cache
from math import ceil, gcd, pi

import numpy as np
from scipy.spatial import cKDTree

from pas.algebra.monomials import Exponents, exponents, homogeneous_exponents, monomial_values
from pas.algebra.rational import to_float
from pas.arrays import Floats, Integers
from pas.contacts.joins import Join
from pas.fairing.basis import WorkingBasis
from pas.kernels.library import compiled
from pas.surface.placed import PlacedContacts

CONE_EVERY, CONE_SHARES = 4, (0.3, 0.7, 0.9, 1.1)
"""Points of an opening's curve that the cone through it is looked at beside, and where, in multiples of them."""

SAMPLES = 32
"""Values of f on each ray between which its zeros are looked for; halved steps found the same."""


@dataclass(frozen=True)
class Margins:
    """How clearly the inequalities shall hold.

    `sheet`: `grad f . (x - O) >= sheet * r * |x - O| / R` where `|f| <= band * r`, and `wall`: `f >= wall * min(d, r)`,
    with d the distance from the contact curves, on which f is 0, r the smallest distance of a contact's tangent planes
    from the centre O (a pipe's radius), R the radius of the region and f of unit mean gradient on the contact curves;
    `alpha >= alpha` with mean 1.
    `depth`: `f <= -depth * r` at O, so that the surface keeps away from the centre.
    """

    sheet: float = 0.1
    wall: float = 0.03
    alpha: float = 0.05
    band: float = 0.005
    depth: float = 0.1

    def times(self, share: float) -> Margins:
        """A share of each."""
        return Margins(*(share * value for value in astuple(self)))


@dataclass(frozen=True)
class Inequalities:
    """Inequalities `rows @ q >= at_least` on the working coefficients, (N, m) and (N,)."""

    rows: Floats
    at_least: Floats

    def __add__(self, other: Inequalities) -> Inequalities:
        if not len(self) or not len(other):
            return self if len(self) else other
        return Inequalities(np.concatenate([self.rows, other.rows]), np.concatenate([self.at_least, other.at_least]))

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def unit(self) -> Inequalities:
        """These half-spaces by rows of unit length, which serve solvers best."""
        by = lengths(self.rows)
        return Inequalities(self.rows / by[:, None], self.at_least / by)

    def missed(self, unknowns: Floats, share: float) -> Inequalities:
        """The inequalities of which a member does not reach a share of the right-hand side."""
        chosen = self.rows @ unknowns < share * self.at_least
        return Inequalities(self.rows[chosen], self.at_least[chosen])

    @classmethod
    def none(cls, unknowns: int) -> Inequalities:
        """No rows at all."""
        return cls(np.empty((0, unknowns)), np.empty(0))


class AlphaOnFace:
    """`alpha` of every member on one clip face, where `g = alpha f`, as linear functionals.

    `scale` multiplies alpha so that it refers to the contact scaled to unit mean gradient.
    """

    def __init__(self, basis: WorkingBasis, join: Join, face: int, scale: float) -> None:
        outer = join.faces[face]
        self.corners = join.partition.points[list(outer.vertices)]
        self.degree = basis.degree - join.contact.surface.degree
        nodes = lattice_weights(2 * basis.degree) @ self.corners
        values = join.contact.surface(nodes)[:, None] * self._monomials(nodes)
        self.coefficients = scale * np.linalg.lstsq(values, basis.values(outer.piece, nodes), rcond=None)[0]

    def rows(self, points: Floats) -> Floats:
        """Values of alpha of the members at points (N, 3) of the face: (N, m)."""
        return self._monomials(points) @ self.coefficients

    def _monomials(self, points: Floats) -> Floats:
        edges = (self.corners[1:] - self.corners[0]).T
        b = np.linalg.lstsq(edges, (points - self.corners[0]).T, rcond=None)[0].T - 1 / 3
        indices = [(i, j) for i in range(self.degree + 1) for j in range(self.degree + 1 - i)]
        return np.stack([b[:, 0] ** i * b[:, 1] ** j for i, j in indices], axis=1)


class AlphaOnCone:
    """`alpha` of every member along the cone through which a region is open, as rows at points of it.

    At the curve, where `g = f = 0`, the derivatives along rays have the same quotient: that of the clip's power is 0.
    Inside it, on a plate, g is the power times a polynomial: where that is negative the surface does not dip into the
    plate.
    """

    def __init__(self, basis: WorkingBasis, join: Join, scale: float, order: int) -> None:
        self.basis, self.scale, self.power = basis, scale, order + 1
        self.surface, self.clip = join.contact.surface, join.contact.clip
        self.ends = join.curve()[::CONE_EVERY]
        self.pieces = self._pieces(join, self.ends)
        middle = self.ends.mean(axis=0)
        shares = 0.4, 0.7  # of the way to the curve, where plates are looked at inside it besides the middle
        self.inner = np.concatenate([middle[None], *(middle + s * (self.ends - middle) for s in shares)])
        self.inner_pieces = self._pieces(join, self.inner)

    def _pieces(self, join: Join, points: Floats) -> Integers:
        return np.asarray(join.partition.piece_of[join.partition.locate(points, tolerance=np.inf)])

    def depths(self) -> Floats:
        """How deep inside the members points of a plate are, over the clip's power there and in the middle: (N, m)."""
        if self.surface.degree > 1:
            return np.empty((0, self.basis.size))
        clip = self.clip(self.inner)
        shares = (clip / clip[0]) ** self.power
        found = np.empty((len(self.inner), self.basis.size))
        for piece in np.unique(self.inner_pieces).tolist():
            here = self.inner_pieces == piece
            found[here] = -self.basis.values(piece, self.inner[here]) / shares[here, None]
        return found

    def rows(self) -> Floats:
        """Values of alpha of the members at points inside, on and beyond the curve: (N, m)."""
        found = [np.empty((0, self.basis.size))]
        for piece in np.unique(self.pieces).tolist():
            ends = self.ends[self.pieces == piece]
            slopes = (self.surface.gradient(ends) * ends).sum(axis=1)
            found.append(self.basis.radial(piece, ends) / slopes[:, None])
            for share in CONE_SHARES:
                found.append(self.basis.values(piece, share * ends) / self.surface(share * ends)[:, None])
        return self.scale * np.concatenate(found)


class SampledConstraints:
    """The guard rows of one solution space: points are local, values in the user's units."""

    def __init__(self, basis: WorkingBasis, placed: PlacedContacts) -> None:
        scale = to_float(placed.partition.frame.scale)
        self.basis, self.placed = basis, placed
        self.alphas: list[AlphaOnFace] = []
        self.cones: list[AlphaOnCone] = []
        measured: list[Floats] = []
        reaches = []
        for join in placed.joins:
            curves = join.measured_curves()
            points, weights = (np.concatenate(parts) for parts in zip(*curves, strict=True))
            gradient = join.contact.surface.gradient(points)
            sizes = np.linalg.norm(gradient, axis=1)
            mean = float(sizes @ weights / weights.sum())
            if join.opening:
                self.cones.append(AlphaOnCone(basis, join, mean / scale, placed.order))
            for face, (on_face, parts) in enumerate(curves if join.faces else ()):
                alpha = AlphaOnFace(basis, join, face, mean / scale)
                self.alphas.append(alpha)
                measured.append(np.append(parts @ alpha.rows(on_face), parts.sum()))
            reaches.append(float((np.abs((gradient * points).sum(axis=1)) / sizes).min()))
        total = np.sum(measured, axis=0)
        self.mean_alpha: Floats = total[:-1] / total[-1]
        """The mean of alpha over all contact curves, as a row (m,)."""
        self.local_reach = max(min(reaches), 1e-3)
        self.reach = self.local_reach * scale
        self.radius = float(np.linalg.norm(placed.local.points, axis=1).max())

    def initial(self, margins: Margins) -> Inequalities:
        """Rows on lattices of the walls and clip faces and at the centre."""
        edge_lattice = 8  # subdivisions of an edge of the walls and clip faces for the inequalities to begin with
        return self.edges(edge_lattice, margins) + self._depth(margins)

    @cached_property
    def edges(self) -> _lru_cache_wrapper[Inequalities]:
        """Rows on lattices of so many subdivisions of the walls and the clip faces; the last ones are kept."""
        return lru_cache(maxsize=8)(self._edges)

    def _edges(self, subdivisions: int, margins: Margins) -> Inequalities:
        rows, at_least = [np.empty((0, self.basis.size))], [np.empty(0)]
        for wall in self.placed.walls:
            points = self._lattice(self.placed.local.points[list(wall.vertices)], subdivisions)
            rows.append(self.basis.values(wall.piece, points))
            near = self.basis.scale * self._curves.query(points)[0]
            at_least.append(margins.wall * np.minimum(near, self.reach))
        for alpha in self.alphas:
            points = self._lattice(alpha.corners, subdivisions)
            rows.append(alpha.rows(points))
            at_least.append(np.full(len(points), margins.alpha))
        for cone in self.cones:
            rows.append(cone.rows())
            at_least.append(np.full(len(rows[-1]), margins.alpha))
            rows.append(cone.depths())
            at_least.append(np.full(len(rows[-1]), margins.wall * self.reach))
        return Inequalities(np.concatenate(rows), np.concatenate(at_least))

    @cached_property
    def _curves(self) -> cKDTree:
        """The contact curves, as points by which the distance to them is found."""
        return cKDTree(np.concatenate([join.curve() for join in self.placed.joins]))

    def _lattice(self, corners: Floats, subdivisions: int) -> Floats:
        """The points (N, 3) of a lattice on an outer face."""
        return lattice_weights(self.parts(corners, subdivisions)) @ corners

    def parts(self, corners: Floats, subdivisions: int) -> int:
        """Into how many parts the edges of an outer face are cut where so many are asked for."""
        if self.placed.local.center is None:
            return subdivisions
        units = corners / np.linalg.norm(corners, axis=1)[:, None]
        angle = float(np.arccos(np.clip(min(units[i] @ units[i - 1] for i in range(3)), -1, 1)))
        # Edges of outer faces seen from the centre under this angle, or a wider one, are cut into as many parts as are
        # asked for; others into as many as leave points as near to each other, seen from there.
        wide_angle = pi / 3
        return min(subdivisions, ceil(round(subdivisions * angle / wide_angle, 6)))

    def _depth(self, margins: Margins) -> Inequalities:
        """The rows at the centre, if there is one; all pieces have the same value there."""
        if self.placed.partition.center is None:
            return Inequalities.none(self.basis.size)
        # Members with alpha = 0 have any margin for the price of a scale, and where no others have, the solver fails
        # among huge multiples of them: f goes no deeper than so many radii of the region, where it mostly goes to one.
        depth, deepest = -self.basis.values(0, np.zeros((1, 3))), 10.0 * self.radius * self.reach / self.local_reach
        return Inequalities(np.concatenate([depth, -depth]), np.array([margins.depth * self.reach, -deepest]))


class RayLattice:
    """Rays from the centre to a lattice of the outer faces (none where the partition has no centre)."""

    def __init__(self, guard: SampledConstraints, subdivisions: int) -> None:
        self.guard, self.degree = guard, guard.basis.degree
        self.ends = dict(sorted(_ends(guard, subdivisions).items()))
        """Where they end, by the pieces in which they are: (N, 3)."""
        self._monomials = {piece: monomial_values(points, self.degree) for piece, points in self.ends.items()}
        degrees = [sum(e) for e in exponents(self.degree)]
        self._degrees = np.equal.outer(np.arange(self.degree + 1), degrees).astype(float)
        self._shares = np.arange(SAMPLES + 1) / SAMPLES

    def missed(self, member: Floats, margins: Margins, share: float) -> Inequalities:
        """The condition where a member takes the values 0 and +-band, to a step's second order, and rises by less than
        a share of what margins ask."""
        guard, found = self.guard, Inequalities.none(self.guard.basis.size)
        for piece, ends in self.ends.items():
            # coefficients of the member as a polynomial in the share of each ray of a piece: (n + 1, N)
            terms = self._degrees * (member @ guard.basis.coefficients[piece])
            profiles = np.asarray(terms @ self._monomials[piece])
            rays, shares, slopes = crossed(profiles, self._shares, margins.band * guard.reach)
            asked = margins.sheet * guard.reach * np.linalg.norm(ends, axis=1)[rays] / guard.radius
            flat = slopes < share * asked
            points = ends[rays[flat]] * shares[flat, None]
            found += Inequalities(guard.basis.radial(piece, points), (shares * asked)[flat])
        return found


def crossed(profiles: Floats, shares: Floats, band: float) -> tuple[Integers, Floats, Floats]:
    """Where polynomials, columns of `profiles` (n + 1, N), pass -band, 0 and band between shares (S,) that are evenly
    apart from 0 on, at most 65: columns, shares and slopes, (M,) each, by rising columns, shares and levels."""
    levels = 3  # values that are looked for, each of which a ray may pass once in a step: -band, 0 and band
    room = levels * (len(shares) - 1) * profiles.shape[1]
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
        ends.setdefault(face.piece, []).append(lattice_weights(parts)[sorted([*inner, *new])] @ corners)
    return {piece: np.concatenate(parts) for piece, parts in ends.items()}


@lru_cache(maxsize=16)
def _of_lattice(parts: int) -> tuple[list[int], list[tuple[int, Exponents]]]:
    """The numbers of a triangle's lattice points within it, and those on its edges with their indices."""
    indices = list(enumerate(homogeneous_exponents(parts, 3)))
    return [number for number, index in indices if min(index)], [(n, index) for n, index in indices if not min(index)]


@lru_cache(maxsize=64)
def lattice_weights(subdivisions: int) -> Floats:
    """Barycentric coordinates of the uniform lattice on a triangle (read-only)."""
    weights = np.array(homogeneous_exponents(subdivisions, 3)) / subdivisions
    weights.flags.writeable = False
    return weights


def lengths(rows: Floats) -> Floats:
    """Lengths of rows (N, m) by which they can be divided: (N,), 1 for those that are 0."""
    found = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    return np.where(found > 0, found, 1.0)
