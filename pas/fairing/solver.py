"""The fit of one member: a semi-infinite programme, solved by Gauss-Newton steps with constraint generation.

    minimise    Phi(q) = |r(q)|^2 + 40 |(c(q) - l)+|^2 + 1/2 q'Hq
    subject to  a q = 1,  E q = e,  P q >= p                       normalisation, exact equations, points
                W q >= t w                                         walls, clip faces, centre, on lattices
                d/ds f(s u) >= t m |s u|  where f(s u) = -b, 0, b  one sheet, along all rays u from the centre

r are the residuals of the energy along rays, c the measures of fairness and l their limits, H the quadratic form of
the energy.  The condition of one sheet is linear in q at each point, but its points move with the surface: so it is
asked where the last member failed it, and the programme is solved again (constraint generation; Hettich and Kortanek
1993).  Each step minimises the linearised residuals and measures, of which those count that are beyond their limits at
its end, with a damping (Levenberg 1944, Marquardt 1963) of changes of f and its second derivatives, whatever the basis,
which follows the gain ratio (Nielsen 1999).

Each step follows from the member before it by an optimum that is unique and by comparisons in which no rounding can
decide: no order of points, no witness of a proof, no choice among the worst.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from flint import fmpq_mat

from pas.algebra.monomials import monomial_values
from pas.arrays import Floats
from pas.errors import InfeasibleError, NotSolvedError
from pas.fairing.basis import to_doubles
from pas.fairing.constraints import Inequalities
from pas.fairing.objective import LocalModel, ObjectiveValue, SurfaceObjective
from pas.fairing.prepared import SETTINGS, FitSettings, PreparedSpace, SampledConditions
from pas.fairing.programme import MemberProgramme
from pas.fairing.wishes import UnitCoefficients, Wishes
from pas.limits import checkpoint, part
from pas.piecewise import PiecewiseSurface


@dataclass(frozen=True)
class Iterate:
    """A member with its geometry along rays, the inequalities under which it was found, and the damping to go on with.

    Where the energy is a quadratic form no rays are needed, and so there is no `value`.
    """

    member: Floats
    rows: Inequalities
    damping: float
    value: ObjectiveValue | None = None


@dataclass(frozen=True)
class FittedMember:
    """A member: its exact surface, its working coefficients (1, m), its energy, the inequalities whose optimum it is,
    at a share of the usual margins, what is kept for the next step of a slider, and the part of Phi for what is beyond
    limits."""

    surface: PiecewiseSurface
    working: fmpq_mat
    energy: float
    rows: Inequalities
    share: float
    iterate: Iterate | None = None
    beyond: float = 0.0

    @property
    def phi(self) -> float:
        """The value of the objective."""
        return self.energy + self.beyond


class _ContradictionError(Exception):
    """No member satisfies some inequalities and the user's constraints."""

    def __init__(self, rows: Inequalities) -> None:
        super().__init__("the constraints contradict one another")
        self.rows = rows


