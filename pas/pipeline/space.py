"""The solution space as scripts use it: exact linear algebra, and by name whatever is worked out from it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import Unpack

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree
from pas.algebra.rational import Exact, to_fraction
from pas.blending.generators import Generator, generators
from pas.blending.multipliers import Consistency, Multipliers, consistency
from pas.blending.place import PartitionLike, place
from pas.blending.regularity import TrivialPart, is_regular, trivial_part
from pas.blending.shaping import LeastSquares, Optimum, determining_set, least_squares, optimum
from pas.blending.solving import check_method, solve
from pas.blending.space import Space
from pas.contacts.contact import ContactLike
from pas.fairing.energy import Energy, as_energy
from pas.fairing.prepared import PreparedSpace
from pas.fairing.wishes import Handle, Options, PointOptions, PointsLike, Wishes, as_wishes, exact_points
from pas.limits import Report, checkpoint, limited
from pas.pipeline.convex_problem import ConvexProblem
from pas.pipeline.fit import fit
from pas.pipeline.result import Blend
from pas.pipeline.stages import OnStage, Stages


class SolutionSpace(Space):
    """All piecewise polynomials of one degree that satisfy every contact and face condition.

    `partition`, `contacts`, `order` and `degree` are the problem's; `patches[p]` holds the exact
    coefficients of the basis on piece p, in local coordinates, one member a row.  `given_basis`
    is None for a basis that follows from the problem.  `degrees_tried` maps the degrees that
    were looked at to the dimensions found.
    """

    @classmethod
    def of(cls, space: Space) -> SolutionSpace:
        """A space with these methods."""
        return cls(space.placed, space.degree, space.source, space.given_basis, space.degrees_tried)

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

    @cached_property
    def prepared(self) -> PreparedSpace:
        """The members in floating point, with what the fit asks of them; made once."""
        return PreparedSpace(self.placed, self.degree, self.source)

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


@limited("solving for all surfaces", "a lower degree")
def solutions(
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | None = None,
    partition: PartitionLike | None = None,
    *,
    method: str = "linear",
    regular: bool = False,
    highest_degree: int = HIGHEST_DEGREE,
    seconds: float | None = None,
    progress: Report | None = None,
) -> SolutionSpace:
    """All surfaces that meet the contacts with GC^`order`, exact.

    `contacts` are pipes, contacts or pairs (surface, clip); clips that are "auto" are placed as by
    `pas.blend`.  The `partition` is a
    `pas.SingleCell(...)` for single polynomials, or several cells; without one, three
    perpendicular contacts get the six-tetrahedra corner.

    With a `degree`, all solutions of that degree (the dimension may be 0); without, those of the
    lowest degree that has any, or with `regular` a regular one (alpha not identically zero on
    the contact curves).  Where no degree up to `highest_degree` has any, the answer is the empty
    space of that degree; `degrees_tried` has the dimensions found.

    `method` is "linear", "syzygy", and for a single cell also "normal-form" and "intersection": the
    same space by different ways, with different bases.

    Raises `GeometryError` where the contacts do not fit, `ValueError` or `TypeError` for a wrong argument.
    """
    check_degree(highest_degree, "highest_degree")
    placed = place(contacts, order, partition)
    check_method(method, placed.partition)
    if degree is not None:
        return SolutionSpace.of(solve(placed, check_degree(degree), method))
    tried: dict[int, int] = {}
    for candidate in range(1, highest_degree + 1):
        checkpoint(f"solving for degree {candidate}")
        space = solve(placed, candidate, method)
        tried[candidate] = space.dimension
        if space.dimension and (not regular or is_regular(space)):
            break
    return SolutionSpace(placed, space.degree, space.source, degrees_tried=tried)
