"""Conforming subdivision of tetrahedral cells, down to small tetrahedra where the surface passes.

Each cell is cut by Freudenthal's triangulation of the lattice of its barycentric coordinates: each tetrahedron into
eight, level by level.  On faces this leaves the standard triangles, so neighbours fit.  A tetrahedron is dropped where
the B-coefficients on it have one sign: there is no zero in it, but for rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations
from math import factorial, prod

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import homogeneous_exponents
from pas.bernstein.subdivision import raised
from pas.limits import checkpoint
from pas.mesh.field import CellField, Floats, Integers

TINY = 1e-300
"""What stands for a value of 0 at a node."""

ROUNDING = 1e-13
"""Over the largest coefficient on a cell: below this a coefficient's sign is not known."""


LOOKS, LOOKED_AT = 5, 2000
"""Halvings of tetrahedra that may hide a component, and how many are looked at together."""


@dataclass(frozen=True)
class Lattice:
    """Nodes (N, 3) with values (N,), and the small tetrahedra (T, 4) the surface passes through."""

    points: Floats
    values: Floats
    tetrahedra: Integers


class Subdivision:
    """The tetrahedra that may hold zeros, as they are cut again and again."""

    def __init__(self, field: CellField) -> None:
        self.field, self.parts = field, 1
        cells = len(field.cells)
        self._nodes = np.zeros((cells, 4, len(field.vertices)), dtype=np.intp)
        self._nodes[np.arange(cells)[:, None], np.arange(4), field.cells] = 1
        self.forms = field.forms
        self._keep()

    def halve(self) -> None:
        """Cut each tetrahedron into eight."""
        checkpoint(f"refining the lattice ({len(self.forms)} tetrahedra)")
        corners, matrices = eighths(self.field.degree)
        self._nodes = np.einsum("ekj,tjv->tekv", corners, self._nodes).reshape(-1, 4, self._nodes.shape[2])
        self.forms = np.matmul(self.forms, matrices).transpose(1, 0, 2).reshape(-1, self.forms.shape[1])
        self.parts *= 2
        self._keep()

    def _keep(self) -> None:
        kept = (self.forms.min(axis=1) <= ROUNDING) & (self.forms.max(axis=1) >= -ROUNDING)
        self._nodes, self.forms = self._nodes[kept], self.forms[kept]

    def bent(self) -> tuple[Floats, bool]:
        """The middles (B, 3) of tetrahedra in which the function need not rise all along its mean gradient.

        Those first where that is smallest; and whether one away from all sign changes at nodes has another sign inside,
        so that a component hides there.
        """
        points = self._nodes @ self.field.vertices / self.parts
        bent, mean = self._turning(self.forms, points)
        rows = np.flatnonzero(bent)
        order = rows[np.argsort((mean[rows] ** 2).sum(axis=1), kind="stable")]
        ends = self.forms[:, self._ends]
        one = np.asarray((ends >= -ROUNDING).all(axis=1) | (ends <= ROUNDING).all(axis=1))
        numbers = _distinct(self._nodes.reshape(-1, self._nodes.shape[2]))[1].reshape(-1, 4)
        crossed = np.zeros(int(numbers.max(initial=0)) + 1, dtype=bool)
        crossed[numbers[~one]] = True
        alone = rows[one[rows] & ~crossed[numbers[rows]].any(axis=1)]
        return points[order].mean(axis=1), self._hides(self.forms[alone], points[alone])

    @property
    def _ends(self) -> list[int]:
        """Where the values at corners stand among B-coefficients."""
        degree = self.field.degree
        return [i for i, a in enumerate(homogeneous_exponents(degree, 4)) if max(a) == degree]

    def _turning(self, forms: Floats, points: Floats) -> tuple[NDArray[np.bool_], Floats]:
        """In which tetrahedra (T, 4, 3) the function need not rise along its mean gradient, and that (T, 3)."""
        rises, mean = risings(forms, points, self.field.degree)
        return np.einsum("tmx,tx->tm", rises, mean).min(axis=1) <= 0, mean

    def _hides(self, forms: Floats, points: Floats) -> bool:
        """Whether a tetrahedron with values of one sign at its corners has another sign on a finer lattice.

        Parts in which the function rises along one direction are not looked into: they hold no component.
        """
        cut, matrices = eighths(self.field.degree)
        forms = forms * np.where((forms[:, self._ends] >= -ROUNDING).all(axis=1), 1.0, -1.0)[:, None]
        for _ in range(LOOKS):
            if not len(forms) or len(forms) > LOOKED_AT:
                break
            forms = np.matmul(forms, matrices).transpose(1, 0, 2).reshape(-1, forms.shape[1])
            points = np.einsum("ekj,tjx->tekx", cut / 2, points).reshape(-1, 4, 3)
            if (forms[:, self._ends] < -ROUNDING).any():
                return True
            kept = forms.min(axis=1) <= ROUNDING
            forms, points = forms[kept], points[kept]
            bent = self._turning(forms, points)[0]
            forms, points = forms[bent], points[bent]
        return False

    @property
    def lattice(self) -> Lattice:
        """The tetrahedra across which the sign changes, with shared nodes."""
        flat = self._nodes.reshape(-1, self._nodes.shape[2])
        first, inverse = _distinct(flat)
        points = flat[first] @ self.field.vertices / self.parts
        values = self.field.values(points)
        values = np.where(values == 0, TINY, values)
        joined = inverse.reshape(-1, 4)
        negative = (values < 0)[joined]
        return Lattice(points, values, joined[negative.any(axis=1) & ~negative.all(axis=1)])