class FitSolver:
    """The programme of one space under the user's constraints.

    Raises `ValueError` for constraints that an energy of the surface cannot serve.
    """

    def __init__(self, space: PreparedSpace, wishes: Wishes, settings: FitSettings = SETTINGS) -> None:
        self.space, self.wishes, self.settings = space, wishes, settings
        self.programme = MemberProgramme(space, wishes)
        self.energy = self.programme.energy
        if self.energy.on_surface:
            check_on_surface(wishes)

    # --- the whole way

    def fitted(self) -> FittedMember:
        """The best member that is found, proved where that is wished for.

        Raises `InfeasibleError` where the constraints contradict or no member is proved, naming an irreducible set of
        conflicting points where the conflict involves the user's, and `NotSolvedError` where the solvers failed.
        """
        if not self.wishes.guard:
            nothing = Inequalities.none(self.space.basis.size)
            member = self.programme.optimum(nothing)
            if member is None:
                raise self.programme.conflict(nothing)
            return self.rounded(Iterate(member, nothing, 0.0), 0.0)
        failed: Inequalities | None = None
        for share in self.settings.margins:
            try:
                found = self.best(share)
            except _ContradictionError as error:
                failed = error.rows
                continue
            if found is not None:
                return found
        if failed is not None:
            raise self.programme.conflict(failed)
        raise InfeasibleError(f"no member of degree {self.space.degree} that was found passed the proofs")

    def best(self, share: float) -> FittedMember | None:
        """The best member with a share of the usual margins, proved where that is wished for; None where none is.

        Where the end of the way is not proved, it goes on from the last member that is, on a finer lattice of rays.
        """
        best: FittedMember | None = None
        start: Iterate | None = None
        for subdivisions in self.settings.lattices:
            conditions = SampledConditions(self.space, share, subdivisions)
            if start is None:
                start = self.started(conditions)
            if start is None:
                continue
            way = [replace(start, damping=self.settings.damping)]
            way += self.descent(way[0], conditions)
            way += self.closer(way[-1], conditions)
            found, start = self.furthest(way, share)
            if found is not None and (best is None or found.phi <= best.phi):
                best = found
            if start is way[-1] or (found is not None and self.hopeless(way[-1])):
                break
        return best

    def furthest(self, way: list[Iterate], share: float) -> tuple[FittedMember | None, Iterate | None]:
        """The last member that is proved, by longer and longer steps back: where one is not proved its neighbours
        mostly are not."""
        back = 0
        while True:
            found = self.proved(way[-1 - back], share)
            if found is not None:
                return found, way[-1 - back]
            if back == len(way) - 1:
                return None, None
            back = min(2 * back + 1, len(way) - 1)

    def started(self, conditions: SampledConditions) -> Iterate | None:
        """The member of the least quadratic form that is clean, by constraint generation; None where none is found or
        rays miss or graze its surface.  Raises `_ContradictionError` where there is none."""
        rows = conditions.first
        for _ in range(self.settings.rounds):
            checkpoint(f"choosing a member of degree {self.space.degree}")
            member = self.programme.optimum(rows)
            if member is None:
                raise _ContradictionError(rows)
            missed = conditions.missed(self.programme.normalised(member))
            if not len(missed):
                return self.iterate(member, rows)
            rows += missed
        return None

    def iterate(self, member: Floats, rows: Inequalities, live: bool = False) -> Iterate | None:
        """A member with rays that are laid for it; None where these miss or graze its surface."""
        if not self.energy.on_surface:
            return Iterate(member, rows, self.settings.damping)
        limits = self.wishes.limits_at(self.space.placed)
        value = SurfaceObjective.laid(self.space, self.energy, limits, member, live)
        return None if value is None else Iterate(member, rows, self.settings.damping, value)

    def closer(self, at: Iterate, conditions: SampledConditions) -> Iterator[Iterate]:
        """The way on, with rays where curvature is beyond the limits between those that there are."""
        for _ in range(self.settings.closer):
            finer = None if at.value is None or self.hopeless(at) else at.value.closer()
            if finer is None:
                return
            way = [replace(at, value=finer, damping=self.settings.damping)]
            way += self.descent(way[0], conditions)
            at = way[-1]
            yield from way

    def hopeless(self, at: Iterate) -> bool:
        """Whether more is beyond the limits than a finer look can mend."""
        return at.value is not None and at.value.beyond > self.settings.hopeless * at.value.energy

    # --- steps

    def descent(self, at: Iterate, conditions: SampledConditions, steps: int | None = None) -> Iterator[Iterate]:
        """Clean members of less and less Phi, until one is as good as settled."""
        if not self.programme.quadratic:
            return
        s, found = self.settings, [self.phi(at.member, at.value)]
        for _ in range(s.steps if steps is None else steps):
            checkpoint("making the surface fair")
            with part(0.1):
                new = self.step(at, conditions)
            if new is None:
                return
            yield new
            found.append(self.phi(new.member, new.value))
            lowered = found[-1] <= (1 - s.enough) * found[-2]
            free = new.damping <= min(at.damping, s.damping)
            slow = len(found) > s.several and found[-1] > (1 - s.fall) * found[-1 - s.several]
            hopeless = len(found) > s.brief and self.hopeless(new)
            if slow or hopeless or (free and not lowered and self.programme.holds(at.member)):
                return
            at = new

    def step(self, at: Iterate, conditions: SampledConditions) -> Iterate | None:
        """A clean member of less Phi; None where there is none, or none that is worth a step.

        Where a user's constraint does not hold yet, the first step is to where it does, whatever Phi is there.
        """
        s, now = self.settings, self.phi(at.member, at.value)
        most = now if self.programme.holds(at.member) else np.inf
        met = most == now and not len(at.rows.missed(at.member, 1 - self.settings.met))
        model = self.model(at)
        gram = self.space.sobolev_gram
        unit = np.trace(np.linalg.solve(gram, model.matrices()[0])) / len(gram) * gram
        rows, damping, cuts = at.rows, at.damping, 0
        for _ in range(s.trials):
            try:
                new, expected = self.least(at, model, damping * unit, rows)
            except NotSolvedError:  # rounding spoils the optimum: a shorter step is better conditioned
                rows, damping = at.rows, damping * s.slower
                continue
            if new is None:
                return None
            if met and damping <= s.damping and expected < (s.enough - s.loss * (cuts > 0)) * now:
                if not cuts:
                    return None
                rows, cuts, damping = at.rows, 0, damping * s.slower  # the margins that were lost cost more
                continue
            value = at.value and at.value.moved(new)
            if (value is None and at.value is not None) or not self.phi(new, value) < most:
                rows, damping = at.rows, damping * (1 if value is not None and model.joined(value) else s.slower)
                continue
            missed = conditions.missed(new)
            if not len(missed):
                gain = (now - self.phi(new, value)) / expected if expected > 0 else 0.0
                damping = damping * min(s.slower, max(s.faster, 1 - (2 * gain - 1) ** 3))
                return Iterate(new, rows, max(damping, s.least), value)
            rows, cuts = rows + missed, cuts + 1
            most = max(most, (1 + s.loss) * now)
            if cuts > 2:
                damping *= s.slower
            if cuts == s.trials // 2:
                return None
        return None

    def least(self, at: Iterate, model: LocalModel, damping: Floats, rows: Inequalities) -> tuple[Floats | None, float]:
        """The member of least linearised Phi with a matrix added that damps, under inequalities, and by how much that
        is less; which limits are passed there is found by Newton's method (Qi and Sun 1993)."""
        passed, step = model.values > 0, np.zeros(len(at.member))
        for _ in range(self.settings.sets):
            matrix, slope = model.matrices(passed)
            found = self.programme.step(matrix + damping, slope, rows, at.member, step)
            if found is None:
                return None, 0.0
            step = found
            before, passed = passed, model.values + model.rows @ step > 0
            if (before == passed).all():
                break
        over = (np.maximum(values, 0) for values in (model.values, model.values + model.rows @ step))
        was, now = (float(values @ values) for values in over)
        return at.member + step, was - now - float(2 * model.slope @ step + step @ model.normal @ step)

    def phi(self, member: Floats, value: ObjectiveValue | None) -> float:
        """The value of the objective at a member."""
        of_surface = 0.0 if value is None else value.total
        return of_surface + float(member @ self.programme.quadratic_part @ member) / 2

    def model(self, at: Iterate) -> LocalModel:
        """Half of Phi next to a member."""
        return LocalModel(at.value, self.programme.quadratic_part, at.member)

    # --- back to exact numbers

    def rounded(self, at: Iterate, share: float) -> FittedMember:
        """The member in rational numbers; raises `InfeasibleError` where a user's point is missed by rounding."""
        working = self.programme.rounded(at.member)
        energy = self._energy(to_doubles(working)[0], at.value)
        beyond = 0.0 if at.value is None else at.value.beyond
        return FittedMember(self.space.surface(working), working, energy, at.rows, share, beyond=beyond)

    def energy_of(self, surface: PiecewiseSurface) -> float:
        """The energy of a surface of the space; infinite where rays from the centre miss or graze it."""
        member = coordinates(self.space, surface)
        at = self.iterate(member, Inequalities.none(len(member)))
        return np.inf if at is None else self._energy(member, at.value)

    def _energy(self, member: Floats, value: ObjectiveValue | None) -> float:
        return self.programme.quadratic_energy(member) + (0.0 if value is None else value.energy)

    def proved(self, at: Iterate, share: float) -> FittedMember | None:
        """The member in rational numbers if it is proved or need not be; without a centre no sheet can be proved, and
        the certificate says so."""
        found = self.rounded(at, share)
        wished = self.wishes.prove and self.space.partition.center is not None
        return None if wished and not found.surface.certificate.proved else found


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


def coordinates(space: PreparedSpace, surface: PiecewiseSurface) -> Floats:
    """The working coefficients (m,) of the member nearest to a surface of no higher degree, normalised."""
    left, right = [], []
    for piece, points, weights in space.basis.quadrature(2 * space.degree):
        root = np.sqrt(weights)
        column = surface.scaled.polynomials[piece].dense(surface.degree)
        left.append(space.basis.values(piece, points) * root[:, None])
        right.append(column @ monomial_values(points, surface.degree) * root)
    member = np.linalg.lstsq(np.concatenate(left), np.concatenate(right), rcond=None)[0]
    return np.asarray(member / float(space.guard.mean_alpha @ member))
