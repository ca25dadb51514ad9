"""Contacts: the surfaces that a blend continues, and where each ends.

A contact is a surface `f = 0` with a clip `h = 0`; the blend continues the surface with GC^k
along the curve V(f, h).  Signs: `f < 0` inside, `f > 0` outside; `h < 0` on the blend's side.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any, Protocol, Self, TypeAlias, runtime_checkable

from pas.algebra.affine import Affine, rotation, translation
from pas.algebra.brief import brief, latex
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, Vector, VectorLike, vector
from pas.algebra.scaling import scaled
from pas.contacts.rims import Rim, rim_of
from pas.errors import GeometryError
from pas.registry import Registry

POINTS = ("point", "near")
"""Fields that are points of space; other triples of numbers are vectors."""


class Movable:
    """A kind of contact; to be inherited by frozen dataclasses whose fields are the arguments of their constructor.

    A field is moved as what it is: polynomials by their zero sets, the fields `point` and `near` as points, other
    triples of numbers and tuples of them as vectors; numbers stay.
    """

    __repr__ = brief

    @property
    def contact(self) -> Contact:
        """The surface and its clip as polynomials."""
        raise NotImplementedError(f"{type(self).__name__} does not say which contact it stands for")

    @cached_property
    def rim(self) -> Rim:
        """The closed plane curve along which the blend is met; `GeometryError` says why where there is none."""
        return rim_of(self.contact.surface, self.contact.clip, self.contact.near)

    def check_rim(self) -> None:
        """Raise `GeometryError` where there is no closed plane curve."""
        _ = self.rim

    def translate(self, offset: VectorLike) -> Self:
        """The contact moved by three numbers."""
        return self._moved(translation(offset))

    def rotate(self, axis: VectorLike, degrees: Exact, center: VectorLike = (0, 0, 0)) -> Self:
        """The contact turned about an axis through `center`, counterclockwise seen from the axis' tip.

        Exact rotations by rational matrices, as those of solids: the angle is `degrees` up to rounding, and exact for
        multiples of 90 about an axis of rational length.
        """
        return self._moved(rotation(axis, degrees, center))

    def _repr_latex_(self) -> str | None:
        """The surface and its clip; nothing where the clip is "auto", so that notebooks show the repr."""
        try:
            contact = self.contact
        except GeometryError:
            return None
        return rf"${latex(str(contact.surface))} = 0, \quad {latex(str(contact.clip))} = 0$"

    def _moved(self, map_: Affine) -> Self:
        arguments = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        points = {name: map_.exact(arguments[name]) for name in POINTS if arguments.get(name) is not None}
        return type(self)(**{name: _image(value, map_) for name, value in arguments.items()} | points)


def _image(value: Any, map_: Affine) -> Any:
    if isinstance(value, Polynomial):
        return map_.polynomial(value)
    if isinstance(value, tuple):
        inner = isinstance(value[0], tuple)
        return tuple(_image(v, map_) for v in value) if inner else map_.direction(value)
    return value


@dataclass(frozen=True, repr=False)
class Contact(Movable):
    """A surface and its clip, each anything that `Polynomial` takes.

    Raises `ValueError` where one of them is constant or they have a common factor (a clip that contains its surface).

    Where they meet in several closed curves, `near` (three numbers) is a point next to the one that is meant, the
    contact's `rim`.  It says nothing about the polynomials, and contacts are equal without it.
    """

    surface: Polynomial
    clip: Polynomial
    near: Vector | None = field(default=None, compare=False, repr=False)

    def __init__(self, surface: PolynomialLike, clip: PolynomialLike, near: VectorLike | None = None) -> None:
        object.__setattr__(self, "surface", Polynomial.named(surface, "surface", constant=False, of="a contact"))
        object.__setattr__(self, "clip", Polynomial.named(clip, "clip", constant=False, of="a contact"))
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

    def ideal(self, order: int) -> Ideal:
        """`<f, h^(k+1)>`: what meets the contact with GC^`order`."""
        return Ideal.from_raw(self.surface.raw, self.clip.raw ** (order + 1))

    def __str__(self) -> str:
        return f"{self.surface} = 0 up to {self.clip} = 0"


@runtime_checkable
class HasContact(Protocol):
    """Anything that stands for a contact, such as a `Pipe`.

    A class of these is registered in `CONTACTS`: problem files know it by the name of its `table`,
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
        "pipes": "pas.contacts.endless:Pipe",
        "cones": "pas.contacts.endless:Cone",
        "elliptic_pipes": "pas.contacts.axial_quadrics:EllipticPipe",
        "paraboloids": "pas.contacts.axial_quadrics:Paraboloid",
        "hyperboloids": "pas.contacts.axial_quadrics:Hyperboloid",
        "spheres": "pas.contacts.axial_quadrics:Sphere",
        "ellipsoids": "pas.contacts.axial_quadrics:Ellipsoid",
        "tori": "pas.contacts.torus:Torus",
        "plates": "pas.contacts.plate:Plate",
        "openings": "pas.contacts.cones:Opening",
        "quadrics": "pas.contacts.quadric:QuadricContact",
        "contacts": Contact,
    },
    key="table",
)
"""The kinds of contacts that problem files may have, by the names of their tables."""


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
    return checked.ideal(k)
