"""Contacts: the surfaces that a blend continues, and where each ends.

A contact is a surface `f = 0` with a clip `h = 0`; the blend continues the surface with GC^k
along the curve V(f, h).  Signs: `f < 0` inside, `f > 0` outside; `h < 0` on the blend's side.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol, TypeAlias, runtime_checkable

from pas.algebra.brief import brief
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Vector, VectorLike, vector
from pas.algebra.scaling import scaled
from pas.contacts.movable import Movable
from pas.registry import Registry


@dataclass(frozen=True)
class Contact(Movable):
    """A surface and its clip, each anything that `Polynomial` takes.

    Raises `ValueError` where one of them is constant or they have a common factor (a clip that
    contains its surface).

    Where they meet in several closed curves, `near` (three numbers) is a point next to the one that is meant, the
    contact's `rim`.  It says nothing about the polynomials, and contacts are equal without it.
    """

    surface: Polynomial
    clip: Polynomial
    near: Vector | None = field(default=None, compare=False, repr=False)

    __repr__ = brief

    def __init__(self, surface: PolynomialLike, clip: PolynomialLike, near: VectorLike | None = None) -> None:
        object.__setattr__(self, "surface", _equation(surface, "surface"))
        object.__setattr__(self, "clip", _equation(clip, "clip"))
        object.__setattr__(self, "near", None if near is None else vector(near, "near"))
        common = self.surface.raw.gcd(self.clip.raw)
        if not common.is_constant():
            raise ValueError(
                f"the clip {self.clip} and the surface {self.surface} have the common factor "
                f"{common}; a clip must cut its surface in a curve"
            )

    @property
    def contact(self) -> Contact:
        """Itself."""
        return self

    @cached_property
    def scaled(self) -> Contact:
        """The contact with each polynomial over a power of two of its own, for what works in doubles."""
        return Contact(scaled(self.surface), scaled(self.clip), self.near)

    def __str__(self) -> str:
        return f"{self.surface} = 0 up to {self.clip} = 0"


@runtime_checkable
class HasContact(Protocol):
    """Anything that stands for a contact, such as a `Pipe`.

    A class of these is one file; registered in `CONTACTS`, problem files know it by the name of its `table`,
    whose keys are the arguments of its constructor.  One with a static `inner_surface(contact, thickness)` says what is
    inside a wall of contacts of its kind (`pas.contacts.parallels`).
    """

    @property
    def contact(self) -> Contact:
        """The contact."""


ContactLike: TypeAlias = "Contact | HasContact | tuple[PolynomialLike, PolynomialLike]"
"""What is taken for a contact."""


CONTACTS: Registry[type[Any]] = Registry(
    "table of contacts",
    {
        "pipes": "pas.contacts.pipe:Pipe",
        "cones": "pas.contacts.cone:Cone",
        "elliptic_pipes": "pas.contacts.elliptic_pipe:EllipticPipe",
        "paraboloids": "pas.contacts.paraboloid:Paraboloid",
        "hyperboloids": "pas.contacts.hyperboloid:Hyperboloid",
        "spheres": "pas.contacts.sphere:Sphere",
        "ellipsoids": "pas.contacts.ellipsoid:Ellipsoid",
        "tori": "pas.contacts.torus:Torus",
        "plates": "pas.contacts.plate:Plate",
        "openings": "pas.contacts.opening:Opening",
        "quadrics": "pas.contacts.quadric:QuadricContact",
        "contacts": Contact,
    },
    key="table",
)
"""What problem files may have for contacts, by the names of their tables."""


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
    """`<f, h^(k+1)>`: all surfaces that meet a contact (f, h) with GC^`order` (Warren 1989).

    `contact` is a `Contact`, a `Pipe` or a pair (surface, clip).

    Raises `ValueError` or `TypeError` for a wrong contact or order.
    """
    k, checked = check_order(order), as_contact(contact)
    return Ideal(checked.surface, checked.clip ** (k + 1))


def _equation(expression: PolynomialLike, name: str) -> Polynomial:
    try:
        polynomial = Polynomial(expression)
    except (ValueError, TypeError) as error:
        raise type(error)(f"{name}: {error}") from None
    if polynomial.degree < 1:
        raise ValueError(f"the {name} of a contact must be a polynomial that is not constant, not {polynomial}")
    return polynomial
