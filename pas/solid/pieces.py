"""Piecewise polynomials as functions of solids: the set inside a piecewise algebraic surface."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.partition.cells import Partition
from pas.piecewise import PiecewiseSurface
from pas.solid.bank import Bank
from pas.solid.tree import Atom, Bools, Function, Node, Tree


class Pieces:
    """One exact polynomial in each piece of a partition, with the same zeros where two pieces meet.

    Outside the partition's cells it has no meaning: a tree has it together with `region(partition)`.
    """

    def __init__(self, partition: Partition, polynomials: Sequence[Polynomial]) -> None:
        self.partition = partition
        self.polynomials = tuple(polynomials)
        self.surface = PiecewiseSurface.from_polynomials(partition, (), 0, self.polynomials)

    @property
    def cells(self) -> tuple[tuple[Polynomial, tuple[Polynomial, ...]], ...]:
        """Each cell's polynomial and the planes (`>= 0` in the cell) that bound it."""
        planes = [tuple(-p for p in self.partition.planes(i)) for i in range(len(self.partition.cells))]
        return tuple((self.polynomials[p], walls) for p, walls in zip(self.partition.piece_of, planes, strict=True))

    @property
    def exponent(self) -> int:
        """Of the power of two that the pieces are scaled by."""
        return self.surface.scaled.exponent

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) of the scaled pieces at points (N, 3); outside all cells, of one that is near."""
        frame = self.partition.frame
        local = frame.local_points(points)
        jets = self.surface.local_jets(local, self.partition.local.location.pieces(local.T, np.inf))
        return jets * np.array([1.0, *[1 / to_float(frame.scale)] * 3])

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, where boxes meet cells; > 0 where they meet none."""
        scale = to_float(self.partition.frame.scale)
        local, half = self.partition.frame.local_points(centers), halves / scale
        touched = self._touched(local, half)
        yes, no = self._bank.taylor(local, half)
        of_cells = self.partition.piece_of
        inside, outside = (np.asarray((side[of_cells] | ~touched).all(axis=0)) for side in (yes, no))
        return inside & np.asarray(touched.any(axis=0)), outside

    def slopes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """The middle (N, 3) of all gradients of the cells that boxes meet, and how far these are from it."""
        scale = to_float(self.partition.frame.scale)
        local, half = self.partition.frame.local_points(centers), halves / scale
        touched = self._touched(local, half)[..., None]
        of_pieces = self._bank.slopes(np.arange(len(self._bank)), local, half)
        gradients, changes = (g[self.partition.piece_of] / scale for g in of_pieces)
        highest = np.where(touched, gradients + changes, -np.inf).max(axis=0)
        lowest = np.where(touched, gradients - changes, np.inf).min(axis=0)
        met = touched.any(axis=0)
        return np.where(met, (highest + lowest) / 2, 0.0), np.where(met, (highest - lowest) / 2, 0.0)

    def moved(self, map_: Affine) -> Pieces:
        """The image under an affine map, exact."""
        return Pieces(self.partition.moved(map_), [map_.polynomial(f) for f in self.polynomials])

    def _touched(self, local: Floats, half: Floats) -> Bools:
        """Which cells (C, N) boxes in local coordinates may meet."""
        partition = self.partition.local
        slopes = partition.barycentric(np.eye(3)) - partition.barycentric(np.zeros((3, 3)))
        reach = np.einsum("cbx,nx->cbn", np.abs(slopes), half)
        return np.asarray((partition.barycentric(local) + reach >= -1e-9).all(axis=1))

    @cached_property
    def _bank(self) -> Bank:
        return Bank(self.surface.scaled.polynomials)


def polynomials_of(function: Function) -> tuple[Polynomial, ...]:
    """The polynomials that a function consists of: itself, those of its pieces, or none."""
    if isinstance(function, Polynomial):
        return (function,)
    return function.polynomials if isinstance(function, Pieces) else ()


def region(partition: Partition) -> Tree:
    """The points in the partition's cells; its walls are no faces."""
    planes = [[Atom(p, "") for p in partition.planes(i)] for i in range(len(partition.cells))]
    return Node(tuple(Node(tuple(walls), False) for walls in planes), True)
