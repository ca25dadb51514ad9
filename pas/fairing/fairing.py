"""Picking one member of a solution space: a quadratic programme, then exact rounding.

Minimise the energy (and the squared values at `near` points) over the space, subject to one
normalisation, the user's points and the guard rows.  The answer is rounded to rationals of
modest size; the exact equations among the constraints (`through` points, a value, a sum) are
then solved exactly for the coefficients that they determine best, so they hold exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq_mat

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float
from pas.errors import InfeasibleError
from pas.fairing.basis import WorkingBasis, to_doubles
from pas.fairing.constraints import Constraints
from pas.fairing.energy import Box, ThinPlate
from pas.fairing.exchange import Exchange
from pas.fairing.guard import LADDER, SLIMMEST, Guard, Margins, Rows
from pas.fairing.problem import Problem
from pas.partition.cells import Partition
from pas.surface.contact import Contact
from pas.surface.piecewise import PiecewiseSurface


@dataclass(frozen=True)
class Choice:
    """A member: its exact surface, its working coefficients, and the guard rows whose optimum it is with
    their margins."""

    surface: PiecewiseSurface
    working: fmpq_mat
    rows: Rows
    margins: Margins | None = None


class Fairing:
    """The choice among the members of one solution space, for one energy.

    `patches[p]` (m, C(n+3, 3)) are the members' patches in local coordinates, exact.
    """

    def __init__(
        self,
        partition: Partition,
        contacts: Sequence[Contact],
        order: int,
        degree: int,
        patches: Sequence[fmpq_mat],
        energy: ThinPlate,
    ) -> None:
        self.partition, self.contacts, self.order, self.degree = partition, tuple(contacts), order, degree
        self.energy = energy
        if not partition.cells:
            raise ValueError(
                "a choice by shape needs a region: give the cell a box, as in pas.SingleCell(lower, upper)"
            )
        self.basis = WorkingBasis.of(partition.local, patches, degree)

    @cached_property
    def guard(self) -> Guard:
        """The guard rows of this space."""
        zero = [Polynomial(0)] * len(self.partition.pieces)
        empty = PiecewiseSurface(self.partition, self.contacts, self.order, zero, self.degree)
        for number, join in enumerate(empty.joins, start=1):
            if not join.confined:
                what = (
                    f"the clip of contact {number} passes through the region"
                    if join.faces
                    else f"no side of the region lies in the clip plane of contact {number}"
                )
                raise ValueError(
                    f"{what}, so the surface can be neither guarded nor proved there: fit with prove=False, "
                    "guard=False and another normalisation than pas.MeanAlpha(), or give the region such a side"
                )
        return Guard(self.basis, empty)

    @cached_property
    def coefficient_gram(self) -> Floats:
        """The squared Euclidean length of the polynomials' coefficients (user's coordinates, all
        pieces) as a quadratic form in the working basis, (m, m)."""
        total = np.zeros((self.basis.size, self.basis.size))
        for patch in self.basis.patches:
            members = [self.partition.frame.globalise(Polynomial.from_row(row, self.degree)) for row in patch.tolist()]
            dense = np.array([member.dense(self.degree) for member in members])
            total += dense @ dense.T
        return total

    @cached_property
    def hessian(self) -> Floats:
        """The energy matrix H in the working basis, in the user's units: `1/2 q^T H q`."""
        if self.energy.domain is None:
            factor = self.basis.cell_energy
        else:
            frame = self.partition.frame
            box = Box(frame.local_point(self.energy.domain.lower), frame.local_point(self.energy.domain.upper))
            factor = self.basis.box_energy(self.energy.piece_of(len(self.partition.pieces)), box)
        return factor.T @ factor * (to_float(self.energy.weight) / to_float(self.partition.frame.scale))

    def energy_of(self, working: fmpq_mat) -> float:
        """The energy of a member."""
        q = to_doubles(working)[0]
        return float(q @ self.hessian @ q) / 2

    def surface(self, working: fmpq_mat) -> PiecewiseSurface:
        """The exact surface with given working coefficients (1, m)."""
        patches = [Polynomial.from_row(entries, self.degree) for entries in self.basis.combine(working)]
        return PiecewiseSurface(self.partition, self.contacts, self.order, patches, self.degree)

    def choose(self, constraints: Constraints, rows: Rows) -> fmpq_mat:
        """The optimal member under the constraints and guard rows, rounded: (1, m), exact.

        Raises `InfeasibleError`, naming an irreducible set of conflicting points where the
        conflict involves the user's, and `NotSolvedError` where the solvers failed.
        """
        problem = Problem(self, constraints)
        return problem.rounded(problem.optimum(rows))

    def choose_proved(self, constraints: Constraints) -> Choice:
        """The first member on the ladder of margins that is proved.

        Raises `InfeasibleError` where there is none.
        """
        problem = Problem(self, constraints)
        for rows in (Rows.none(self.basis.size), self.guard.initial(SLIMMEST)):  # what fails here fails on every rung
            if not problem.possible(rows):
                raise problem.conflict(rows)
        failure: InfeasibleError | None = None
        for margins in LADDER:
            try:
                for stage in Exchange(problem, self.guard, margins).stages():
                    working = problem.rounded(stage.unknowns)
                    surface = self.surface(working)
                    # without a centre no sheet can be proved: the certificate says so
                    if surface.certificate.proved or self.partition.center is None:
                        return Choice(surface, working, stage.rows, margins)
            except InfeasibleError as error:
                failure = error
        raise failure or InfeasibleError(f"no member of degree {self.degree} that was found passed the proofs")

    def choose_guarded(self, constraints: Constraints) -> Choice:
        """The optimum under the sampled guard rows alone, with the widest margins that can be.

        Without proofs to point to failures, the sheet condition is asked everywhere.
        """
        for margins in (m for m in LADDER if m.everywhere):
            rows = self.guard.initial(margins)
            try:
                working = self.choose(constraints, rows)
            except InfeasibleError as error:
                failure = error
                continue
            return Choice(self.surface(working), working, rows, margins)
        raise failure

    def choose_plain(self, constraints: Constraints) -> Choice:
        """The optimum under the user's constraints alone."""
        rows = Rows.none(self.basis.size)
        working = self.choose(constraints, rows)
        return Choice(self.surface(working), working, rows)
