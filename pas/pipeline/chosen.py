"""One chosen surface, and the space that it was chosen from, as the search, the fit and the cavity know them.

What users call on them, `fit`, `refit`, `hollow` and the like, needs the search, which makes such blends itself.  So it
stands above, in `pas.pipeline.result`: a search is given the class of the spaces that it solves for, and every such
space makes the blends of its members.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from typing import Generic, Self, TypeVar

from flint import fmpq, fmpq_mat

from pas.algebra.rational import to_fraction
from pas.blending.space import Member, Space
from pas.certify.certificate import Certificate
from pas.errors import GeometryError
from pas.fairing.basis import BasisChange
from pas.fairing.energy import Energy, as_energy
from pas.fairing.prepared import PreparedSpace
from pas.fairing.solver import FittedMember
from pas.fairing.wishes import Wishes
from pas.limits import Report, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.piecewise import PiecewiseSurface
from pas.settings import MeshSettings
from pas.shape import Shape
from pas.surface.fairness import Fairness
from pas.surface.fairness_limits import FairnessLimits
from pas.verdicts import Status


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
class ChosenBlend(Shape):
    """A surface that was chosen from a space, with how it was chosen and what is known of it; see `pas.Blend`."""

    surface: PiecewiseSurface
    find_coefficients: Callable[[], Sequence[fmpq]]
    energy: float
    timings: dict[str, float]
    attempts: tuple[Attempt, ...]
    wishes: Wishes
    find_space: Callable[[], FitSpace[ChosenBlend]]
    basis: tuple[Member, ...] | None = None
    choice: FittedMember | None = None
    stored: Certificate | None = None
    found_dimension: int | None = None

    @classmethod
    def of(
        cls,
        space: FitSpace[ChosenBlend],
        choice: FittedMember,
        wishes: Wishes,
        timings: dict[str, float],
        attempts: Sequence[Attempt],
    ) -> Self:
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
    def space(self) -> FitSpace[ChosenBlend]:
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

    def __repr__(self) -> str:
        s = self.surface
        dimension = "" if self.found_dimension is None else f", dimension {self.found_dimension}"
        return f"<Blend GC^{s.order}, degree {s.degree}{dimension}, {self.standing}>"


B = TypeVar("B", bound=ChosenBlend)
B_co = TypeVar("B_co", bound=ChosenBlend, covariant=True)


class FitSpace(Space, ABC, Generic[B_co]):
    """A solution space from which members are chosen, whose blends are of one class."""

    @classmethod
    def of(cls, space: Space) -> Self:
        """A space with these methods."""
        return cls(space.placed, space.degree, space.source, space.given_basis, space.degrees_tried)

    @cached_property
    def prepared(self) -> PreparedSpace:
        """The members in floating point, with what the fit asks of them; made once."""
        return PreparedSpace(self.placed, self.degree, self.source)

    @abstractmethod
    def blend(
        self, choice: FittedMember, wishes: Wishes, timings: dict[str, float], attempts: Sequence[Attempt]
    ) -> B_co:
        """The blend of a member of this space that was chosen by wishes."""

    @classmethod
    @abstractmethod
    def blend_with(
        cls,
        surface: PiecewiseSurface,
        dimension: int,
        *,
        energy: float,
        wishes: Wishes,
        timings: dict[str, float],
        attempts: Sequence[Attempt],
    ) -> B_co:
        """The blend with a surface known to be a member of its space of that dimension, which is solved when asked."""


def _entries(row: fmpq_mat, change: BasisChange) -> list[fmpq]:
    """The entries of a changed row, as a function that can be called later."""
    return list((row * change.matrix).entries())
