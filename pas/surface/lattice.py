"""Conforming subdivision of tetrahedral cells, down to small tetrahedra where the surface passes.

Each cell is cut by Freudenthal's triangulation of the lattice of its barycentric coordinates: each tetrahedron into
eight, level by level.  On faces this leaves the standard triangles, so neighbours fit.  A tetrahedron is dropped where
the B-coefficients on it have one sign: there is no zero in it, but for rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations

import numpy as np

from pas.algebra.monomials import homogeneous_exponents
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.search import Cells, Fate, Fates, Limits, search
from pas.bernstein.simplices import Means, means, raised
from pas.limits import blocks, checkpoint
from pas.mesh.rows import any_of
from pas.mesh.topology import MOST, first_with
from pas.surface.local_field import LocalField
from pas.verdicts import Status

TINY = 1e-300
"""The number that replaces a value of 0 at a node."""

ROUNDING = 1e-13
"""Over the largest coefficient on a cell: below this a coefficient's sign is not known."""


AT_ONCE = 2048
"""Tetrahedra that are cut together, so that their coefficients stay in a processor's cache."""

LOOKS = Limits(depth=5, cells=2000)
"""Of tetrahedra that may hide a component: how often they are halved, and how many are looked at together."""


@dataclass(frozen=True)
class _Tetrahedra(Cells):
    """Tetrahedra by their forms (T, m) and corners (T, 4, 3)."""

    forms: Floats
    points: Floats


class Subdivision:
    """The tetrahedra that may hold zeros, as they are cut again and again.

    Of their corners `points` (T, 4, 3) are the places, `keys` (T, 4) numbers that are linear in barycentric coordinates
    and wrap around: distinct ones stand for distinct places.
    """

    def __init__(self, field: LocalField) -> None:
        self.field, self.parts = field, 1
        kept = _kept(field.forms)
        cells, self.forms = field.cells[kept], field.forms[kept]
        weights = np.random.default_rng(0).integers(1 << 62, size=len(field.vertices)) | 1
        self.keys, self.points = weights[cells], field.vertices[cells]

    def halve(self) -> None:
        """Subdivide each tetrahedron into eight."""
        checkpoint(f"refining the lattice ({len(self.forms)} tetrahedra)")
        self.keys, self.points, self.forms = _cut(self.field.degree, self.keys, self.points, self.forms)
        self.parts *= 2

    def bent(self) -> tuple[Floats, bool]:
        """The middles (B, 3) of tetrahedra in which the function need not rise all along its mean gradient.

        Those first where that is smallest; and whether one away from all sign changes at nodes has another sign inside,
        so that a component hides there.
        """
        bent, mean = _turning(self.field.degree, self.forms, self.points)
        rows = np.flatnonzero(bent)
        order = rows[np.argsort((mean[rows] ** 2).sum(axis=1), kind="stable")]
        alone = rows[self._of_one_sign(rows)]
        if len(alone):
            crossed = ~self._of_one_sign(slice(None))
            near = np.isin(self.keys[alone], self.keys[crossed]).any(axis=1)
            alone = alone[~near]
        return self.points[order].mean(axis=1), self._hides(self.forms[alone], self.points[alone])

    def _of_one_sign(self, rows: Integers | slice) -> Bools:
        """Which of some tetrahedra have values of one sign at their corners."""
        ends = self.forms[rows][:, self._ends]
        return np.asarray((ends >= -ROUNDING).all(axis=1) | (ends <= ROUNDING).all(axis=1))

    @property
    def _ends(self) -> list[int]:
        """Where the values at corners stand among B-coefficients."""
        degree = self.field.degree
        return [i for i, a in enumerate(homogeneous_exponents(degree, 4)) if max(a) == degree]

    def _hides(self, forms: Floats, points: Floats) -> bool:
        """Whether a tetrahedron with values of one sign at its corners has another sign on a finer lattice.

        Parts in which the function rises along one direction are not looked into: they hold no component.
        """
        ends, degree = self._ends, self.field.degree

        def judge(cells: _Tetrahedra, _: int) -> Fates:
            settled = (cells.forms.min(axis=1) > ROUNDING) | ~_turning(degree, cells.forms, cells.points)[0]
            fates = np.where(settled, Fate.SETTLED, Fate.SPLIT)
            fates[(cells.forms[:, ends] < -ROUNDING).any(axis=1)] = Fate.REFUTE
            return fates

        def split(cells: _Tetrahedra) -> _Tetrahedra:
            _, points, forms = _cut(degree, np.zeros((len(cells), 4), dtype=np.intp), cells.points, cells.forms)
            return _Tetrahedra(forms, points)

        forms = forms * np.where((forms[:, ends] >= -ROUNDING).all(axis=1), 1.0, -1.0)[:, None]
        found = search(_Tetrahedra(forms, points), judge, split, LOOKS, "looking for hidden components")
        return found.status is Status.REFUTED

    @property
    def lattice(self) -> tuple[Floats, Floats, Integers]:
        """Nodes (N, 3) with values (N,), and the tetrahedra (T, 4) across which the sign changes."""
        corners = self.points.reshape(-1, 3)
        first, joined = first_with(self.keys.ravel() & MOST, corners)
        points = corners[first]
        values = self.field.values(points)
        values = np.where(values == 0, TINY, values)
        joined = joined.reshape(-1, 4)
        negative = (values < 0)[joined]
        return points, values, joined[any_of(negative) & any_of(~negative)]


