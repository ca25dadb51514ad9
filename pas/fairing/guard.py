"""Guard rows: sampled inequalities that make the proofs likely to pass, and cuts from failures.

They ask at sample points, with a margin, for what the proofs ask everywhere: `f > 0` on the
outer walls, `alpha > 0` on the clip faces and `grad f . u > 0` for the one-sheet condition.
Where a proof fails, its failing points become further rows: an exchange method for a
semi-infinite programme (Hettich and Kortanek 1993).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.algebra.rational import to_float
from pas.fairing.basis import WorkingBasis
from pas.surface.joins import Join
from pas.surface.piecewise import PiecewiseSurface
from pas.surface.proofs import Violations

SHEET_LATTICE, WALL_LATTICE, FACE_LATTICE = 5, 8, 10
"""Subdivisions of an edge for the first sample points; a denser start spares no exchange round."""

CUTS_PER_CELL = 40
"""Failing points taken from one cell or face in a round; the worst ones first."""


@dataclass(frozen=True)
class Margins:
    """How clearly the inequalities shall hold.

    `sheet`: `grad f . (x - O) >= sheet * r * |x - O| / R` and `wall`: `f >= wall * r`, with r the
    smallest distance of a contact's tangent planes from the centre O (a pipe's radius), R the
    radius of the region and f of unit mean gradient on the contact curves; `alpha >= alpha` with mean 1.
    `everywhere` asks the sheet condition at lattice points of all cells, not only where a proof
    failed.
    """

    sheet: float
    wall: float
    alpha: float
    everywhere: bool


LADDER = (
    Margins(sheet=0.1, wall=0.03, alpha=0.05, everywhere=False),
    Margins(sheet=0.01, wall=0.003, alpha=0.005, everywhere=False),
    Margins(sheet=0.1, wall=0.03, alpha=0.05, everywhere=True),
    Margins(sheet=0.01, wall=0.003, alpha=0.005, everywhere=True),
)
"""Tried in turn.  Asking the sheet condition only where it failed leaves the shape its freedom: the
energy of the unequal GC^2 corner at degree 5 is 106, and 4923 with the condition everywhere.  Slim
margins exist in lower degrees; the condition everywhere is safer where the exchange wanders."""


@dataclass(frozen=True)
class Rows:
    """Inequalities `rows @ q >= at_least` on the working coefficients, (N, m) and (N,)."""

    rows: Floats
    at_least: Floats

    def __add__(self, other: Rows) -> Rows:
        return Rows(np.concatenate([self.rows, other.rows]), np.concatenate([self.at_least, other.at_least]))

    def violated_by(self, unknowns: Floats) -> bool:
        """Whether a member misses one of them by more than a solver's tolerance."""
        slack = self.rows @ unknowns - self.at_least
        return bool((slack < -1e-6 * np.linalg.norm(self.rows, axis=1) * np.linalg.norm(unknowns)).any())

    @classmethod
    def none(cls, unknowns: int) -> Rows:
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
        nodes = _lattice_weights(2 * basis.degree, 3) @ self.corners
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


