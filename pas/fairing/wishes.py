"""The user's wishes for the shape: points, handles, coefficients, a normalisation, an energy, and proofs or none.

`PointOptions` and `Options` are the one list of these options; `Wishes` is what they come to.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any, TypedDict, Unpack

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.inputs import check_flag, set_fields, shown
from pas.algebra.rational import Exact, Vector, VectorLike, amount, listed, plain, rational, to_float, vector
from pas.arrays import AnyArray
from pas.errors import meant
from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.energy import Energy, as_energy
from pas.fairing.functionals import Handle
from pas.partition.cells import Region
from pas.surface.fairness_limits import FairnessLimits, check_limits, neighbour
from pas.surface.placed import PlacedContacts

Points = tuple[Vector, ...]

DEFAULT_MARGIN = 1e-4
"""How far `inside` and `outside` points are kept from the surface, over the radius of the region:
far enough for rounding not to move them across, and for solvers to see a contradiction."""

DEFAULT_NEAR_WEIGHT = fmpq(100)
"""The weight of squared values at `near` points, over the energy: members then pass within about 1e-2 of them."""

POINTS = ("inside", "outside", "through", "near")
"""The kinds of points."""

KINDS = ("inside", "outside", "through", "handles", "coefficients")
"""Constraints that must hold; `near` is least squares."""


@dataclass(frozen=True)
class MeanAlpha:
    """The mean of alpha over all contact curves is 1, each contact being scaled to unit mean
    gradient on its curve: so f is near the distance from the contacts, and not a multiple."""


@dataclass(frozen=True)
class SumOfCoefficients:
    """The coefficients in the basis of the solution space add up to 1 (depends on the basis)."""


@dataclass(frozen=True)
class ValueAt:
    """The surface's function has the given value at a point (three exact numbers)."""

    point: Vector
    value: fmpq = fmpq(-1)

    def __init__(self, point: VectorLike, value: Exact = -1) -> None:
        set_fields(self, point=vector(point, "point"), value=rational(value, "value"))
        if self.value == 0:
            raise ValueError("value must not be 0, or the zero function would be an answer")


@dataclass(frozen=True)
class UnitCoefficients:
    """The coefficients of the polynomials have Euclidean length 1 (over all monomials and pieces).

    With points to be `near` and no energy this is the least-squares fit with the normalised
    distance `sum w f(p)^2 / |f|^2`, a generalised Rayleigh quotient (Lou, Feng, Chen and Deng 2002).
    """


Normalization = MeanAlpha | SumOfCoefficients | ValueAt | UnitCoefficients

PointsLike = Sequence[Any] | AnyArray
"""Points as users write them: sequences of three numbers each (or an array), or a single one."""


class PointOptions(TypedDict, total=False):
    """The options that shape a surface by points, handles and coefficients; see `Wishes`."""

    inside: PointsLike
    outside: PointsLike
    through: PointsLike
    near: PointsLike
    near_weight: Any
    handles: Mapping[Handle, Any] | Sequence[tuple[Handle, Any]]
    coefficients: Mapping[int, Any] | Mapping[str, Any] | Sequence[tuple[int, Any]]
    margin: Any
    normalize: Normalization | None


class Sliders(PointOptions, total=False):
    """The options that can be moved on a blend that is there; see `Wishes`."""

    tension: Exact


class Options(Sliders, total=False):
    """All options that shape a surface; see `Wishes`."""

    energy: Energy | None
    limits: FairnessLimits | None
    prove: bool
    guard: bool
    basis: Sequence[Any] | None


def check_point_options(options: Mapping[str, Any], known: type = PointOptions) -> None:
    """Raise `TypeError` for an option that is none of `PointOptions`, or of a class with more."""
    there = known.__annotations__
    for name in options:
        if name not in there:
            guess = "" if name in Options.__annotations__ else meant(name, there)
            raise TypeError(f"there is no option {name!r} here" + (guess or f"; there are {', '.join(there)}"))


