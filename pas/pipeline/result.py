"""What comes of a choice: the surface, how it was found, and the solid that it bounds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from typing import TYPE_CHECKING, Unpack, cast

from flint import fmpq, fmpq_mat

from pas.algebra.inputs import check_flag, whole
from pas.algebra.rational import Exact, to_fraction
from pas.blending.space import Member
from pas.certify.certificate import Certificate
from pas.contacts.contact import ContactLike
from pas.errors import GeometryError
from pas.fairing.basis import BasisChange
from pas.fairing.energy import Energy, as_energy
from pas.fairing.refit import refitted
from pas.fairing.solver import FittedMember
from pas.fairing.wishes import Sliders, Wishes, check_point_options
from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.piecewise import PiecewiseSurface
from pas.pipeline.bodies import body
from pas.pipeline.summary import summary
from pas.registry import loaded
from pas.settings import MeshSettings
from pas.shape import Shape
from pas.solid.solid import Solid
from pas.surface.fairness import Fairness
from pas.surface.fairness_limits import FairnessLimits
from pas.verdicts import Status

if TYPE_CHECKING:
    from pas.pipeline.hollow import HollowBlend
    from pas.pipeline.space import SolutionSpace


MOST_STEPS = 1000
"""Steps of a slider that may be asked for at once."""

HOLLOW = "pas.pipeline.hollow:hollow"
"""Where the cavity of a blend is made, which is a blend itself."""


@dataclass(frozen=True)
class Attempt:
    """One degree that was tried: the dimension of its space, what came of it, the seconds it took, and on which
    `partition`, by its title."""

    degree: int
    dimension: int
    outcome: str
    seconds: float = 0.0
    partition: str = ""


@dataclass(frozen=True, eq=False)
class Blend(Shape):
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

    surface: PiecewiseSurface
    find_coefficients: Callable[[], Sequence[fmpq]]
    energy: float
    timings: dict[str, float]
    attempts: tuple[Attempt, ...]
    wishes: Wishes
    find_space: Callable[[], SolutionSpace]
    basis: tuple[Member, ...] | None = None
    choice: FittedMember | None = None
    stored: Certificate | None = None
    found_dimension: int | None = None
    kind = "blend"

    @classmethod
    def of(
        cls,
        space: SolutionSpace,
        choice: FittedMember,
        wishes: Wishes,
        timings: dict[str, float],
        attempts: Sequence[Attempt],
    ) -> Blend:
        """The blend of a choice in a solution space."""
        return cls(
            surface=choice.surface,
            find_coefficients=partial(_entries, choice.working, space.prepared.basis.change),
            energy=choice.energy,
            timings=timings,
            attempts=tuple(attempts),
            wishes=wishes,
            find_space=lambda: space,
            basis=space.given_basis,
            choice=choice,
            found_dimension=space.dimension,
        )

    @property
    def dimension(self) -> int:
        """That of the solution space."""
        return self.space.dimension if self.found_dimension is None else self.found_dimension

    @cached_property
    def coefficients(self) -> tuple[Fraction, ...]:
        """The member's coefficients in `space.basis`, exact; worked out when first asked for."""
        return tuple(map(to_fraction, self.find_coefficients()))

    @cached_property
    def space(self) -> SolutionSpace:
        """The solution space it was chosen from (solved again after loading from a file)."""
        return self.find_space()

    @property
    def constraints(self) -> Wishes:
        """The points and the normalisation among the wishes."""
        return self.wishes.changed(energy=None, prove=True, guard=True, basis=None)

    @property
    def plate(self) -> Energy:
        """The energy that was made small: that of the wishes."""
        return as_energy(self.wishes.energy)

    @cached_property
    def fairness(self) -> Fairness | None:
        """How fair the surface is, measured; None where that cannot be seen from a centre."""
        try:
            return self.surface.fairness()
        except GeometryError:
            return None

    @property
    def limits(self) -> FairnessLimits:
        """Up to what it counts as fair: what was wished, or the usual ones of its order."""
        return self.wishes.limits_at(self.surface.placed)

    @property
    def standing(self) -> str:
        """What is known of its proof, without working on it: "proved", "not proved yet", "refuted" or "undecided"."""
        if not self.surface.looked_into:
            return "not proved yet"
        certificate = self.certificate
        if certificate.proved:
            return "proved"
        return "refuted" if any(v.status is Status.REFUTED for v in certificate.verdicts) else "undecided"

    @property
    def certificate(self) -> Certificate:
        """The verdicts on the surface, proved in this process, when first asked for."""
        return self.surface.certificate

    @limited("choosing another member", "fewer steps")
    def refit(
        self,
        *,
        steps: int | None = 1,
        seconds: float | None = None,
        progress: Report | None = None,
        **options: Unpack[Sliders],
    ) -> Blend:
        """The same problem with other points, weights, tension or normalisation, without new proofs: for sliders.

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
        return Blend.of(self.space, chosen, wishes, {}, self.attempts)

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
        return cast("HollowBlend", loaded(HOLLOW)(self, thickness, inner, check_flag(prove, "prove")))

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self,
        tolerance: float | None = None,
        *,
        max_triangles: int | None = None,
        quality: Quality | str = Quality.BALANCED,
        seconds: float | None = None,
        progress: Report | None = None,
    ) -> Mesh:
        """The surface's mesh; see `PiecewiseSurface.mesh`."""
        return self.surface.mesh(tolerance, max_triangles=max_triangles, quality=quality)

    def meshed(self, settings: MeshSettings) -> Mesh:
        """The surface's mesh by settings."""
        mesh: Mesh = self.surface.meshed(settings)
        return mesh

    @property
    def description(self) -> str:
        """What was asked and what was found: all that `print` says but the verdicts."""
        return summary(self)

    def __str__(self) -> str:
        verdicts = self.certificate.verdicts
        proved = sum(v.proved for v in verdicts)
        return f"{self.description}\n\n{proved} of {len(verdicts)} verdicts proved\n{self.certificate}"

    def __repr__(self) -> str:
        s = self.surface
        dimension = "" if self.found_dimension is None else f", dimension {self.found_dimension}"
        return f"<Blend GC^{s.order}, degree {s.degree}{dimension}, {self.standing}>"


def _entries(row: fmpq_mat, change: BasisChange) -> list[fmpq]:
    """The entries of a changed row, as a function that can be called later."""
    return list((row * change.matrix).entries())