def _kept(forms: Floats) -> Bools:
    """Which tetrahedra may hold zeros."""
    return np.asarray((forms.min(axis=-1) <= ROUNDING) & (forms.max(axis=-1) >= -ROUNDING))


def _cut(degree: int, keys: Integers, points: Floats, forms: Floats) -> tuple[Integers, Floats, Floats]:
    """The eighths that may hold zeros of tetrahedra with keys (T, 4), corners (T, 4, 3) and forms (T, m)."""
    corners, parts = eighths(degree)
    found = []
    for some in blocks(len(forms), AT_ONCE):
        of_parts = parts(forms[some]).transpose(1, 0, 2)
        kept = np.nonzero(_kept(of_parts))
        own, ends = kept[0] + some.start, corners[kept[1]]
        with np.errstate(over="ignore"):  # keys wrap around
            found.append(((ends @ keys[own, :, None])[:, :, 0], ends / 2 @ points[own], of_parts[kept]))
    new_keys, new_points, new_forms = (np.concatenate(rows) for rows in zip(*found, strict=True))
    return new_keys, new_points, new_forms


def _turning(degree: int, forms: Floats, points: Floats) -> tuple[Bools, Floats]:
    """In which tetrahedra (T, 4, 3) the function need not rise along its mean gradient, and that (T, 3)."""
    mean, least, size = risings(forms, points, degree)
    return least <= ROUNDING * size, mean


def risings(forms: Floats, corners: Floats, degree: int) -> tuple[Floats, Floats, Floats]:
    """Of functions on tetrahedra (T, 4, 3) the mean (T, 3) of the gradient's B-coefficients, up to a positive factor,
    their least product with that (T,), and the largest of their squared sizes (T,)."""
    up = raised(degree, 4)
    a, b, c = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 0)
    across = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    across /= (a * across[:, 0]).sum(axis=1)[:, None, None]
    steps = forms[:, up[:, 1:]] - forms[:, up[:, :1]]
    x, y, z = (sum(steps[:, :, k] * across[:, k, i, None] for k in range(3)) for i in range(3))
    mean = np.stack([x.mean(axis=1), y.mean(axis=1), z.mean(axis=1)], axis=1)
    along = x * mean[:, :1] + y * mean[:, 1:2] + z * mean[:, 2:]
    return mean, along.min(axis=1), (x * x + y * y + z * z).max(axis=1)


@cache
def eighths(degree: int) -> tuple[Integers, Means]:
    """The corners (8, 4, 4) of the eight parts in halves of barycentric coordinates, and the forms on them."""
    # in the coordinates 2 >= x >= y >= z >= 0 each unit cube is cut along its six monotone paths, along which corners
    # are listed, so that cutting a small tetrahedron again gives tetrahedra of the finer lattice
    paths = np.array([np.cumsum([np.zeros(3), *np.eye(3)[list(path)]], axis=0) for path in permutations(range(3))])
    nodes = (paths[:, None] + np.indices((2, 2, 2)).reshape(3, -1).T[:, None]).astype(np.intp).reshape(-1, 4, 3)
    x, y, z = nodes[(np.diff(nodes, axis=2) <= 0).all(axis=(1, 2))].transpose(2, 0, 1)
    corners = np.stack([2 - x, x - y, y - z, z], axis=-1)
    return corners, means(degree, [[tuple(node) for node in part] for part in corners.tolist()])
