"""The whole method on one screen: problem -> space -> fit -> proved surface.

`blend` raises the degree until a member of the solution space passes every proof, so the degree
it returns is the lowest at which this program found one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

from flint import fmpq_mat

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree, check_order
from pas.algebra.rational import to_fraction
from pas.blending.place import place
from pas.blending.solutions import solve
from pas.blending.space import Member, SolutionSpace
from pas.errors import InfeasibleError, NoSolutionError, NotProvedError
from pas.fairing.constraints import Constraints, Normalization
from pas.fairing.contradictions import check_wishes
from pas.fairing.energy import ThinPlate
from pas.fairing.fairing import Choice
from pas.limits import Report, checkpoint, limited, note, stage_line
from pas.partition.cells import Partition
from pas.solid.solid import Solid
from pas.surface.certificate import Certificate
from pas.surface.piecewise import PiecewiseSurface

DEGREES_TRIED = 4
"""Degrees with regular members that are tried before giving up; corners needed at most three."""

OnStage = Callable[[str, float], None]
"""Called at the end of each stage with its name and seconds."""


@dataclass(frozen=True)
class Attempt:
    """One degree that was tried: the dimension of its space and what came of it."""

    degree: int
    dimension: int
    outcome: str


@dataclass(frozen=True)
class Wishes:
    """What the user wants of the member that is chosen."""

    constraints: Constraints
    plate: ThinPlate
    prove: bool
    guard: bool

    @classmethod
    def of(
        cls,
        *,
        energy: ThinPlate | None = None,
        prove: bool = True,
        guard: bool = True,
        **points: Any,
    ) -> Wishes:
        """The wishes from the options of `blend`, checked."""
        if energy is not None and not isinstance(energy, ThinPlate):
            raise TypeError(f"energy must be a pas.ThinPlate or None, not {energy!r}")
        if prove and not guard:
            raise ValueError("prove=True needs guard=True: without guard rows a proof would pass by luck only")
        return cls(Constraints.of(**points), energy or ThinPlate(), prove, guard)


@dataclass
class Stages:
    """Seconds spent in each stage, told to a listener as they end."""

    listener: OnStage | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str, detail: str = "") -> Iterator[None]:
        """Count the time of a block as stage `name`."""
        checkpoint(f"{name}{detail}")
        start = time.perf_counter()
        try:
            yield
        finally:
            spent = time.perf_counter() - start
            self.seconds[name] = self.seconds.get(name, 0.0) + spent
            note(stage_line(f"{name}{detail}", spent))
            if self.listener is not None:
                self.listener(f"{name}{detail}", spent)


@dataclass(frozen=True, eq=False)
class Blend:
    """One chosen surface with everything known about it.

    `space` and `coefficients` (exact, in `space.basis`) say how it was chosen, `dimension` out of
    how many, and `energy` is its thin-plate energy in the user's units.  `basis` is the space's
    where the user gave it.  `timings` maps stages to seconds, `attempts` lists the degrees tried.
    `stored` are the verdicts in the file that it was loaded from: what somebody found once, and no proof.
    """

    surface: PiecewiseSurface
    dimension: int
    coefficients: tuple[Fraction, ...]
    energy: float
    timings: dict[str, float]
    attempts: tuple[Attempt, ...]
    constraints: Constraints
    plate: ThinPlate
    basis: tuple[Member, ...] | None = None
    known_space: SolutionSpace | None = None
    choice: Choice | None = None
    stored: Certificate | None = None

    @cached_property
    def space(self) -> SolutionSpace:
        """The solution space it was chosen from (solved again after loading from a file)."""
        if self.known_space is not None:
            return self.known_space
        s = self.surface
        space = solve(s.partition, s.contacts, s.order, s.degree)
        return space if self.basis is None else space.restricted(self.basis)

    @property
    def certificate(self) -> Certificate:
        """The verdicts on the surface, proved in this process, when first asked for."""
        return self.surface.certificate

    def refit(self, **options: Any) -> Blend:
        """The same problem with other points, weights or normalisation, without new proofs.

        Keeps the guard rows of this blend, so it takes milliseconds: made for sliders.  `options`
        are `inside`, `outside`, `through`, `near`, `near_weight`, `handles`, `margin`, `normalize`.
        """
        if self.choice is None:
            raise ValueError("a blend loaded from a file cannot be refitted; use blend.space.fit(...)")
        fairing = self.space.fairing(self.plate)
        changed = Constraints.of(**(_as_options(self.constraints) | options))
        working = fairing.choose(changed, self.choice.rows)
        choice = replace(self.choice, surface=fairing.surface(working), working=working)
        return _finish(self.space, choice, Wishes(changed, self.plate, False, True), {}, self.attempts)

    def solid(self, length: Any = None, names: Sequence[str] | None = None) -> Solid:
        """The solid inside the surface, with its neighbours continued by `length` and capped.

        `length` is in the model's units (by default half of the region's size; 0 ends the solid at the
        clips), `names` are the neighbours' faces ("neighbour 1", ... by default), whose caps are named
        after them ("neighbour 1 end").  The contacts are its joints.  Raises `GeometryError` where
        a clip is no plane or the surface has no region.
        """
        from pas.blending.bodies import body

        return body(self.surface, length, names)

    @limited("writing a project file", "")
    def save(self, path: str | Path, *, seconds: float | None = None, progress: Report | None = None) -> Path:
        """Write the project file (`.pas.json`); returns its path."""
        from pas.blending.project import save

        return save(self, path)

    def __str__(self) -> str:
        from pas.blending.summary import summary

        return summary(self)

    def __repr__(self) -> str:
        s = self.surface
        return f"<Blend GC^{s.order}, degree {s.degree}, dimension {self.dimension}>"


@limited("finding a blend", "a lower order")
def blend(
    contacts: Sequence[Any],
    order: int,
    degree: int | None = None,
    partition: Partition | None = None,
    *,
    energy: ThinPlate | None = None,
    inside: Any = (),
    outside: Any = (),
    through: Any = (),
    near: Any = (),
    near_weight: Any = 100,
    handles: Any = (),
    margin: Any = None,
    normalize: Normalization | None = None,
    prove: bool = True,
    guard: bool = True,
    basis: Sequence[Sequence[Any]] | None = None,
    on_stage: OnStage | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Blend:
    """Find, choose and prove the blend of three pipes or contacts.

    `contacts` are pipes, contacts or pairs (surface, clip), `order` the k of GC^k.  Without a
    `degree` it is raised until the proofs pass.  `energy` is minimised over the members
    (`pas.ThinPlate()` by default).  Points are sequences of three exact numbers: `inside` ones
    get f <= -margin, `outside` ones f >= margin (by default 10^-4 of the region's radius), the surface passes `through`
    others exactly and `near` still others by least squares with weight `near_weight` (or one for
    each).  `handles` maps B-coefficients (cell, multi-index) to values that they get exactly.
    `normalize` fixes the scale of f (`pas.MeanAlpha()` by default).  `basis` (members, each one
    polynomial a cell) restricts a given `degree` to the span of these members.

    With `prove` (the default) the surface returned is proved in every verdict.  Without, it is
    the optimum under sampled conditions, or with `guard=False` under the points alone, and its
    certificate is worked out when asked for.  `on_stage` is told the name and the seconds of each stage
    at its end.

    Raises `GeometryError` (contacts that do not fit), `NoSolutionError` (no usable surface),
    `InfeasibleError` (constraints that contradict), `NotProvedError`; `ValueError` and
    `TypeError` for wrong arguments.
    """
    check_order(order)
    wishes = Wishes.of(
        energy=energy,
        inside=inside,
        outside=outside,
        through=through,
        near=near,
        near_weight=near_weight,
        handles=handles,
        margin=margin,
        normalize=normalize,
        prove=prove,
        guard=guard,
    )
    if basis is not None and degree is None:
        raise ValueError("a basis needs the degree of its members: give degree as well")
    stages = Stages(on_stage)
    with stages.stage("partition"):
        region, turned = place(contacts, partition)
        check_wishes(wishes.constraints, region, turned, proved=prove)
    if order == 0 and len(region.pieces) > 1:
        raise ValueError(
            "order must be at least 1 where the region has several pieces: with order 0 they would meet in creases"
        )
    attempts: list[Attempt] = []
    failure: InfeasibleError | NotProvedError | None = None
    for space in _spaces(region, turned, order, degree, attempts, stages):
        chosen = space if basis is None else space.restricted(basis)
        try:
            return _fit(chosen, wishes, attempts, stages)
        except (InfeasibleError, NotProvedError) as error:
            attempts.append(Attempt(space.degree, space.dimension, str(error)))
            failure = error
    if failure is None and degree is not None:
        raise _too_low(attempts[-1], _lowest(region, turned, order, degree), order)
    raise _given_up(attempts, failure, order)


@limited("choosing a surface", "a lower degree")
def fit(
    space: SolutionSpace,
    *,
    on_stage: OnStage | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Any,
) -> Blend:
    """Choose one member of a solution space.

    `options` are those of `blend` that shape the surface: `energy`, `inside`, `outside`, `through`,
    `near`, `near_weight`, `handles`, `margin`, `normalize`, `prove`, `guard`.
    """
    if space.dimension == 0:
        raise NoSolutionError(f"the solution space of degree {space.degree} is empty", {space.degree: 0})
    wishes = Wishes.of(**options)
    check_wishes(wishes.constraints, space.partition, space.contacts, proved=wishes.prove)
    return _fit(space, wishes, [], Stages(on_stage))


def _spaces(
    region: Partition,
    contacts: Sequence[Any],
    order: int,
    degree: int | None,
    attempts: list[Attempt],
    stages: Stages,
) -> Iterator[SolutionSpace]:
    """Solution spaces with regular members, of rising degree; others are noted as attempts."""
    degrees = range(1, HIGHEST_DEGREE + 1) if degree is None else [check_degree(degree)]
    yielded = 0
    for candidate in degrees:
        with stages.stage("solve", f" (degree {candidate})"):
            space = solve(region, contacts, order, candidate)
            usable = space.regular
        if usable:
            yield space
            yielded += 1
            if yielded == DEGREES_TRIED:
                return
        else:
            reason = "no solution" if space.dimension == 0 else "all members have alpha = 0 on a contact curve"
            attempts.append(Attempt(candidate, space.dimension, reason))


def _fit(space: SolutionSpace, wishes: Wishes, attempts: Sequence[Attempt], stages: Stages) -> Blend:
    with stages.stage("fit", f" (degree {space.degree}, dimension {space.dimension})"):
        fairing = space.fairing(wishes.plate)
        if wishes.prove:
            choice = fairing.choose_proved(wishes.constraints)
        elif wishes.guard:
            choice = fairing.choose_guarded(wishes.constraints)
        else:
            choice = fairing.choose_plain(wishes.constraints)
    history = (*attempts, Attempt(space.degree, space.dimension, "proved" if wishes.prove else "fitted"))
    if not wishes.prove:
        return _finish(space, choice, wishes, stages.seconds, history)
    with stages.stage("prove"):
        certificate = choice.surface.certificate
    result = _finish(space, choice, wishes, stages.seconds, history)
    if not certificate.proved:
        failed = next(v for v in certificate.verdicts if not v.proved)
        raise NotProvedError(f"the surface of degree {space.degree} is not proved: {failed}", result)
    return result


def _finish(
    space: SolutionSpace,
    choice: Choice,
    wishes: Wishes,
    timings: dict[str, float],
    attempts: Sequence[Attempt],
) -> Blend:
    fairing = space.fairing(wishes.plate)
    coefficients: fmpq_mat = choice.working * fairing.basis.transform
    return Blend(
        surface=choice.surface,
        dimension=space.dimension,
        coefficients=tuple(to_fraction(c) for c in coefficients.entries()),
        energy=fairing.energy_of(choice.working),
        timings=timings,
        attempts=tuple(attempts),
        constraints=wishes.constraints,
        plate=wishes.plate,
        basis=space.given_basis,
        known_space=space,
        choice=choice,
    )


def _lowest(region: Partition, contacts: Sequence[Any], order: int, degree: int) -> int | None:
    """The lowest degree above `degree` with a regular member, if it is not far."""
    above = range(degree + 1, HIGHEST_DEGREE + 1)
    return next((n for n in above if solve(region, contacts, order, n).regular), None)


def _too_low(attempt: Attempt, lowest: int | None, order: int) -> NoSolutionError:
    known = f"the lowest degree with solutions is {lowest}" if lowest else "nor has a higher one"
    return NoSolutionError(
        f"no usable surface of degree {attempt.degree} meets the contacts with GC^{order} "
        f"(degree {attempt.degree}: dimension {attempt.dimension}, {attempt.outcome}); {known}",
        {attempt.degree: attempt.dimension},
    )


def _given_up(attempts: Sequence[Attempt], failure: InfeasibleError | NotProvedError | None, order: int) -> Exception:
    tried = "; ".join(f"degree {a.degree}: dimension {a.dimension}" for a in attempts)
    if failure is None:
        return NoSolutionError(
            f"no usable surface meets the contacts with GC^{order} ({tried}); a higher degree may have one",
            {a.degree: a.dimension for a in attempts},
        )
    text = f"{failure} (tried {tried})"
    if isinstance(failure, NotProvedError):
        return NotProvedError(text, failure.blend)
    return InfeasibleError(text, failure.conflict)


def _as_options(constraints: Constraints) -> dict[str, Any]:
    names = ("inside", "outside", "through", "near", "handles", "margin", "normalize")
    options = {name: getattr(constraints, name) for name in names}
    if constraints.near_weights:
        same = len(set(constraints.near_weights)) == 1
        options["near_weight"] = constraints.near_weights[0] if same else constraints.near_weights
    return options