class Guard:
    """The guard rows of one solution space: points are local, values in the user's units."""

    def __init__(self, basis: WorkingBasis, surface: PiecewiseSurface) -> None:
        scale = to_float(surface.partition.frame.scale)
        self.basis, self.surface = basis, surface
        self.curves = [join.curve() for join in surface.joins]
        self.alphas = [
            AlphaOnFace(basis, join, face, float(_lengths(join.contact.surface.gradient(curve)).mean()) / scale)
            for join, curve in zip(surface.joins, self.curves, strict=True)
            for face in range(len(join.faces))
        ]
        self.clip_faces = [number for number, join in enumerate(surface.joins) for _ in join.faces]
        self.local_reach = min(self._reach(j, c) for j, c in zip(surface.joins, self.curves, strict=True))
        self.reach = self.local_reach * scale
        self.radius = float(_lengths(surface.local.points).max())

    def mean_alpha(self) -> Floats:
        """The mean of alpha over all contact curves, as a row (m,)."""
        rows = []
        for number, curve in enumerate(self.curves):
            for face, alpha in zip(self.clip_faces, self.alphas, strict=True):
                if face == number:
                    rows.append(alpha.rows(_on_triangle(curve, alpha.corners)))
        return np.concatenate(rows).mean(axis=0)

    def initial(self, margins: Margins) -> Rows:
        """Rows on lattices of the walls, the clip faces and the cells."""
        rows = Rows.none(self.basis.size)
        local = self.surface.local
        for wall in self.surface.walls:
            points = _lattice_weights(WALL_LATTICE, 3) @ local.points[list(wall.vertices)]
            rows += self._walls(wall.piece, points, margins)
        for alpha in self.alphas:
            points = _lattice_weights(FACE_LATTICE, 3) @ alpha.corners
            rows += self._alpha(alpha, points, margins)
        if margins.everywhere:
            for number, cell in enumerate(local.cells):
                points = _lattice_weights(SHEET_LATTICE, 4) @ local.points[list(cell)]
                points = points[_lengths(points) > self.local_reach / 2]
                rows += self._sheet(int(local.piece_of[number]), points, margins)
        return rows

    def cuts(self, violations: Violations, margins: Margins, unknowns: Floats) -> Rows:
        """Rows at the points where a proof of the member `unknowns` failed, the worst ones."""
        rows = Rows.none(self.basis.size)
        for piece, points in violations.sheet:
            rows += _worst(self._sheet(piece, points, margins), unknowns)
        for piece, points in violations.walls:
            rows += _worst(self._walls(piece, points, margins), unknowns)
        for number, points in violations.contacts:
            for face, alpha in zip(self.clip_faces, self.alphas, strict=True):
                if face == number:
                    rows += _worst(self._alpha(alpha, _on_triangle(points, alpha.corners), margins), unknowns)
        return rows

    def _sheet(self, piece: int, points: Floats, margins: Margins) -> Rows:
        at_least = margins.sheet * self.reach * _lengths(points) / self.radius
        return Rows(self.basis.radial(piece, points), at_least)

    def _walls(self, piece: int, points: Floats, margins: Margins) -> Rows:
        return Rows(self.basis.values(piece, points), np.full(len(points), margins.wall * self.reach))

    def _alpha(self, alpha: AlphaOnFace, points: Floats, margins: Margins) -> Rows:
        return Rows(alpha.rows(points), np.full(len(points), margins.alpha))

    @staticmethod
    def _reach(join: Join, curve: Floats) -> float:
        """The smallest distance from the centre of a contact's tangent planes on its curve."""
        gradient = join.contact.surface.gradient(curve)
        distance = np.abs((gradient * curve).sum(axis=1)) / _lengths(gradient)
        return float(max(distance.min(), 1e-3))


def _worst(rows: Rows, unknowns: Floats) -> Rows:
    """The rows that the member violates most, and an even sample of the others."""
    if len(rows.rows) <= CUTS_PER_CELL:
        return rows
    order = np.argsort(rows.rows @ unknowns - rows.at_least)
    half = CUTS_PER_CELL // 2
    others = np.linspace(half, len(order) - 1, CUTS_PER_CELL - half).astype(int)
    chosen = order[np.concatenate([np.arange(half), others])]
    return Rows(rows.rows[chosen], rows.at_least[chosen])


def _lattice_weights(subdivisions: int, vertices: int) -> Floats:
    return np.array(homogeneous_exponents(subdivisions, vertices)) / subdivisions


def _on_triangle(points: Floats, corners: Floats) -> Floats:
    """Those of `points` that lie in a triangle, up to rounding."""
    edges, offsets = (corners[1:] - corners[0]).T, (points - corners[0]).T
    b = np.linalg.lstsq(edges, offsets, rcond=None)[0]
    coplanar = np.abs(edges @ b - offsets).max(axis=0, initial=0.0) <= 1e-9
    inside = (b.min(axis=0, initial=0.0) >= -1e-9) & (b.sum(axis=0) <= 1 + 1e-9)
    return points[inside & coplanar]


def _lengths(vectors: Floats) -> Floats:
    return np.sqrt((vectors * vectors).sum(axis=-1))
