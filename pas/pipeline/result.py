"""What comes of a choice: the surface, how it was found, and the solid that it bounds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Unpack

from pas.algebra.rational import to_fraction
from pas.blending.space import Member
from pas.fairing.energy import Energy
from pas.fairing.fairing import Choice
from pas.fairing.wishes import PointOptions, Wishes, check_point_options
from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.pipeline.bodies import body
from pas.pipeline.summary import summary
from pas.shape import Shape
from pas.solid.solid import Solid
from pas.surface.certificate import Certificate
from pas.surface.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.pipeline.space import SolutionSpace


@dataclass(frozen=True)
class Attempt:
    """One degree that was tried: the dimension of its space and what came of it."""

    degree: int
    dimension: int
    outcome: str


@dataclass(frozen=True, eq=False)
class Blend(Shape):
    """One chosen surface with everything known about it.

    `space` and `coefficients` (exact, in `space.basis`) say how it was chosen, `dimension` out of
    how many, by which `wishes`, and `energy` is its energy in the user's units.  `basis` is the space's
    where it does not follow from the problem.
    `timings` maps stages to seconds, `attempts` lists the degrees tried.  `find_space` gives the
    solution space, `choice` the numerical optimum (not kept in files).
    `stored` are the verdicts in the file that it was loaded from: what somebody found once, and no proof.
    """

    surface: PiecewiseSurface
    dimension: int
    coefficients: tuple[Fraction, ...]
    energy: float
    timings: dict[str, float]
    attempts: tuple[Attempt, ...]
    wishes: Wishes
    find_space: Callable[[], SolutionSpace]
    basis: tuple[Member, ...] | None = None
    choice: Choice | None = None
    stored: Certificate | None = None
    kind = "blend"

    @classmethod
    def of(
        cls,
        space: SolutionSpace,
        choice: Choice,
        wishes: Wishes,
        timings: dict[str, float],
        attempts: Sequence[Attempt],
    ) -> Blend:
        """The blend of a choice in a solution space."""
        fairing = space.fairing(wishes.energy)
        coefficients = (choice.working * fairing.basis.transform).entries()
        return cls(
            surface=choice.surface,
            dimension=space.dimension,
            coefficients=tuple(map(to_fraction, coefficients)),
            energy=fairing.energy_of(choice.working),
            timings=timings,
            attempts=tuple(attempts),
            wishes=wishes,
            find_space=lambda: space,
            basis=space.given_basis,
            choice=choice,
        )

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
        return self.wishes.energy

    @property
    def certificate(self) -> Certificate:
        """The verdicts on the surface, proved in this process, when first asked for."""
        return self.surface.certificate

    def refit(self, **options: Unpack[PointOptions]) -> Blend:
        """The same problem with other points, weights or normalisation, without new proofs.

        Keeps the guard rows of this blend, so it takes milliseconds: made for sliders.  `options`
        are `inside`, `outside`, `through`, `near`, `near_weight`, `handles`, `margin`, `normalize`.
        """
        if self.choice is None:
            raise ValueError("a blend loaded from a file cannot be refitted; use blend.space.fit(...)")
        check_point_options(options)
        wishes = self.wishes.changed(**options)
        chosen = self.space.fairing(wishes.energy).under(wishes, self.choice.rows, self.choice.margins)
        return Blend.of(self.space, chosen, wishes, {}, self.attempts)

    def solid(self, length: Any = None, names: Sequence[str] | None = None) -> Solid:
        """The solid inside the surface, with its neighbours continued by `length` and capped.

        `length` is in the model's units (by default half of the region's size; 0 ends the solid at the
        clips), `names` are the neighbours' faces ("neighbour 1", ... by default), whose caps are named
        after them ("neighbour 1 end").  The contacts are its joints.  Raises `GeometryError` where
        a clip is no plane or the surface has no region.
        """
        return body(self.surface, length, names)

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self, tolerance: float | None = None, *, seconds: float | None = None, progress: Report | None = None
    ) -> Mesh:
        """The surface's mesh; see `PiecewiseSurface.mesh`."""
        return self.surface.mesh(tolerance)

    def __str__(self) -> str:
        return summary(self)

    def __repr__(self) -> str:
        s = self.surface
        return f"<Blend GC^{s.order}, degree {s.degree}, dimension {self.dimension}>"