@dataclass(frozen=True, init=False)
class Wishes:
    """Conditions on the member to choose and options of the choice, exact, in the user's coordinates.

    - `inside`, `outside`, `through`, `near`: points, three exact numbers each.  f <= -margin at
      those inside, f >= margin at those outside, f = 0 exactly at those to pass through; to those
      near f is fitted by least squares, `sum w_i f(p_i)^2` being added to the energy.
    - `near_weight` (100): the w_i, one number for all points or one for each.
    - `margin`: by default `DEFAULT_MARGIN` times the region's radius.
    - `handles`: B-coefficients (cell, multi-index) mapped to the values that they get exactly.
    - `coefficients`: numbers of members of the space's basis, from 0, mapped to the values that their coefficients get
      exactly; beside the usual normalisation one of them must stay free, which fixes the scale.
    - `normalize`: what fixes the scale of f (`pas.MeanAlpha()` by default).
    - `energy`: what is minimised: by default `pas.CurvatureVariation()`, that of the surface, where there is
      a centre to see it from and guard rows to keep one sheet, and else `pas.ThinPlate()`.
    - `tension` (no field): that of the curvature variation, from 0 (full) over 23/5 (as usual) up (slim).
    - `limits`: those of fairness (`pas.FairnessLimits.of_order` by default): what is beyond
      them is pressed back, and the degree raised where none is given.
    - `prove`: whether the surface must pass every proof; `guard`: whether conditions at sample
      points ask for what the proofs do.
    - `basis`: members, each one polynomial a piece, to whose span a given degree is restricted.

    Options not given have their defaults.  Raises `ValueError` and `TypeError`, which name the option.
    """

    inside: Points = ()
    outside: Points = ()
    through: Points = ()
    near: Points = ()
    near_weight: fmpq | tuple[fmpq, ...] = DEFAULT_NEAR_WEIGHT
    handles: tuple[tuple[Handle, fmpq], ...] = ()
    coefficients: tuple[tuple[int, fmpq], ...] = ()
    margin: fmpq | None = None
    normalize: Normalization = field(default_factory=MeanAlpha)
    energy: Energy | None = None
    limits: FairnessLimits | None = None
    prove: bool = True
    guard: bool = True
    basis: tuple[Any, ...] | None = None

    __repr__ = brief

    def __init__(self, **options: Unpack[Options]) -> None:
        known = [*(f.name for f in fields(self)), "tension"]
        for name in options:
            if name not in known:
                raise TypeError(f"there is no option {name!r}{meant(name, known)}")
        for f in fields(self):
            default = f.default if f.default_factory is MISSING else f.default_factory()
            object.__setattr__(self, f.name, options.get(f.name, default))
        if options.get("tension") is not None:
            object.__setattr__(self, "energy", tensed(self.energy, options["tension"]))
        self._settle()

    def _settle(self) -> None:
        """Bring what the user wrote into its exact form, checked."""
        settled: dict[str, Any] = {kind: exact_points(getattr(self, kind), kind) for kind in POINTS}
        settled["near_weight"] = _weights(self.near_weight, len(settled["near"]))
        what = "(cell, multi-index of four numbers) to values, as in {(0, (3, 0, 0, 0)): 1}"
        settled["handles"] = _pairs(self.handles, _handle, "handles", what)
        what = "numbers of members, from 0, to values, as in {0: '1/2', 3: 2}"
        settled["coefficients"] = _pairs(self.coefficients, _member, "coefficients", what)
        settled["margin"] = None if self.margin is None else amount(self.margin, "margin")
        settled["normalize"] = MeanAlpha() if self.normalize is None else self.normalize
        settled["energy"] = None if self.energy is None else as_energy(self.energy)
        settled["limits"] = None if self.limits is None else check_limits(self.limits)
        settled["basis"] = None if self.basis is None else _members(self.basis)
        settled |= {name: check_flag(getattr(self, name), name) for name in ("prove", "guard")}
        set_fields(self, **settled)
        if not isinstance(self.normalize, Normalization):
            raise TypeError(
                "normalize must be pas.MeanAlpha(), pas.SumOfCoefficients(), pas.UnitCoefficients() or "
                f"pas.ValueAt(...), not {self.normalize!r}"
            )
        if self.prove and not self.guard:
            raise ValueError("prove=True needs guard=True: without guard rows a proof would pass by luck only")

    def changed(self, **options: Unpack[Options]) -> Wishes:
        """These wishes with some options changed."""
        own: Any = {f.name: getattr(self, f.name) for f in fields(self)}
        return Wishes(**(own | options))

    @property
    def plain(self) -> Wishes:
        """These wishes without points, handles and coefficients."""
        asked: Any = dict.fromkeys((*KINDS, "near"), ())
        return self.changed(**asked, near_weight=DEFAULT_NEAR_WEIGHT, margin=None)

    def settled(self, placed: PlacedContacts) -> Wishes:
        """These wishes with the energy that is made small in a place where none is given."""
        if self.energy is not None:
            return self
        seen = placed.partition.center is not None and placed.partition.cells and placed.joins
        fitting = self.guard and not isinstance(self.normalize, UnitCoefficients)
        confined = seen and fitting and all(join.confined for join in placed.joins)
        return self.changed(energy=CurvatureVariation() if confined else as_energy(None))

    def limits_at(self, placed: PlacedContacts) -> FairnessLimits:
        """Up to what a surface in a place counts as fair: what is wished, or what is usual."""
        if self.limits is not None:
            return self.limits
        if not isinstance(placed.partition, Region):
            return FairnessLimits.of_order(placed.order)
        scale = to_float(placed.partition.frame.scale)
        return FairnessLimits.of_node(placed.order, [neighbour(join, scale) for join in placed.joins])

    @property
    def near_weights(self) -> tuple[fmpq, ...]:
        """The weight of each point to be near."""
        return self.near_weight if isinstance(self.near_weight, tuple) else (self.near_weight,) * len(self.near)

    def hard(self) -> Iterator[tuple[str, int]]:
        """The points that must hold, as (kind, index)."""
        for kind in KINDS:
            for index in range(len(getattr(self, kind))):
                yield kind, index

    def without(self, dropped: Sequence[tuple[str, int]]) -> Wishes:
        """These wishes less some points."""

        def kept(kind: str) -> Any:
            return tuple(p for i, p in enumerate(getattr(self, kind)) if (kind, i) not in dropped)

        options: Any = {kind: kept(kind) for kind in KINDS}
        return self.changed(**options)

    def describe(self, item: tuple[str, int]) -> str:
        """A constraint in words: 'inside (1/2, 0, 0)', 'handle 0, (3, 0, 0, 0) = 1'."""
        kind, index = item
        if kind == "handles":
            (cell, corners), value = self.handles[index]
            return f"handle {cell}, {corners} = {plain(value)}"
        if kind == "coefficients":
            number, value = self.coefficients[index]
            return f"coefficient {number} = {plain(value)}"
        return f"{kind} ({listed(getattr(self, kind)[index])})"


