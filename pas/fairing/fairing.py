"""Picking one member of a solution space: a quadratic programme, then exact rounding.

Minimise the energy (and the squared values at `near` points) over the space, subject to one
normalisation, the user's points and the guard rows.  The answer is rounded to rationals of
modest size; the exact equations among the constraints (`through` points, a value, a sum) are
then solved exactly for the coefficients that they determine best, so they hold exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from flint import fmpq_mat

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.products import Products
from pas.errors import InfeasibleError
from pas.fairing.basis import WorkingBasis, to_doubles
from pas.fairing.energy import Energy, as_energy
from pas.fairing.exchange import Exchange
from pas.fairing.fair import FairSearch
from pas.fairing.guard import LADDER, SLIMMEST, Guard, Margins, Rows
from pas.fairing.landscape import Landscape
from pas.fairing.programme import MemberProgramme
from pas.fairing.rays import Rays
from pas.fairing.settling import State
from pas.fairing.wishes import UnitCoefficients, Wishes
from pas.piecewise import PiecewiseSurface
from pas.surface.fairness_limits import FairnessLimits
from pas.surface.placed import PlacedContacts

_LAST: list[tuple[WorkingBasis, FairnessLimits, bytes, bool, Landscape]] = []
"""The last landscape with what it was asked for; no more, as its tables take tens of megabytes."""


@dataclass(frozen=True)
class Choice:
    """A member: its exact surface, its working coefficients, its energy, and the guard rows whose optimum it is
    with their margins.  `by` is the energy it was chosen by, where that is not the one that was wished for,
    `state` what is kept for the next step."""

    surface: PiecewiseSurface
    working: fmpq_mat
    energy: float
    rows: Rows
    margins: Margins | None = None
    by: Energy | None = None
    state: State | None = None


class Fairing:
    """The choice among the members of one solution space, for one energy.

    `source` holds the members' patches (m, C(n+3, 3)) in local coordinates, exact.
    """

    def __init__(self, placed: PlacedContacts, degree: int, source: Products, energy: Energy) -> None:
        self.placed, self.partition, self.degree, self.energy = placed, placed.partition, degree, energy
        if not placed.partition.cells:
            raise ValueError(
                "a choice by shape needs a region: give the cell a box, as in pas.SingleCell(lower, upper)"
            )
        self.basis = WorkingBasis.of(placed.partition, source, degree)

    def of(self, energy: Energy) -> Fairing:
        """The same for another energy, with the basis, guard rows and rays that there are."""
        other = copy(self)
        other.energy = energy
        vars(other).pop("quadratic_part", None)
        if not (self.energy.on_surface and energy.on_surface):  # else the way begins from the same form
            vars(other).pop("hessian", None)
        return other

    @cached_property
    def guard(self) -> Guard:
        """The guard rows of this space."""
        for number, join in enumerate(self.placed.joins, start=1):
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
        return Guard(self.basis, self.placed)

    @cached_property
    def rays(self) -> Callable[[int], Rays]:
        """The rays to the lattice of so many subdivisions on the outer faces; made once."""
        return lru_cache(maxsize=4)(lambda subdivisions: Rays(self.guard, subdivisions))

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
    def quadratic_part(self) -> Floats:
        """The matrix H of the part of the energy that is a quadratic form, in the user's units: `1/2 q^T H q`."""
        return self._checked(self.energy)

    @cached_property
    def hessian(self) -> Floats:
        """The quadratic form whose optimum is chosen, or from whose the way to a fair surface begins (m, m)."""
        return self._checked(as_energy(None)) if self.energy.on_surface else self.quadratic_part

    def _checked(self, energy: Energy) -> Floats:
        hessian, m = np.asarray(energy.hessian(self.basis)), self.basis.size
        if hessian.shape != (m, m) or not np.isfinite(hessian).all():
            raise ValueError(f"the energy {energy.kind!r} must give a finite matrix of shape {m, m}")
        return hessian

    def energy_of(self, working: fmpq_mat) -> float:
        """The energy of a member that is a quadratic form."""
        q = to_doubles(working)[0]
        return float(q @ self.quadratic_part @ q) / 2

    def surface(self, working: fmpq_mat) -> PiecewiseSurface:
        """The exact surface with given working coefficients (1, m)."""
        return PiecewiseSurface.in_place(self.placed, self.basis.combine(working), self.degree)

    def landscape(self, limits: FairnessLimits, start: Floats, live: bool = False) -> Landscape:
        """The energy of the surface over the members, as it is seen along rays laid for one of them: few, if `live`.

        The last one of the process is kept: the same rays serve another energy, such as another tension.
        """
        for basis, *asked, landscape in _LAST:
            if basis is self.basis and asked == [limits, start.tobytes(), live]:
                return landscape.seen_by(self.energy)
        landscape = Landscape(self.basis, self.placed, self.guard.mean_alpha, self.energy, limits, start, live)
        _LAST[:] = [(self.basis, limits, start.tobytes(), live, landscape)]
        return landscape

    def choose(self, wishes: Wishes, start: PiecewiseSurface | None = None, patient: bool = True) -> Choice:
        """The member that meets the wishes best, proved or guarded as they say.

        An energy of the surface is followed from the member `start`, of no higher degree, where that is given; without
        patience it raises `BeyondLimitsError` where the way ends beyond the limits of fairness.
        Raises `InfeasibleError`, naming an irreducible set of conflicting points where the
        conflict involves the user's, and `NotSolvedError` where the solvers failed.
        """
        if self.energy.on_surface:
            check_on_surface(wishes)
            self._check_possible(MemberProgramme(self, wishes))
            found = FairSearch(self, wishes, start, patient).choice()
            if found is not None:
                return found
            fallback = self.of(as_energy(None))
            return replace(fallback.choose(wishes.changed(energy=fallback.energy)), by=fallback.energy)
        if wishes.prove:
            return self._proved(wishes)
        return self._guarded(wishes) if wishes.guard else self.under(wishes, Rows.none(self.basis.size))

    def under(self, wishes: Wishes, rows: Rows, margins: Margins | None = None) -> Choice:
        """The optimum under the wishes and given guard rows, rounded."""
        programme = MemberProgramme(self, wishes)
        working = programme.rounded(programme.optimum(rows))
        return Choice(self.surface(working), working, self.energy_of(working), rows, margins)

    def chosen(self, programme: MemberProgramme, state: State, margins: Margins | None) -> Choice:
        """A member on the way down the landscape of an energy of the surface, rounded."""
        working = programme.rounded(state.member)
        energy = state.look.energy + self.energy_of(working)
        return Choice(self.surface(working), working, energy, state.rows, margins)

    def _proved(self, wishes: Wishes) -> Choice:
        """The first member on the ladder of margins that is proved."""
        programme = MemberProgramme(self, wishes)
        self._check_possible(programme)
        failure: InfeasibleError | None = None
        for margins in LADDER:
            try:
                for choice in self._candidates(programme, margins):
                    # without a centre no sheet can be proved: the certificate says so
                    if choice.surface.certificate.proved or self.partition.center is None:
                        return choice
            except InfeasibleError as error:
                failure = error
        raise failure or InfeasibleError(f"no member of degree {self.degree} that was found passed the proofs")

    def _check_possible(self, programme: MemberProgramme) -> None:
        """Raise `InfeasibleError` for conditions that cannot be met with any margins."""
        for rows in (Rows.none(self.basis.size), self.guard.initial(SLIMMEST)):  # what fails here fails on every rung
            if not programme.possible(rows):
                raise programme.conflict(rows)

    def _candidates(self, programme: MemberProgramme, margins: Margins) -> Iterator[Choice]:
        """Clean members at these margins, in the order in which to prove them."""
        for stage in Exchange(programme, self.guard, margins).stages():
            working = programme.rounded(stage.unknowns)
            yield Choice(self.surface(working), working, self.energy_of(working), stage.rows, margins)

    def _guarded(self, wishes: Wishes) -> Choice:
        """The optimum under the sampled guard rows alone, with the widest margins that can be.

        Without proofs to point to failures, the sheet condition is asked everywhere.
        """
        failure: InfeasibleError | None = None
        for margins in (m for m in LADDER if m.everywhere):
            try:
                return self.under(wishes, self.guard.initial(margins), margins)
            except InfeasibleError as error:
                failure = error
        raise failure or InfeasibleError(f"no member of degree {self.degree} was found")


def check_on_surface(wishes: Wishes) -> None:
    """Raise `ValueError` for wishes that an energy of the surface cannot serve."""
    if not wishes.guard:
        raise ValueError(
            "an energy of the surface needs guard=True: without guard rows there may be no sheet to look at; "
            "take a quadratic form, such as pas.ThinPlate()"
        )
    if isinstance(wishes.normalize, UnitCoefficients):
        raise ValueError(
            "normalize=pas.UnitCoefficients() needs an energy that is a quadratic form, such as pas.ThinPlate()"
        )
