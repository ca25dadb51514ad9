"""Functions of solids that are no polynomials: distances, and the set inside a piecewise algebraic surface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import ClassVar

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.arrays import Bools, Floats
from pas.partition.cells import Partition
from pas.piecewise import PiecewiseSurface
from pas.solid.taylor import TaylorForms
from pas.solid.tree import Atom, Function, Node, Tree, combined, complement, mapped, moved, parts_of, splits_of


@dataclass(frozen=True)
class Followed:
    """Faces, by name, of a set from which something is a distance, less a thickness; and names of all its faces."""

    tree: Tree
    faces: frozenset[str]
    all: frozenset[str]
    thickness: float

    def moved(self, map_: Affine) -> Followed:
        """The image under a similarity."""
        return replace(self, tree=moved(self.tree, map_), thickness=self.thickness * map_.similarity())


class Parametrized(ABC):
    """A surface whose points have two parameters: each within a row of `domain` (2, 2), or returning after one of
    `periods` (2,), which are 0 where it does not.  Where one of the first row's ends is reached there may be `caps`,
    halves of balls: centres, outward directions, and a radius, by end.
    """

    domain: Floats
    periods: Floats
    caps: tuple[tuple[Floats, Floats, float], ...] = ()

    @abstractmethod
    def places(self, points: Floats) -> Floats:
        """The parameters (N, 2) of its points next to points (N, 3) that are near it."""

    @abstractmethod
    def at(self, places: Floats) -> Floats:
        """Its points (N, 3) with parameters (N, 2)."""


class Distance(ABC):
    """A function whose values change by at most 1 per unit of length, such as a distance less a radius.

    `follows` are the faces of a set, if any, on which it is negative: it is a distance from them, less a thickness.
    `plane` is a point and the outward normal of the plane in which its zeros are, where they are in one.
    """

    follows: Followed | None = None
    plane: tuple[Floats, Floats] | None = None
    exponent: ClassVar[int] = 0

    @abstractmethod
    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3)."""

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in boxes: in the balls about them."""
        return self.decided_within(centers, np.sqrt((halves * halves).sum(axis=1)))

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in balls of given centres (N, 3) and radii (N,)."""
        value = self.jets(centers)[:, 0]
        return value + radii <= 0, value - radii > 0

    def slopes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) at the centres of boxes, and how much they differ at the corners (N, 3)."""
        gradients = self.jets(centers)[:, 1:]
        corners = np.stack([centers + halves * side for side in product((-1.0, 1.0), repeat=3)], axis=1)
        changes = self.jets(corners.reshape(-1, 3))[:, 1:].reshape(corners.shape) - gradients[:, None]
        return gradients, np.abs(changes).max(axis=1)

    def moved(self, map_: Affine) -> Distance:
        """The distance after a similarity; raises `ValueError` for other maps."""
        return Moved(self, map_, map_.similarity())


@dataclass(frozen=True, eq=False)
class Moved(Distance):
    """A distance after a similarity that changes lengths by a factor."""

    inner: Distance
    map: Affine
    factor: float

    @property
    def follows(self) -> Followed | None:  # type: ignore[override]
        return self.inner.follows and self.inner.follows.moved(self.map)

    def jets(self, points: Floats) -> Floats:
        jets = self.inner.jets(self.map.inverse.points(points))
        jets[:, 0] *= self.factor
        jets[:, 1:] = self.factor * jets[:, 1:] @ self.map.inverse.floats[0]
        return jets

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """The inner distance's answers for the balls before they were moved."""
        return self.inner.decided_within(self.map.inverse.points(centers), radii / self.factor)


def followed_by(tree: Tree) -> tuple[Tree, list[tuple[Distance, Followed]]] | None:
    """The set of which a tree is a shell, and the distances from its faces, and what they follow; or None.

    The rest of what it is an intersection of is then the union of these distances, less a thickness.
    """
    for wall, rest in splits_of(tree):
        parts = parts_of(wall, union=True)
        functions = [part.function for part in parts if isinstance(part, Atom) and not part.outside]
        found = [(f, f.follows) for f in functions if isinstance(f, Distance) and f.follows is not None]
        if len(found) == len(parts) and all(follows.tree == rest for _, follows in found):
            return rest, found
    return None


