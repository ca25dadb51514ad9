"""Energies: functionals that are minimised when a member of a solution space is chosen.

An energy is one class in one file (`examples/extensions/values.py` is one from outside).  It says by which name files
know it (`kind`), its quadratic form on a working basis, its exact one where it has one, and, unless it is a dataclass
of numbers and texts, how it is written as a table of plain data and read from one.  Registered, it is known to
`pas.blend`, project files and problem files.  Sums of energies and their multiples by numbers >= 0 are energies.

An energy has two parts, of which most have one: a quadratic form of the function f (`hessian`), and an
integral over the surface f = 0 of squared residuals (`residuals`), which see its differential geometry.  The
first is made small by one quadratic programme, the second by Gauss-Newton steps around it
(`pas.fairing.solver`), each of which takes `1/2 |r + J (x - q)|^2` for the energy near a member q.

What an energy sees of a surface is its differential geometry at sample points, `SurfacePoints`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import sqrt
from typing import Any, ClassVar, Protocol

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.inputs import shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, plain, rational, to_float
from pas.arrays import Floats
from pas.fairing.basis import WorkingBasis
from pas.partition.cells import Partition
from pas.registry import Registry, Serialisable, read_record
from pas.surface.straight_runs import StraightRun

QUADRATIC = "thin-plate"
"""The kind of energy that is made small where nobody says which and it must be a quadratic form."""


class Members(Protocol):
    """Piecewise polynomials of one degree, exact, in the user's coordinates, as a solution space has them."""

    @property
    def partition(self) -> Partition:
        """The region and its pieces."""

    @property
    def degree(self) -> int:
        """The highest degree."""

    @property
    def basis(self) -> tuple[tuple[Polynomial, ...], ...]:
        """The members: one polynomial for each piece."""


