"""One chosen surface: how it is chosen from a space, and what is known of it.

What users call on it besides, `refit`, `hollow` and `space.fit`, needs the search, which makes such blends itself: it
stands above, in `pas.Blend`, and a search is told of which class the blends are that it makes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import chain
from math import floor, log10
from typing import Self, TypeVar, Unpack

from flint import fmpq

from pas.algebra.inputs import shown, whole
from pas.algebra.rational import Exact, binary_exponent, rational, to_fraction
from pas.blending.space import Member, Space
from pas.certify.certificate import Certificate
from pas.errors import GeometryError, NotProvedError
from pas.fairing.contradictions import check_kept
from pas.fairing.energy import Energy, as_energy
from pas.fairing.prepared import SETTINGS, FitSettings
from pas.fairing.solver import FitSolver, FittedMember
from pas.fairing.wishes import MeanAlpha, UnitCoefficients, Wishes
from pas.limits import WorkLimits, checkpoint, limited, note, part, stage_line
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.piecewise import PiecewiseSurface
from pas.shape import Shape
from pas.surface.fairness import Fairness
from pas.surface.fairness_limits import FairnessLimits
from pas.verdicts import Status

OnStage = Callable[[str, float], None]
"""Called at the end of each stage with its name and seconds."""


@dataclass
class Stages:
    """Seconds spent in each stage, told to a listener as they end."""

    listener: OnStage | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.listener is not None and not callable(self.listener):
            raise TypeError(f"on_stage must be a function of a stage's name and seconds, not {shown(self.listener)}")

    @contextmanager
    def stage(self, name: str, share: float, detail: str = "") -> Iterator[None]:
        """Count the time of a block as stage `name`, and as a part of the work: a share of what is left.

        The shares are those of the seconds of corners and nodes, every other one of which is fair at the first degree
        that is proved.
        """
        checkpoint(f"{name}{detail}")
        start = time.perf_counter()
        try:
            with part(share):
                yield
        finally:
            spent = time.perf_counter() - start
            self.seconds[name] = self.seconds.get(name, 0.0) + spent
            note(stage_line(f"{name}{detail}", spent))
            if self.listener is not None:
                self.listener(f"{name}{detail}", spent)


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
    """A surface that was chosen from a space, with how it was chosen and what is known of it; see `pas.Blend`.

    `reason` says which kind of junction was taken and why, where somebody chose between kinds; files do not keep it.
    """

    surface: PiecewiseSurface
    find_coefficients: Callable[[], Sequence[fmpq]]
    energy: float
    timings: dict[str, float]
    attempts: tuple[Attempt, ...]
    wishes: Wishes
    find_space: Callable[[], Space]
    basis: tuple[Member, ...] | None = None
    choice: FittedMember | None = None
    stored: Certificate | None = None
    found_dimension: int | None = None
    reason: str = ""

    @classmethod
    def of(
        cls,
        space: Space,
        choice: FittedMember,
        wishes: Wishes,
        timings: dict[str, float],
        attempts: Sequence[Attempt],
    ) -> Self:
        """The blend of a choice in a solution space."""
        working, change = choice.working, space.prepared.basis.change
        return cls(
            surface=choice.surface,
            find_coefficients=lambda: list((working * change.matrix).entries()),
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
        """The dimension of the solution space."""
        return self.space.dimension if self.found_dimension is None else self.found_dimension

    @cached_property
    def coefficients(self) -> tuple[Fraction, ...]:
        """The member's coefficients in `space.basis`, exact; worked out when first asked for."""
        return tuple(map(to_fraction, self.find_coefficients()))

    @cached_property
    def space(self) -> Space:
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
        """The limits within which it counts as fair: those wished for, or the usual ones of its order."""
        return self.wishes.limits_at(self.surface.placed)

    @property
    def standing(self) -> str:
        """The state of its proof, without working on it: "proved", "not proved yet", "refuted" or "undecided"."""
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

    @limited("simplifying a blend", "a larger denominator")
    def simplified(self, denominator: int = 1000, **limits: Unpack[WorkLimits]) -> Self:
        """A blend of this degree near this one whose polynomials have short coefficients, proved anew: for papers,
        files and speed.

        It has coefficients of that `denominator` in `space.reduced()`, the basis of shortest polynomials: whole
        multiples of a power of ten over it for each member, which moves no coefficient of a polynomial by much more
        than the largest one over `denominator`.  Points to pass through stay exact, those inside and outside on their
        sides; energy and fairness are measured anew.  Nearly all of the time goes into that basis.

        Raises `NotProvedError` where something that is proved of this blend is not proved of that one, which says what,
        and which power of ten is enough (its `blend` is the `PiecewiseSurface` that was found); `ValueError` for a
        denominator that is no whole number from 1 to 10^9, for a blend with handles, coefficients or a value that were
        given, and for one from a file whose surface is not of its space.
        """
        surface = simplified(self.surface, self.space, self.wishes, denominator)
        return replace(
            self,
            surface=surface,
            find_coefficients=lambda: [rational(c) for c in self.space.coordinates(surface.polynomials)],
            energy=FitSolver(self.space.prepared, self.wishes).energy_of(surface),
            choice=None,
            stored=None,
        )

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self,
        tolerance: Exact | None = None,
        *,
        max_triangles: int | None = None,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """The surface's mesh; see `PiecewiseSurface.mesh`."""
        return self.surface.mesh(tolerance, max_triangles=max_triangles, quality=quality)

    def __repr__(self) -> str:
        s = self.surface
        dimension = "" if self.found_dimension is None else f", dimension {self.found_dimension}"
        return f"<Blend GC^{s.order}, degree {s.degree}{dimension}, {self.standing}>"