class Pieces:
    """One exact polynomial in each piece of a partition, with the same zeros where two pieces meet.

    Outside the partition's cells it has no meaning: a tree has it together with `region(partition)`.
    """

    def __init__(self, partition: Partition, polynomials: Sequence[Polynomial]) -> None:
        self.partition = partition
        self.polynomials = tuple(polynomials)
        self.surface = PiecewiseSurface.from_polynomials(partition, (), 0, self.polynomials)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pieces) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self.polynomials)

    @property
    def _content(self) -> tuple[object, ...]:
        return self.polynomials, self.partition.vertices, self.partition.cells, self.partition.pieces

    @property
    def cells(self) -> tuple[tuple[Polynomial, tuple[Polynomial, ...]], ...]:
        """Each cell's polynomial and the planes (`>= 0` in the cell) that bound it."""
        planes = [tuple(-p for p in self.partition.planes(i)) for i in range(len(self.partition.cells))]
        return tuple((self.polynomials[p], walls) for p, walls in zip(self.partition.piece_of, planes, strict=True))

    @property
    def exponent(self) -> int:
        return self.surface.scaled.exponent

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) of the scaled pieces at points (N, 3); outside all cells, of one that is near."""
        frame = self.partition.frame
        local = frame.local_points(points)
        jets = self.surface.evaluator.batch(0, 1)(local, self.partition.local.location.pieces(local.T, np.inf))
        return jets * np.array([1.0, *[1 / to_float(frame.scale)] * 3])

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, where boxes meet cells; > 0 where they meet none."""
        low, high = self.partition.points.min(axis=0), self.partition.points.max(axis=0)
        room = halves + (high - low) * 2.0**-20  # for rounding
        near = ((centers + room >= low) & (centers - room <= high)).all(axis=1)
        inside, outside = np.zeros(len(centers), dtype=bool), ~near
        local, half, touched = self._in_cells(centers[near], halves[near])
        yes, no = self._bank.taylor(local, half)
        of_cells = self.partition.piece_of
        inside[near], outside[near] = ((side[of_cells] | ~touched).all(axis=0) for side in (yes, no))
        inside[near] &= touched.any(axis=0)
        return inside, outside

    def slopes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """The middle (N, 3) of all gradients of the cells that boxes meet, and how far these are from it."""
        scale, (local, half, met) = to_float(self.partition.frame.scale), self._in_cells(centers, halves)
        touched = met[..., None]
        of_pieces = self._bank.slopes(np.arange(len(self._bank)), local, half)
        gradients, changes = (g[self.partition.piece_of] / scale for g in of_pieces)
        highest = np.where(touched, gradients + changes, -np.inf).max(axis=0)
        lowest = np.where(touched, gradients - changes, np.inf).min(axis=0)
        known = touched.any(axis=0)
        return np.where(known, (highest + lowest) / 2, 0.0), np.where(known, (highest - lowest) / 2, 0.0)

    def moved(self, map_: Affine) -> Pieces:
        """The image under an affine map, exact."""
        return Pieces(self.partition.moved(map_), [map_.polynomial(f) for f in self.polynomials])

    def _in_cells(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats, Bools]:
        """Boxes in local coordinates, by centres and half edges (N, 3), and which cells (C, N) they may meet."""
        partition = self.partition.local
        local, half = self.partition.frame.local_points(centers), halves / to_float(self.partition.frame.scale)
        slopes = partition.barycentric(np.eye(3)) - partition.barycentric(np.zeros((3, 3)))
        reach = np.einsum("cbx,nx->cbn", np.abs(slopes), half)
        return local, half, np.asarray((partition.barycentric(local) + reach >= -1e-9).all(axis=1))

    @cached_property
    def _bank(self) -> TaylorForms:
        return TaylorForms(self.surface.scaled.polynomials)


def by_cells(tree: Tree) -> Tree:
    """A set with the cells of its pieces in their place: their union, each as far as the inequality holds in it."""

    def opened(atom: Atom) -> Tree:
        if not isinstance(atom.function, Pieces):
            return atom
        cells = [
            combined(False, Atom(f, atom.face), *(Atom(wall, "", True) for wall in walls))
            for f, walls in atom.function.cells
        ]
        whole = combined(True, *cells)
        return complement(whole) if atom.outside else whole

    return mapped(tree, opened)


def polynomials_of(function: Function) -> tuple[Polynomial, ...]:
    """The polynomials that a function consists of: itself, those of its pieces, or none."""
    if isinstance(function, Polynomial):
        return (function,)
    return function.polynomials if isinstance(function, Pieces) else ()


def region(partition: Partition) -> Tree:
    """The points in the partition's cells; its walls are no faces."""
    planes = [[Atom(p, "") for p in partition.planes(i)] for i in range(len(partition.cells))]
    return Node(tuple(Node(tuple(walls), False) for walls in planes), True)