class Energy(Serialisable):
    """What is made small: a quadratic form on piecewise polynomials f, `1/2 q^T H q`, plus an integral over f = 0.

    A class of energies gives `hessian`, or `residuals`, or both, in the user's units.  Energies are immutable and
    can be compared; a frozen dataclass whose fields are exact numbers, whole numbers or texts is written and
    read by what is here.
    """

    kind: ClassVar[str]
    """The name by which files know the class."""

    def hessian(self, basis: WorkingBasis) -> Floats:
        """The matrix H (m, m), symmetric and positive semidefinite, for coefficients q in a working basis."""
        return np.zeros((basis.size, basis.size))

    def residuals(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        """The residuals (N, R) at points of the surface, whose squares are summed and integrated over it."""
        return np.zeros((len(points), 0))

    def slopes(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        """The derivatives (N, R, 14) of the residuals by `points.quantities`; differences, where a class has no own."""
        return differences(lambda moved: self.residuals(moved, sizes), points)

    @property
    def on_surface(self) -> bool:
        """Whether it has a part that is an integral over the surface."""
        return type(self).residuals is not Energy.residuals

    def products(self, members: Members) -> fmpq_mat:
        """The energy's matrix over a basis of members, exact: (dimension, dimension).

        Raises `ValueError` for an energy that has no exact form.
        """
        raise ValueError(f"the energy {self.kind!r} has no exact form; choose by it with `fit` or `blend`")

    def to_record(self) -> dict[str, Any]:
        """The energy as a table of plain data, exact numbers as texts."""
        if not is_dataclass(self):
            raise TypeError(f"the energy {self.kind!r} is no dataclass, so it must say how it is written (to_record)")
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        written = {name: plain(v) if isinstance(v, fmpq | Fraction) else v for name, v in values.items()}
        return {"kind": self.kind, **written}

    def __add__(self, other: Energy) -> Combination:
        return Combination((*terms_of(self), *terms_of(other))) if isinstance(other, Energy) else NotImplemented

    def __mul__(self, times: Exact) -> Combination:
        return Combination(tuple((rational(times, "the multiple") * own, energy) for own, energy in terms_of(self)))

    __rmul__ = __mul__

    def __truediv__(self, by: Exact) -> Combination:
        divisor = rational(by, "the divisor")
        if divisor == 0:
            raise ValueError("an energy cannot be divided by 0")
        return self * (1 / divisor)


@dataclass(frozen=True)
class Combination(Energy):
    """A sum of multiples of energies: `terms` are pairs of a number >= 0 and an energy."""

    kind: ClassVar[str] = "combination"

    terms: tuple[tuple[fmpq, Energy], ...]

    def __post_init__(self) -> None:
        if not self.terms:
            raise ValueError("terms must hold at least one energy")
        if any(times < 0 for times, _ in self.terms):
            raise ValueError("terms must have multiples that are not negative, or the energy has no least value")

    def hessian(self, basis: WorkingBasis) -> Floats:
        first, *others = (to_float(times) * energy.hessian(basis) for times, energy in self.terms)
        return sum(others, first)

    def residuals(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        return np.concatenate([root * energy.residuals(points, sizes) for root, energy in self._roots()], axis=1)

    def slopes(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        return np.concatenate([root * energy.slopes(points, sizes) for root, energy in self._roots()], axis=1)

    def _roots(self) -> list[tuple[float, Energy]]:
        return [(sqrt(to_float(times)), energy) for times, energy in self.terms]

    @property
    def on_surface(self) -> bool:
        return any(energy.on_surface for _, energy in self.terms)

    def products(self, members: Members) -> fmpq_mat:
        first, *others = (energy.products(members) * times for times, energy in self.terms)
        return sum(others, first)

    def to_record(self) -> dict[str, Any]:
        terms = [{"times": plain(times), "energy": energy.to_record()} for times, energy in self.terms]
        return {"kind": self.kind, "terms": terms}

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Combination:
        terms = record["terms"]
        entries = terms if isinstance(terms, list) else [None]
        if not all(isinstance(t, dict) and t.keys() == {"times", "energy"} for t in entries):
            raise ValueError(f"terms must be a list of tables with times and energy, not {shown(terms)}")
        if not all(isinstance(term["energy"], dict) for term in terms):
            raise ValueError("terms must have energies that are tables")
        return cls(tuple((rational(term["times"], "times"), read_energy(term["energy"])) for term in terms))


ENERGIES: Registry[type[Energy]] = Registry(
    "energy",
    {
        "curvature-variation": "pas.fairing.energies.curvature_variation:CurvatureVariation",
        "thin-plate": "pas.fairing.energies.squared_derivatives:ThinPlate",
        "membrane": "pas.fairing.energies.squared_derivatives:Membrane",
        "combination": Combination,
    },
    key="kind",
)
"""The energies that files know, by their kinds."""


def register_energy(energy: type[Energy]) -> type[Energy]:
    """Make a class of energies known to project files and problem files, by its `kind`; returns it.

    Raises `ValueError` for a kind that is taken, `TypeError` for what is no class of energies.
    """
    if not isinstance(energy, type) or not issubclass(energy, Energy):
        raise TypeError(f"energy must be a subclass of pas.Energy, not {shown(energy)}")
    return ENERGIES.register(energy)


def read_energy(record: Mapping[str, Any]) -> Energy:
    """The energy that a table describes.

    Raises `ValueError` or `TypeError`, in sentences that begin with the key at fault.
    """
    return read_record(ENERGIES, record, QUADRATIC)


def as_energy(energy: Any) -> Energy:
    """An energy, the default one for None; raises `TypeError` for anything else."""
    if energy is None:
        return ENERGIES[QUADRATIC]()
    if not isinstance(energy, Energy):
        raise TypeError(f"energy must be a pas.Energy such as pas.ThinPlate(), or None, not {shown(energy)}")
    for _, own in terms_of(energy):
        if type(own).hessian is Energy.hessian and not own.on_surface:
            raise TypeError(f"the energy {own.kind!r} must define hessian(basis), residuals(points, sizes), or both")
    return energy


def terms_of(energy: Energy) -> tuple[tuple[fmpq, Energy], ...]:
    """The energies of which one is a sum of multiples, with these: itself where it is no sum."""
    return energy.terms if isinstance(energy, Combination) else ((fmpq(1), energy),)


QUANTITIES = 14
"""Numbers that `SurfacePoints.quantities` has for each point."""

NAMES = ("points",) * 3 + ("normals",) * 3 + ("gradients",) + ("shape",) * 3 + ("variation",) * 4
"""The array that each quantity belongs to."""


@dataclass(frozen=True, eq=False, repr=False)
class SurfacePoints:
    """The geometry of a surface f = 0 at N points, in the user's units.

    `points` and `normals` (N, 3), which point outwards; `gradients` (N,): |grad f| over its mean on the contact curves;
    `shape` (N, 3): S11, S12, S22 of the shape operator, positive where the surface bends like a ball around
    its inside, in the `frame` (N, 3, 2) of principal directions, the larger curvature first, so that S12 is 0 and
    S11, S22 are the principal curvatures; `variation` (N, 4): C111, C112, C122, C222 of its covariant derivative.

    The sum of squares of what an energy makes of them must not change with a turn of the frame, as that of
    C111, sqrt(3) C112, sqrt(3) C122, C222 does not.
    """

    points: Floats
    normals: Floats
    gradients: Floats
    shape: Floats
    variation: Floats
    frame: Floats

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"<SurfacePoints: {len(self)} points>"

    @property
    def mean_curvatures(self) -> Floats:
        """The mean of the principal curvatures (N,)."""
        return (self.shape[:, 0] + self.shape[:, 2]) / 2

    @property
    def gauss_curvatures(self) -> Floats:
        """The product of the principal curvatures (N,)."""
        return self.shape[:, 0] * self.shape[:, 2] - self.shape[:, 1] ** 2

    @cached_property
    def quantities(self) -> Floats:
        """Points, normals, gradients, shape and variation side by side (N, 14)."""
        return np.concatenate([self.points, self.normals, self.gradients[:, None], self.shape, self.variation], axis=1)

    def with_quantities(self, quantities: Floats) -> SurfacePoints:
        """These points with other quantities (N, 14), in the same frame."""
        q = quantities
        return replace(
            self, points=q[:, :3], normals=q[:, 3:6], gradients=q[:, 6], shape=q[:, 7:10], variation=q[:, 10:14]
        )

    def __getitem__(self, chosen: slice) -> SurfacePoints:
        return replace(self, **{own.name: getattr(self, own.name)[chosen] for own in fields(self)})


@dataclass(frozen=True, eq=False)
class Sizes:
    """Lengths of a problem, in the user's units.

    `radius`: the mean radius of the contact curves; `clip`: the mean distance of their middles from the centre;
    `center` (3,): the centre; `runs`: the straight tubes between contacts in line, relative to it.
    """

    radius: float
    clip: float
    center: Floats = field(default_factory=lambda: np.zeros(3))
    runs: tuple[StraightRun, ...] = ()


STEP = 1e-6
"""The step of differences, over the largest value of the quantity: half of the digits."""


def differences(residuals: Callable[[SurfacePoints], Floats], points: SurfacePoints) -> Floats:
    """The derivatives (N, R, 14) of residuals (N, R) by the quantities, by central differences."""
    start = points.quantities
    sizes = np.abs(start).max(axis=0, initial=0.0)
    columns = []
    for i in range(QUANTITIES):
        step = STEP * (float(sizes[i]) or float(sizes[7:].max(initial=0.0)) or 1.0)
        found = []
        for sign in (1.0, -1.0):
            moved = start.copy()
            moved[:, i] += sign * step
            found.append(residuals(points.with_quantities(moved)))
        columns.append((found[0] - found[1]) / (2 * step))
    return np.stack(columns, axis=2)


def slopes_by_place(values: Callable[[Floats], Floats], points: Floats, step: float) -> Floats:
    """The derivatives (N, ..., 3) of values (N, ...) at points (N, 3) by these, by central differences."""
    moved = points + step * np.concatenate([np.eye(3), -np.eye(3)])[:, None]
    found = values(moved.reshape(-1, 3))
    ahead, behind = found.reshape(2, 3, len(points), *found.shape[1:])
    return np.moveaxis((ahead - behind) / (2 * step), 0, -1)
