"""The results that scripts hold: a solution space and the blend chosen from it.

They stand together, since each gives the other: `SolutionSpace.fit` and `.problem` give a `Blend`, whose `space` is the
`SolutionSpace`.  The work is done below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Unpack

from pas.algebra.inputs import check_flag, whole
from pas.algebra.rational import Exact, to_fraction
from pas.blending import multipliers, regularity, shaping
from pas.blending.multipliers import Consistency, Multipliers
from pas.blending.space import Space
from pas.contacts.contact import ContactLike
from pas.contacts.ends import ContactEnd
from pas.fairing.contradictions import check_wishes
from pas.fairing.energy import Energy, as_energy
from pas.fairing.refit import refitted
from pas.fairing.wishes import Options, Sliders, Wishes, as_wishes, check_point_options
from pas.limits import Report, WorkLimits, limited
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import Length, body, contact_ends
from pas.pipeline.chosen import ChosenBlend, OnStage, Stages, choose
from pas.pipeline.convex_problem import ConvexProblem
from pas.pipeline.hollow import HollowBlend, hollow
from pas.pipeline.summary import summary
from pas.solid.solid import Solid


@dataclass(frozen=True, eq=False, repr=False)
class Blend(ChosenBlend):
    """One chosen surface with everything known about it.

    `space` and `coefficients` say how it was chosen, `dimension` out of how many, by which `wishes`, and `energy` is
    its energy in the user's units.  `basis` is the space's where it does not follow from the problem.  `timings` maps
    stages to seconds, `attempts` lists the degrees tried.  `find_space` gives the solution space, `found_dimension` its
    dimension where that is known without; `choice` is the numerical optimum (not kept in files).  `stored` are the
    verdicts in the file that it was loaded from: what somebody found once, and no proof.  Of a blend that was loaded
    `energy`, `timings` and `attempts` are what its file tells as well; all else is found anew.
    """

    kind = "blend"

    @property
    def sides(self) -> tuple[PiecewiseSurface, ...]:
        """Its surface alone; a hollow blend has two."""
        return (self.surface,)

    @cached_property
    def space(self) -> SolutionSpace:
        """The solution space it was chosen from (solved again after loading from a file)."""
        return SolutionSpace.of(self.find_space())

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
            most_steps = 1000  # steps of a slider that may be asked for at once
            whole(steps, "steps", 1, most_steps, "or None to settle")
        wishes = self.wishes.changed(**options)
        chosen = refitted(self.space.prepared, self.surface, self.choice, wishes, steps)
        return Blend.of(self.space, chosen, wishes, {}, self.attempts)

    def solid(self, length: Length = None, names: Sequence[str] | None = None) -> Solid:
        """The solid inside the surface, with its neighbours continued by `length` and capped.

        `length` is in the model's units, one number or one for each contact (by default half of the region's size; 0
        ends the solid at the clips), `names` are the neighbours' faces ("neighbour 1", ... by default), whose caps are
        named after them ("neighbour 1 end").  The contacts are its joints.  Around an opening a plate goes on as a slab
        and another surface as a piece up to a wider cone, by default half of the opening's radius, with a flat
        "neighbour 1 back" (see `pas.pipeline.around_opening`).

        With plates, openings and quadrics around its centre it is meshed at once, from the mesh of the surface (see
        `pas.solid.sheets`).

        Raises `GeometryError` where a clip is neither a plane nor the cone of an opening, where the surface has no
        region, and where the one around an opening does not go on as one sheet so far.
        """
        return body(self.surface, length, names)

    def ends(self, length: Length = 0) -> tuple[ContactEnd, ...]:
        """For each contact where the blend ends, or where `solid(length)` does: where flanges go.

        Each has its `center` (3,), the unit `direction` (3,) away from the blend, the `radius` where it is round, and
        the `distance` from the node's centre, in the model's units; see `pas.ContactEnd`.  An opening is where it is
        for any length, with its axis for a direction: its neighbour goes on around it and not along it.

        Raises `GeometryError` where a contact has no closed plane curve there, `ValueError` for a negative length.
        """
        return contact_ends(self.surface, length)

    @limited("making a blend hollow", "a thinner wall")
    def hollow(
        self,
        thickness: Exact | None = None,
        *,
        inner: Sequence[ContactLike] | None = None,
        prove: bool = True,
        **limits: Unpack[WorkLimits],
    ) -> HollowBlend[Blend]:
        """This blend with a cavity: with an inner blend that is proved inside it.

        The inner contacts are this blend's a `thickness` inside (the model's units), with the same clips: parallel
        planes, pipes, spheres, tori and circular cones; for other quadrics see `pas.contacts.parallels`.  Or `inner`
        gives them, one for each contact, in planes of the same clips, at an opening along its cone or one around it
        from the same point, which makes the wall more even.  The inner blend has the same order, and is chosen by the
        same energy and by how near the wall is to its thickness; this blend's points and handles are not asked of it.
        It has the same centre, region and degree where these give a fair surface and a wall between half and twice as
        thick as wished, else another degree, walls nearer by or, where this surface passes near its centre as that of a
        sharp bend does, a centre further in.  With `prove=False` the result may be one that is not proved.

        The walls of `Solid.shell` have one thickness all over, and inner faces that are no polynomials.

        Raises `GeometryError` for a thickness that is not below a contact's radius and for contacts without an inner
        surface, `NotProvedError` where the inner blend is not proved or not inside (with the `HollowBlend`),
        `ValueError` and `TypeError` for wrong arguments.
        """
        return hollow(self, thickness, inner, check_flag(prove, "prove"))

    @property
    def description(self) -> str:
        """What was asked and what was found: all that `print` says but the verdicts."""
        return summary(self)

    def __str__(self) -> str:
        verdicts = self.certificate.verdicts
        proved = sum(v.proved for v in verdicts)
        return f"{self.description}\n\n{proved} of {len(verdicts)} verdicts proved\n{self.certificate}"


class SolutionSpace(Space):
    """All piecewise polynomials of one degree that satisfy every contact and face condition.

    `partition`, `contacts`, `order` and `degree` are the problem's; `patches[p]` holds the exact coefficients of the
    basis on piece p, in local coordinates, one member a row.  `given_basis` is None for a basis that follows from the
    problem.  `degrees_tried` maps the degrees that were looked at to the dimensions found.

    The linear algebra is that of `pas.blending.space.Space`, of which all that is here is made.
    """

    regular = cached_property(regularity.is_regular)
    trivial_part = cached_property(regularity.trivial_part)
    generators = cached_property(regularity.generators)
    optimum = shaping.optimum
    determining_set = shaping.determining_set
    least_squares = shaping.least_squares

    @cached_property
    def consistency(self) -> Consistency:
        """The equations of multipliers: `.multipliers(polynomials)` are those of a member, in user coordinates."""
        return multipliers.consistency(self.placed)

    @cached_property
    def multipliers(self) -> tuple[Multipliers, ...]:
        """The multipliers of each basis member, by exact lifting (user's coordinates).

        At contact i the piece is `gamma[i] f + beta[i] h^(k+1)`, across interior face j
        `second = first + alpha[j] plane^(k+1)`, with gamma reduced modulo h^(k+1).
        """
        return tuple(self.consistency.multipliers(member) for member in self.basis)

    def energy_matrix(self, energy: Energy | None = None) -> list[list[Fraction]]:
        """The exact matrix K (dimension, dimension) of the basis: `E = 1/2 a^T K a` for coefficients a.

        `energy` is `pas.ThinPlate()` by default.  Raises `ValueError` for one that has no exact form.
        """
        return [[to_fraction(v) for v in row] for row in as_energy(energy).products(self).tolist()]

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
        wished = as_wishes(wishes).changed(**options)
        self.check_not_empty()
        check_wishes(wished, self.placed)
        return choose(Blend, self, wished.settled(self.placed), Stages(on_stage))

    def problem(self, wishes: Wishes | None = None, **options: Unpack[Options]) -> ConvexProblem[Blend]:
        """The choice by a quadratic energy (`pas.ThinPlate()` by default) as a convex programme of cvxpy.

        Constraints and terms of one's own are added to it; see `pas.ConvexProblem`.  Raises `NoSolutionError` for an
        empty space, `InfeasibleError` for wishes that contradict, `ValueError` for an energy of the surface.
        """
        return ConvexProblem(Blend, self, as_wishes(wishes).changed(**options))
