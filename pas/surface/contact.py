"""Contacts: the surfaces that a blend continues, and where each ends.

A contact is a surface `f = 0` with a clip `h = 0`; the blend continues the surface with GC^k
along the curve V(f, h).  Signs: `f < 0` inside, `f > 0` outside; `h < 0` on the blend's side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, TypeAlias, runtime_checkable

from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import Exact, Vector, VectorLike, dot, plain, rational, vector


@dataclass(frozen=True)
class Contact:
    """A surface and its clip, each anything that `Polynomial` takes.

    Raises `ValueError` where one of them is constant or they have a common factor (a clip that
    contains its surface).
    """

    surface: Polynomial
    clip: Polynomial

    __repr__ = brief

    def __init__(self, surface: Any, clip: Any) -> None:
        object.__setattr__(self, "surface", _equation(surface, "surface"))
        object.__setattr__(self, "clip", _equation(clip, "clip"))
        common = self.surface.raw.gcd(self.clip.raw)
        if not common.is_constant():
            raise ValueError(
                f"the clip {self.clip} and the surface {self.surface} have the common factor "
                f"{common}; a clip must cut its surface in a curve"
            )

    def __str__(self) -> str:
        return f"{self.surface} = 0 up to {self.clip} = 0"


@runtime_checkable
class HasContact(Protocol):
    """Anything that stands for a contact, such as a `Pipe`."""

    @property
    def contact(self) -> Contact:
        """The contact."""


@dataclass(frozen=True)
class Pipe:
    """An infinite circular cylinder, cut off by a plane normal to its axis.

    `axis` is its direction (any nonzero rational vector, of any length), `radius` its radius,
    `point` a point on its axis.  The clip plane passes through `point + clip * axis`; the blend's
    side of it is the one with `point` (the side in the direction of -axis where `clip` is 0).
    All numbers are exact (see `pas.Polynomial`).  Its polynomials are rational, since nothing is
    normalised by a square root: `|w|^2 - (w . axis)^2 / |axis|^2 - radius^2` with `w = x - point`.

    Raises `ValueError` for a zero axis or a radius that is not positive.
    """

    axis: Vector
    radius: fmpq
    clip: fmpq
    point: Vector = (fmpq(0), fmpq(0), fmpq(0))

    def __init__(self, axis: VectorLike, radius: Exact, clip: Exact, point: VectorLike = (0, 0, 0)) -> None:
        object.__setattr__(self, "axis", vector(axis, "axis"))
        object.__setattr__(self, "radius", rational(radius, "radius"))
        object.__setattr__(self, "clip", rational(clip, "clip"))
        object.__setattr__(self, "point", vector(point, "point"))
        if all(a == 0 for a in self.axis):
            raise ValueError("axis must not be the zero vector")
        if self.radius <= 0:
            raise ValueError(f"radius must be positive, not {plain(self.radius)}")

    @cached_property
    def contact(self) -> Contact:
        """The cylinder and its clip plane as polynomials."""
        length2 = dot(self.axis, self.axis)
        offset = [g - p for g, p in zip(GENERATORS, self.point, strict=True)]
        along = sum((w * a for w, a in zip(offset, self.axis, strict=True)), GENERATORS[0] * 0)
        surface = sum((w * w for w in offset), GENERATORS[0] * 0) - along * along * (1 / length2)
        clip = along - self.clip * length2
        if self.clip < 0:
            clip = -clip
        return Contact(Polynomial.from_raw(surface - self.radius * self.radius), Polynomial.from_raw(clip))

    def __str__(self) -> str:
        axis, point = (", ".join(plain(c) for c in v) for v in (self.axis, self.point))
        return f"pipe of radius {plain(self.radius)} along ({axis}) through ({point}), clipped at {plain(self.clip)}"


ContactLike: TypeAlias = "Contact | HasContact | tuple[PolynomialLike, PolynomialLike]"
"""What is taken for a contact."""


def as_contact(item: ContactLike, name: str = "contact") -> Contact:
    """The contact that a `Contact`, a `Pipe` or a pair (surface, clip) stands for."""
    if isinstance(item, Contact):
        return item
    if isinstance(item, HasContact):
        return item.contact
    if isinstance(item, tuple) and len(item) == 2:
        return Contact(*item)
    raise TypeError(f"{name} must be a Pipe, a Contact or a pair (surface, clip), not {item!r}")


def contact_ideal(contact: ContactLike, order: int) -> Ideal:
    """`<f, h^(k+1)>`: all surfaces that meet a contact (f, h) with GC^`order`.

    `contact` is a `Contact`, a `Pipe` or a pair (surface, clip).

    Raises `ValueError` or `TypeError` for a wrong contact or order.
    """
    k, checked = check_order(order), as_contact(contact)
    return Ideal(checked.surface, checked.clip ** (k + 1))


def _equation(expression: Any, name: str) -> Polynomial:
    try:
        polynomial = Polynomial(expression)
    except (ValueError, TypeError) as error:
        raise type(error)(f"{name}: {error}") from None
    if polynomial.degree < 1:
        raise ValueError(f"the {name} of a contact must be a polynomial that is not constant, not {polynomial}")
    return polynomial