def check_member(number: int, dimension: int) -> int:
    """The number of a member of a basis; raises `ValueError` where there are not as many."""
    if number >= dimension:
        raise ValueError(f"coefficients[{number}] is that of no member: they are numbered from 0 to {dimension - 1}")
    return number


def tensed(energy: Energy | None, tension: Exact) -> Energy:
    """The usual energy of the surface, or one given, with another tension.

    Raises `ValueError` for an energy that has none, and for a tension that is negative.
    """
    if not isinstance(energy, CurvatureVariation | None):
        raise ValueError(
            f"tension is that of pas.CurvatureVariation(), and the energy {energy.kind!r} has none: "
            "leave one of them away"
        )
    return replace(energy or CurvatureVariation(), tension=tension)


def as_wishes(wishes: Any) -> Wishes:
    """The wishes given, or those without any; raises `TypeError` for anything else."""
    if not isinstance(wishes, Wishes | None):
        raise TypeError(f"wishes must be pas.Wishes(...) or None, not {shown(wishes)}")
    return wishes or Wishes()


def exact_points(value: Any, name: str) -> Points:
    """Points of three exact numbers each, or a single one; raises `TypeError` and `ValueError`, which name them."""
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise TypeError(f"{name} must be a sequence of points, each three numbers, not {shown(value)}")
    if len(value) == 3 and not any(hasattr(entry, "__len__") and not isinstance(entry, str) for entry in value):
        return (vector(value, name),)
    return tuple(vector(point, f"{name}[{i}]") for i, point in enumerate(value))


def _weights(value: Any, count: int) -> fmpq | tuple[fmpq, ...]:
    """One weight, or where they differ one for each point."""
    if not hasattr(value, "__len__") or isinstance(value, str):
        weights: tuple[fmpq, ...] = (amount(value, "near_weight"),)
    elif len(value) != count:
        raise ValueError(f"near_weight must be one number, or one for each of the {count} near points")
    else:
        weights = tuple(amount(w, f"near_weight[{i}]") for i, w in enumerate(value))
    if not weights:
        return DEFAULT_NEAR_WEIGHT
    return weights[0] if all(w == weights[0] for w in weights) else weights


def _members(value: Any) -> tuple[Any, ...]:
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise TypeError(f"basis must be a sequence of members, each one polynomial a piece, not {shown(value)}")
    members = tuple(value)
    if not members:
        raise ValueError("basis must have at least one member")
    return members


def _pairs(value: Any, read: Callable[[Any], Any], name: str, what: str) -> tuple[tuple[Any, fmpq], ...]:
    """Pairs of a key and a number from a table or pairs, the key as `read` makes it; `what` says what is right."""
    items, result = value.items() if isinstance(value, Mapping) else value, []
    for item in items if isinstance(items, Iterable) else (items,):
        try:
            key, number = item
            known = read(key)
        except (TypeError, ValueError):
            raise ValueError(f"{name} must map {what}, not {shown(item)}") from None
        result.append((known, rational(number, f"{name}[{known}]")))
    return tuple(result)


def _handle(key: Any) -> Handle:
    cell, (i, j, k, m) = key
    return int(cell), (int(i), int(j), int(k), int(m))


def _member(key: Any) -> int:
    number = int(key) if isinstance(key, str) else operator.index(key)  # in files, keys are texts
    if number < 0:
        raise ValueError("a negative number")
    return int(number)
