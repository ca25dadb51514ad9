"""Energies: functionals that are minimised when a member of a solution space is chosen.

An energy is one class in one file (`examples/extensions/values.py` is one from outside).  It says by which name files
know it (`kind`), its quadratic form on a working basis, its exact one where it has one, and, unless it is a dataclass
of numbers and texts, how it is written as a table of plain data and read from one.  Registered, it is known to
`pas.blend`, project files and problem files.  Sums of energies and their multiples by numbers >= 0 are energies.

An energy has two parts, of which most have one: a quadratic form of the function f (`hessian`), and an
integral over the surface f = 0 of squared residuals (`residuals`), which see its differential geometry.  The
first is made small by one quadratic programme, the second by Gauss-Newton steps around it
(`pas.fairing.solver`), each of which takes `1/2 |r + J (x - q)|^2` for the energy near a member q.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction
from math import sqrt
from typing import Any, ClassVar, Protocol

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.inputs import shown
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, plain, rational, to_float
from pas.fairing.basis import WorkingBasis
from pas.fairing.surface_points import Sizes, SurfacePoints, differences
from pas.partition.cells import Partition
from pas.registry import Registry, Serialisable, read_record

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
        """What is squared, summed and integrated over the surface, at points of it: (N, R)."""
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
        """See `Energy.hessian`."""
        first, *others = (to_float(times) * energy.hessian(basis) for times, energy in self.terms)
        return sum(others, first)

    def residuals(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        """See `Energy.residuals`."""
        return np.concatenate([root * energy.residuals(points, sizes) for root, energy in self._roots()], axis=1)

    def slopes(self, points: SurfacePoints, sizes: Sizes) -> Floats:
        """See `Energy.slopes`."""
        return np.concatenate([root * energy.slopes(points, sizes) for root, energy in self._roots()], axis=1)

    def _roots(self) -> list[tuple[float, Energy]]:
        return [(sqrt(to_float(times)), energy) for times, energy in self.terms]

    @property
    def on_surface(self) -> bool:
        """See `Energy.on_surface`."""
        return any(energy.on_surface for _, energy in self.terms)

    def products(self, members: Members) -> fmpq_mat:
        """See `Energy.products`."""
        first, *others = (energy.products(members) * times for times, energy in self.terms)
        return sum(others, first)

    def to_record(self) -> dict[str, Any]:
        """See `Energy.to_record`."""
        terms = [{"times": plain(times), "energy": energy.to_record()} for times, energy in self.terms]
        return {"kind": self.kind, "terms": terms}

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Combination:
        """See `Energy.from_record`."""
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
