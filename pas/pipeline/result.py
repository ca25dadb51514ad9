"""What scripts hold: a solution space, the blend chosen from it, its hollow blend, and the choice as a convex problem.

They stand together, since each gives the next: `SolutionSpace.fit` and `.problem` give a `Blend`, whose `space` is the
`SolutionSpace`, and `Blend.hollow` a `HollowBlend` of two of them.  The work is done below.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from typing import Unpack

from pas.algebra.inputs import check_flag, whole
from pas.algebra.rational import Exact, rational, to_fraction
from pas.blending.generators import Generator, generators
from pas.blending.multipliers import Consistency, Multipliers, consistency
from pas.blending.regularity import TrivialPart, is_regular, trivial_part
from pas.blending.shaping import LeastSquares, Optimum, determining_set, least_squares, optimum
from pas.blending.solving import solve
from pas.contacts.contact import ContactLike
from pas.fairing.energy import Energy, as_energy
from pas.fairing.functionals import Handle
from pas.fairing.refit import refitted
from pas.fairing.solver import FittedMember
from pas.fairing.wishes import (
    Options,
    PointOptions,
    PointsLike,
    Sliders,
    Wishes,
    as_wishes,
    check_point_options,
    exact_points,
)
from pas.limits import Report, limited
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import body
from pas.pipeline.chosen import Attempt, ChosenBlend, FitSpace
from pas.pipeline.convex_problem import MemberProblem
from pas.pipeline.fit import fit
from pas.pipeline.hollow import BlendWall, hollow
from pas.pipeline.stages import OnStage, Stages
from pas.pipeline.summary import summary
from pas.solid.solid import Solid

MOST_STEPS = 1000
"""Steps of a slider that may be asked for at once."""


@dataclass(frozen=True, eq=False, repr=False)
class Blend(ChosenBlend):
    """One chosen surface with everything known about it.

    `space` and `coefficients` say how it was chosen, `dimension` out of
    how many, by which `wishes`, and `energy` is its energy in the user's units.  `basis` is the space's
    where it does not follow from the problem.
    `timings` maps stages to seconds, `attempts` lists the degrees tried.  `find_space` gives the
    solution space, `found_dimension` its dimension where that is known without; `choice` is the numerical optimum (not
    kept in files).
    `stored` are the verdicts in the file that it was loaded from: what somebody found once, and no proof.  Of a blend
    that was loaded `energy`, `timings` and `attempts` are what its file tells as well; all else is found anew.
    """

    find_space: Callable[[], SolutionSpace]
    kind = "blend"

    @cached_property
    def space(self) -> SolutionSpace:
        """The solution space it was chosen from (solved again after loading from a file)."""
        return self.find_space()

    @limited("choosing another member", "fewer steps")
    def refit(
        self,
        *,
        steps: int | None = 1,
        seconds: float | None = None,
        progress: Report | None = None,
        **options: Unpack[Sliders],
    ) -> Blend:
        """The blend for other points, weights, tension or normalisation, without new proofs: for sliders.

        `options` are `inside`, `outside`, `through`, `near`, `near_weight`, `handles`, `coefficients`, `margin`,
        `normalize`, `tension`.  An energy of the surface is followed for so many Gauss-Newton `steps` from this blend,
        on few rays; with `steps=None` until it settles, on many.  A quadratic form is at its optimum at once.  What is
        too far away for one linear step is found anew in `space`, which takes longer, whatever `steps` says.
        `standing` says of the result whether it is proved; asking for its `certificate` proves it.

        Raises `InfeasibleError` where no member meets the wishes, `ValueError` and `TypeError` for wrong arguments.
        """
        check_point_options(options, Sliders)
        if steps is not None:
            whole(steps, "steps", 1, MOST_STEPS, "or None to settle")
        wishes = self.wishes.changed(**options)
        chosen = refitted(self.space.prepared, self.surface, self.choice, wishes, steps)
        return self.space.blend(chosen, wishes, {}, self.attempts)

    def solid(self, length: Exact | None = None, names: Sequence[str] | None = None) -> Solid:
        """The solid inside the surface, with its neighbours continued by `length` and capped.

        `length` is in the model's units (by default half of the region's size; 0 ends the solid at the clips), `names`
        are the neighbours' faces ("neighbour 1", ... by default), whose caps are named after them ("neighbour 1 end").
        The contacts are its joints.  Around an opening a plate goes on as a slab and another surface as a piece up to a
        wider cone, by default half of the opening's radius, with a flat "neighbour 1 back" (see `pas.pipeline.mouth`).

        Raises `GeometryError` where a clip is neither a plane nor the cone of an opening, where the surface has no
        region, and where the one around an opening does not go on as one sheet so far.
        """
        return body(self.surface, length, names)

    @limited("making a blend hollow", "a thinner wall")
    def hollow(
        self,
        thickness: Exact | None = None,
        *,
        inner: Sequence[ContactLike] | None = None,
        prove: bool = True,
        seconds: float | None = None,
        progress: Report | None = None,
    ) -> HollowBlend:
        """This blend with a cavity: with an inner blend that is proved inside it.

        The inner contacts are this blend's a `thickness` inside (the model's units), with the same clips: parallel
        planes, pipes, spheres, tori and circular cones; for other quadrics see `pas.contacts.parallels`.  Or `inner`
        gives them, one for each contact, in planes of the same clips, and along the same cone at an opening.  The inner
        blend has the same order, and is chosen by the same energy and by how near the wall is to its thickness; this
        blend's points and handles are not asked of it.  It has the same centre, region and degree where these give a
        fair surface and a wall between half and twice as thick as wished, else another degree, walls nearer by or,
        where this surface passes near its centre as that of a sharp bend does, a centre further in.  With `prove=False`
        the result may be one that is not proved.

        The walls of `Solid.shell` have one thickness all over, and inner faces that are no polynomials.

        Raises `GeometryError` for a thickness that is not below a contact's radius and for contacts without an inner
        surface, `NotProvedError` where the inner blend is not proved or not inside (with the `HollowBlend`),
        `ValueError` and `TypeError` for wrong arguments.
        """
        return hollow(HollowBlend, SolutionSpace, self, thickness, inner, check_flag(prove, "prove"))

    @property
    def description(self) -> str:
        """What was asked and what was found: all that `print` says but the verdicts."""
        return summary(self)

    def __str__(self) -> str:
        verdicts = self.certificate.verdicts
        proved = sum(v.proved for v in verdicts)
        return f"{self.description}\n\n{proved} of {len(verdicts)} verdicts proved\n{self.certificate}"


class SolutionSpace(FitSpace[Blend]):
    """All piecewise polynomials of one degree that satisfy every contact and face condition.

    `partition`, `contacts`, `order` and `degree` are the problem's; `patches[p]` holds the exact
    coefficients of the basis on piece p, in local coordinates, one member a row.  `given_basis`
    is None for a basis that follows from the problem.  `degrees_tried` maps the degrees that
    were looked at to the dimensions found.
    """

    @cached_property
    def regular(self) -> bool:
        """Whether some member meets every contact with alpha not identically zero on its curve."""
        return is_regular(self)

    @cached_property
    def trivial_part(self) -> TrivialPart:
        """The members of little use: singular along a contact, products of the data, reducible."""
        return trivial_part(self)

    @cached_property
    def generators(self) -> tuple[Generator, ...]:
        """Generators of all solutions of any degree, by ascending degree.

        For a single cell the reduced graded Groebner basis of the ideal that they form; for
        several pieces generators of the module over Q[x, y, z].
        """
        return generators(self)

    @cached_property
    def multipliers(self) -> tuple[Multipliers, ...]:
        """The multipliers of each basis member, by exact lifting (user's coordinates).

        At contact i the piece is `gamma[i] f + beta[i] h^(k+1)`, across interior face j
        `second = first + alpha[j] plane^(k+1)`, with gamma reduced modulo h^(k+1).
        """
        return tuple(self.consistency.multipliers(member) for member in self.basis)

    @cached_property
    def consistency(self) -> Consistency:
        """The system of equations that multipliers satisfy (Xu, Chen and Deng)."""
        return consistency(self.placed)

    def energy_matrix(self, energy: Energy | None = None) -> list[list[Fraction]]:
        """The exact matrix K (dimension, dimension) of the basis: `E = 1/2 a^T K a` for coefficients a.

        `energy` is `pas.ThinPlate()` by default.  Raises `ValueError` for one that has no exact form.
        """
        return [[to_fraction(v) for v in row] for row in as_energy(energy).products(self).tolist()]

    def blend(
        self, choice: FittedMember, wishes: Wishes, timings: dict[str, float], attempts: Sequence[Attempt]
    ) -> Blend:
        """The blend of a member of this space that was chosen by wishes."""
        return Blend.of(self, choice, wishes, timings, attempts)

    @classmethod
    def blend_with(
        cls,
        surface: PiecewiseSurface,
        dimension: int,
        *,
        energy: float,
        wishes: Wishes,
        timings: dict[str, float],
        attempts: Sequence[Attempt],
    ) -> Blend:
        """The blend with a surface known to be a member of its space of that dimension, which is solved when asked."""

        @cache
        def space() -> SolutionSpace:
            return cls.of(solve(surface.placed, surface.degree))

        return Blend(
            surface=surface,
            find_coefficients=lambda: [rational(c) for c in space().coordinates(surface.polynomials)],
            energy=energy,
            timings=timings,
            attempts=tuple(attempts),
            wishes=wishes,
            find_space=space,
            found_dimension=dimension,
        )

    @limited("choosing a surface", "a lower degree")
    def fit(
        self,
        wishes: Wishes | None = None,
        *,
        on_stage: OnStage | None = None,
        seconds: float | None = None,
        progress: Report | None = None,
        **options: Unpack[Options],
    ) -> Blend:
        """Choose one member by wishes, or by these with some options changed (see `pas.Wishes`).

        `on_stage` is told the name and the seconds of each stage at its end.  Raises
        `NoSolutionError` for an empty space, `InfeasibleError` for wishes that contradict,
        `NotProvedError` where the choice does not pass the proofs that were wished for.
        """
        return fit(self, as_wishes(wishes).changed(**options), Stages(on_stage))

    def problem(self, wishes: Wishes | None = None, **options: Unpack[Options]) -> ConvexProblem:
        """The choice by a quadratic energy (`pas.ThinPlate()` by default) as a convex programme of cvxpy.

        Constraints and terms of one's own are added to it; see `pas.ConvexProblem`.  Raises `NoSolutionError` for an
        empty space, `InfeasibleError` for wishes that contradict, `ValueError` for an energy of the surface.
        """
        return ConvexProblem(self, as_wishes(wishes).changed(**options))

    @limited("finding the optimum", "a lower degree")
    def optimum(
        self,
        energy: Energy | None = None,
        *,
        seconds: float | None = None,
        progress: Report | None = None,
        **options: Unpack[PointOptions],
    ) -> Optimum:
        """The exact member of least energy, with its certificate of optimality.

        `options` are those of `fit` that are linear: `inside`, `outside` (`margin` 0 by default),
        `through`, `near`, `near_weight`, `handles`, `coefficients`, and `normalize`: the sum of coefficients
        is 1 by default, unless a handle or a coefficient with a value other than 0 fixes the scale.  No condition of
        a clean sheet is asked.

        Raises `InfeasibleError` for constraints that contradict, `NoSolutionError` for an empty space.
        """
        return optimum(self, energy, **options)

    def determining_set(self, prefer: Sequence[Handle] = ()) -> tuple[Handle, ...]:
        """B-coefficients that can be set freely and determine the member: `dimension` many.

        Each is (cell, multi-index of the cell's corners); those in `prefer` come first, as far as
        they are independent.  Set some of them with `optimum(handles=...)` or `fit(handles=...)`,
        and the rest follow.
        """
        return determining_set(self, prefer)

    def least_squares(
        self, points: PointsLike, weights: Sequence[Exact] | None = None, *, by_gradient: bool = False
    ) -> LeastSquares:
        """The member with the least `sum w_i f(p_i)^2 / |f|^2`, |f| the length of its coefficients.

        With `by_gradient` the divisor is `sum w_i |grad f(p_i)|^2` instead: the quotient is then a mean
        squared distance to first order, whatever the place and size of the figure (Taubin 1991).  Of f and -f, which
        have the same quotient, it is the one that is negative at the centre of the partition, or has alpha > 0 on the
        contacts' curves where there is no centre.

        `points` are three numbers each (floats as the exact rationals they are).  For members through
        other points take `space.through(...)` first; with energy, inside or outside points use
        `fit(near=..., normalize=pas.UnitCoefficients())`.

        Raises `ValueError` for fewer points than dimensions less one.
        """
        return least_squares(self, exact_points(points, "points"), weights, by_gradient=by_gradient)


class ConvexProblem(MemberProblem[Blend]):
    """The choice of one member of a solution space by a quadratic energy, in the language of cvxpy.

        corner = [pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/4", 1), pas.Pipe((0, 0, 1), "2/5", 1)]
        problem = pas.solutions(corner, 1, 4).problem()
        values = problem.values([("1/4", "1/4", "1/4"), ("-3/10", "-3/10", "-3/10")])
        blend = problem.solve([values[0] == values[1]])

    `variable` (m,) holds the coordinates in the space's working basis; `energy` is the expression that is made small,
    in the user's units; `constraints` are the normalisation, the points and handles that are wished for, and
    inequalities at samples that ask for clean walls, clip faces and a centre inside.  That the surface is one sheet
    cannot be said beforehand: `missed` gives what a solution lacks of it, and `solve` goes on until nothing is missed.
    Made by `SolutionSpace.problem`.
    """

    space: SolutionSpace


@dataclass(frozen=True, eq=False, repr=False)
class HollowBlend(BlendWall):
    """A blend with a cavity: what is between an `outer` and an `inner` blend of the same contacts' two sides.

    `thickness` is that of the wall at the contacts, in the model's units; None where the inner contacts were given.
    Made by `Blend.hollow`.
    """

    outer: Blend
    inner: Blend
    kind = "hollow blend"