def _distinct(rows: Integers) -> tuple[Integers, Integers]:
    """Where the distinct ones of rows of whole numbers stand first, and which of these each row is."""
    weights = np.random.default_rng(0).integers(1 << 62, size=rows.shape[1]) | 1
    _, first, inverse = np.unique(rows @ weights, return_index=True, return_inverse=True)  # wraps around
    if not np.array_equal(rows[first][inverse], rows):  # two with one key
        _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, inverse.ravel()


def risings(forms: Floats, corners: Floats, degree: int) -> tuple[Floats, Floats]:
    """B-coefficients (T, m, 3) of gradients on tetrahedra (T, 4, 3), and their means (T, 3), up to positive factors."""
    up = raised(degree, 4)
    slopes = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    steps = forms[:, up[:, 1:]] - forms[:, up[:, :1]]
    gradients = steps @ slopes.transpose(0, 2, 1)
    return gradients, gradients.mean(axis=1)


@cache
def eighths(degree: int) -> tuple[Integers, Floats]:
    """The corners (8, 4, 4) of the eight parts in halves of barycentric coordinates, and matrices (8, m, m).

    B-coefficients, as a row, times a matrix are those on a part.
    """
    nodes, parts = _freudenthal(2)
    corners = nodes[parts]
    indices = homogeneous_exponents(degree, 4)
    lattice = np.array(indices) / degree
    back = np.linalg.inv(_bernstein(lattice, degree))
    matrices = [(back @ _bernstein(lattice @ (part / 2), degree)).T for part in corners]
    return corners, np.ascontiguousarray(matrices)


def _bernstein(points: Floats, degree: int) -> Floats:
    """The values (N, m) of the Bernstein polynomials at barycentric coordinates (N, 4)."""
    columns = [
        factorial(degree) / prod(map(factorial, a)) * np.prod(points ** np.array(a), axis=1)
        for a in homogeneous_exponents(degree, 4)
    ]
    return np.stack(columns, axis=1)


def _freudenthal(n: int) -> tuple[Integers, Integers]:
    """Barycentric indices (m, 4) of the lattice of a tetrahedron, and its n^3 tetrahedra (n^3, 4).

    In the coordinates n >= x1 >= x2 >= x3 >= 0 each unit cube is cut along its six monotone
    paths; those inside make up the tetrahedron.  Corners are listed along the path, so cutting a
    small tetrahedron again gives tetrahedra of the finer lattice.
    """
    x = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (x[:, 0] >= x[:, 1]) & (x[:, 1] >= x[:, 2])
    number = np.full(len(x), -1)
    number[inside] = np.arange(inside.sum())
    x = x[inside]
    bary = np.stack([n - x[:, 0], x[:, 0] - x[:, 1], x[:, 1] - x[:, 2], x[:, 2]], axis=1)
    stride = np.array([(n + 1) ** 2, n + 1, 1])
    corners = x[(x[:, 0] < n)]
    blocks = []
    for path in permutations(range(3)):
        steps = np.zeros((4, 3), dtype=int)
        for i, axis in enumerate(path):
            steps[i + 1] = steps[i]
            steps[i + 1, axis] += 1
        nodes = corners[:, None] + steps
        valid = (nodes[..., 0] >= nodes[..., 1]).all(1) & (nodes[..., 1] >= nodes[..., 2]).all(1)
        blocks.append(number[nodes[valid] @ stride])
    return bary, np.concatenate(blocks)