B = TypeVar("B", bound=ChosenBlend)


def choose(blends: type[B], space: Space, wishes: Wishes, stages: Stages, settings: FitSettings = SETTINGS) -> B:
    """The blend of the member that meets wishes best, which are settled and known not to contradict by themselves.

    Raises `InfeasibleError` and `NotProvedError`.
    """
    began = time.perf_counter()
    if wishes.basis is not None:
        space = space.restricted(wishes.basis)
    stage = "fit and prove" if wishes.prove else "fit"  # a member that is not proved is moved further in
    with stages.stage(stage, 0.5, f" (degree {space.degree}, dimension {space.dimension})"):
        fitted = FitSolver(space.prepared, wishes, settings).fitted()
        space.prepared.forget()
    certificate = fitted.surface.certificate if wishes.prove else None
    outcome = "fitted" if certificate is None else "proved"
    attempt = Attempt(space.degree, space.dimension, outcome, time.perf_counter() - began, space.partition.title)
    result = blends.of(space, fitted, wishes, stages.seconds, (attempt,))
    if certificate is not None and not certificate.proved:
        failed = next(v for v in certificate.verdicts if not v.proved)
        raise NotProvedError(f"the surface of degree {space.degree} is not proved: {failed}", result)
    return result


def simplified(surface: PiecewiseSurface, space: Space, wishes: Wishes, denominator: int) -> PiecewiseSurface:
    """The member with coefficients of that denominator which is nearest to one; see `pas.Blend.simplified`."""
    digits = 9  # of the largest denominator: a choice in doubles has no more that mean anything
    whole(denominator, "denominator", 1, 10**digits)
    if wishes.handles or wishes.coefficients or not isinstance(wishes.normalize, MeanAlpha | UnitCoefficients):
        raise ValueError("what handles, coefficients or a normalisation fix at a number is lost in shorter numbers")
    space = (space.through(wishes.through) if wishes.through else space).reduced()
    exact = [rational(c) for c in space.coordinates(surface.polynomials)]
    largest = _power_of_ten(c for patch in surface.patches for c in patch.raw.coeffs())
    rows = zip(*(patch.tolist() for patch in space.patches), strict=True)
    units = [fmpq(10) ** (largest - _power_of_ten(chain(*row))) for row in rows]

    def member(denominator: int) -> PiecewiseSurface:
        checkpoint(f"proving with the denominator {denominator}")
        steps = [unit / denominator for unit in units]
        return space.member([(c / s + fmpq(1, 2)).floor() * s for c, s in zip(exact, steps, strict=True)])

    found = member(denominator)
    lost = _lost(surface, found, wishes)
    if lost:
        larger = (10**more for more in range(len(str(denominator)), digits + 1))
        enough = next((d for d in larger if not _lost(surface, member(d), wishes)), None)
        hint = f"{enough} is enough" if enough else f"nor is one up to {10**digits} enough"
        raise NotProvedError(f"coefficients of the denominator {denominator} are too short: {lost}; {hint}", found)
    return found


def _lost(surface: PiecewiseSurface, found: PiecewiseSurface, wishes: Wishes) -> str:
    """The claims that hold of one surface and not of another, as the end of a sentence; empty without any."""
    try:
        check_kept(wishes, found)
    except ValueError as error:
        return str(error)
    proved = {verdict.claim for verdict in surface.certificate.verdicts if verdict.proved}
    return next((str(v) for v in found.certificate.verdicts if v.claim in proved and not v.proved), "")


def _power_of_ten(numbers: Iterable[fmpq]) -> int:
    """The exponent of a power of ten near the largest of some numbers, which are not all zero."""
    return floor(binary_exponent(max(map(abs, numbers))) * log10(2))
