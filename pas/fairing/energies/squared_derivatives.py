"""Energies that are integrals of squares of derivatives of one order, over a region or a box: thin plate, membrane.

`1/2 * integral of the sum of c_d (d f)^2` over derivatives d with counts c_d.  Twice to the matrix of
inner products: exactly, and in floating point by a Gauss rule of the right degree, which gives a
factor J with `H = J^T J` and so a positive semidefinite matrix whatever the rounding.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_mpoly

from pas.algebra.inputs import MOST_PIECES, shown, whole
from pas.algebra.rational import amount, plain, to_float
from pas.arrays import Floats
from pas.fairing.basis import Derivative, WorkingBasis
from pas.fairing.energy import Energy, Members
from pas.fairing.functionals import Box, box_products, box_rule, tetrahedron_products


@dataclass(frozen=True)
class SquaredDerivatives(Energy):
    """An integral of squares of derivatives over `domain`; the arguments are those of `pas.ThinPlate`."""

    derivatives: ClassVar[tuple[tuple[Derivative, int], ...]]
    """The derivatives, all of one order, and how often each counts."""

    domain: Box | None = None
    piece: int = 0
    weight: fmpq = fmpq(1)

    def __post_init__(self) -> None:
        object.__setattr__(self, "weight", amount(self.weight, "weight"))
        whole(self.piece, "piece", 0, MOST_PIECES - 1)
        if self.domain is not None and not isinstance(self.domain, Box):
            raise TypeError(f"domain must be a pas.Box or None, not {shown(self.domain)}")

    @property
    def order(self) -> int:
        """The order of the derivatives."""
        return len(self.derivatives[0][0])

    def hessian(self, basis: WorkingBasis) -> Floats:
        degree = 2 * max(basis.degree - self.order, 0)
        if self.domain is None:
            rules = basis.quadrature(degree)
        else:
            frame = basis.frame
            box = Box(frame.local_point(self.domain.lower), frame.local_point(self.domain.upper))
            rules = [(self.piece_of(len(basis.members)), *box_rule(box, degree))]
        factor = np.concatenate([basis.squares(*rule, self.derivatives) for rule in rules])
        return factor.T @ factor * (to_float(self.weight) * basis.scale ** (3 - 2 * self.order))

    def products(self, members: Members) -> fmpq_mat:
        if self.domain is None and not members.partition.cells:
            raise ValueError("an energy needs a region: give the energy a pas.Box, or the single cell one")
        total = fmpq_mat(len(members.basis), len(members.basis))
        for variables, times in self.derivatives:
            total += self._integrals(members, variables) * times
        return total * self.weight

    def piece_of(self, pieces: int) -> int:
        """The number of the piece whose patch counts, of so many; raises `ValueError` where there is none such."""
        return whole(self.piece, "piece", 0, pieces - 1, "the pieces of the partition, from 0")

    def _integrals(self, members: Members, variables: Derivative) -> fmpq_mat:
        """The integrals of products of a derivative of the members."""
        partition = members.partition
        if self.domain is not None:
            piece = self.piece_of(len(partition.pieces))
            return box_products([_derived(m[piece].raw, variables) for m in members.basis], self.domain)
        derived = [[_derived(patch.raw, variables) for patch in member] for member in members.basis]
        total = fmpq_mat(len(derived), len(derived))
        for cell, piece in zip(partition.cells, partition.piece_of, strict=True):
            functions = [member[piece] for member in derived]
            total += tetrahedron_products(functions, partition.corners(cell), max(members.degree - self.order, 0))
        return total

    def to_record(self) -> dict[str, Any]:
        record: dict[str, Any] = {"kind": self.kind, "weight": plain(self.weight)}
        if self.domain is None:
            return record
        ends = {"lower": self.domain.lower, "upper": self.domain.upper}
        return record | {"piece": self.piece} | {name: [plain(c) for c in end] for name, end in ends.items()}

    @classmethod
    def keys(cls) -> Mapping[str, bool]:
        return dict.fromkeys(("weight", "piece", "lower", "upper"), False)

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Self:
        if ("lower" in record) != ("upper" in record):
            raise ValueError("a box needs both lower and upper")
        domain = Box(record["lower"], record["upper"]) if "lower" in record else None
        return cls(domain, record.get("piece", 0), record.get("weight", 1))


class ThinPlate(SquaredDerivatives):
    """Thin-plate energy, `1/2 * integral of |Hess f|_F^2` over `domain`: that of a plate that bends with f.

    Without a domain, of every patch over its own piece.  With a `Box`, of the patch of piece number
    `piece` (from 0) over that box, as some of the literature has it.
    `weight` multiplies it: 0 leaves the choice to points and their least squares.
    """

    kind: ClassVar[str] = "thin-plate"
    derivatives: ClassVar[tuple[tuple[Derivative, int], ...]] = (
        ((0, 0), 1), ((1, 1), 1), ((2, 2), 1), ((0, 1), 2), ((0, 2), 2), ((1, 2), 2),
    )  # fmt: skip


class Membrane(SquaredDerivatives):
    """Membrane energy, `1/2 * integral of |grad f|^2` over `domain`: that of a membrane that is stretched with f.

    The arguments are those of `pas.ThinPlate`.
    """

    kind: ClassVar[str] = "membrane"
    derivatives: ClassVar[tuple[tuple[Derivative, int], ...]] = (((0,), 1), ((1,), 1), ((2,), 1))


def _derived(patch: fmpq_mpoly, variables: Derivative) -> fmpq_mpoly:
    for variable in variables:
        patch = patch.derivative(variable)
    return patch
