"""File formats of other programs, by suffix.

A format is a `Format` with a suffix, what it holds (`TRIANGLES` or `FACES` of `pas.exchange.parts`, ...) and a
function that writes that.  `FORMATS.register(Format(...))` adds one from outside, for all that can be written so.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from flint import fmpq

from pas.algebra.affine import AffineShape
from pas.algebra.inputs import shown
from pas.algebra.rational import near, positive, rational
from pas.errors import MissingLibraryError, PasError
from pas.registry import Registry
from pas.settings import MeshSettings, given, option
from pas.shape import Shape

C = TypeVar("C")


@dataclass(frozen=True)
class Unit:
    """A unit of lengths: how many `meters` it is, what Open Cascade calls it, and how else it may be given."""

    meters: Fraction
    step: str
    others: tuple[str, ...]


UNITS = {
    "micrometer": Unit(Fraction(1, 10**6), "UM", ("um", "micron")),
    "millimeter": Unit(Fraction(1, 1000), "MM", ("mm",)),
    "centimeter": Unit(Fraction(1, 100), "CM", ("cm",)),
    "meter": Unit(Fraction(1), "M", ("m",)),
    "inch": Unit(Fraction(254, 10**4), "INCH", ("in", "inches")),
    "foot": Unit(Fraction(3048, 10**4), "FT", ("ft", "feet")),
}
"""The units that a model may be said to be in, by name; plurals and -metre are known, too."""


def unit_named(given: str) -> str:
    """The name in UNITS of a unit; raises `ValueError` for what is none."""
    word = str(given).strip().lower().replace("metre", "meter")
    for name, unit in UNITS.items():
        if word in (name, f"{name}s", *unit.others):
            return name
    short = ", ".join(unit.others[0] for unit in UNITS.values())
    raise ValueError(f"unit must be one of {', '.join(UNITS)}, or {short}, not {shown(given)}")


@dataclass(frozen=True)
class Request:
    """How something is to be written.

    `name` is the file's, without suffix; `mesh` says how the thing is meshed, where it is, and the domain of what has
    parameters; `unit` is the model's, by its name in UNITS once it is made, None where it is not told; `sew` the
    distance within which faces are joined; `open` that surfaces with edges are meant where files are taken for bodies.
    """

    name: str
    mesh: MeshSettings = field(default_factory=MeshSettings)
    unit: str | None = option(None, "of the model, such as mm or inch, for formats that have one", str, "UNIT")
    sew: float | None = option(None, "join exact faces whose sides are within that distance", float, "D")
    open: bool = option(False, "write a surface with edges, even where files are taken for bodies: .stl, .obj, .3mf")

    def __post_init__(self) -> None:
        if self.unit is not None:
            object.__setattr__(self, "unit", unit_named(self.unit))

    @property
    def told_unit(self) -> str:
        """The unit that a file tells of numbers as they are in the model: millimeter where none is given."""
        return self.unit or "millimeter"


@dataclass(frozen=True)
class Sizing:
    """How a shape is scaled before it is written: by an exact factor, or to a length of the longest side of its box.

    `scale` is a number, `size` a length in the model's unit or in one that stands behind it, as in "120mm".  Raises
    `ValueError` for both together, and for what is no positive number or no unit.
    """

    scale: str | None = option(None, "scale by an exact number, such as 25.4 or 1/2", str, "F")
    size: str | None = option(None, "scale until the longest side of its box is that long, such as 120mm", str, "L")

    def __post_init__(self) -> None:
        if self.scale is not None and self.size is not None:
            raise ValueError("scale and size are two ways to say how large a shape is to be; give one of them")
        positive(1 if self.scale is None else self.scale, "scale")
        _ = self._length

    @property
    def _length(self) -> tuple[fmpq, str | None]:
        """The size and the unit that stands behind it."""
        parts = re.fullmatch(r"\s*(.*?)\s*([a-zA-Z]*)\s*", self.size or "1")
        assert parts is not None
        return positive(parts[1], "size"), unit_named(parts[2]) if parts[2] else None

    def factor(self, shape: Shape, unit: str | None) -> tuple[fmpq, str | None]:
        """By what a shape is scaled, exactly, and the unit of it then: that of the size where no other is given."""
        if self.size is None:
            return rational(1 if self.scale is None else self.scale), unit
        length, told = self._length
        if told is not None and unit is not None:
            ratio = UNITS[told].meters / UNITS[unit_named(unit)].meters
            length *= fmpq(ratio.numerator, ratio.denominator)
        return length / near(float(np.ptp(shape.bounding_box, axis=0).max())), unit or told

    def applied(self, shape: Shape, unit: str | None) -> tuple[Shape, str | None]:
        """The shape as large as is wanted, and its unit; raises `ValueError` for a kind that cannot be scaled."""
        if self == Sizing():
            return shape, unit
        if not isinstance(shape, AffineShape):
            raise ValueError(
                f"scale and size are for solids, assemblies and meshes; {shape!r} is none, make a solid of it"
            )
        factor, unit = self.factor(shape, unit)
        scaled: Shape = shape.scale(factor)
        return scaled, unit


@dataclass(frozen=True)
class Content(Generic[C]):
    """The content of files of some formats; `of` makes it of a thing, `options` are the request's that it heeds.

    `fits` says whether a thing has such content without making it; without `fits` it is made to see.
    """

    noun: str
    of: Callable[[Any, Request], C]
    options: tuple[str, ...] = ()
    fits: Callable[[Any], bool] | None = None

    def can_be_of(self, thing: Any) -> bool:
        """Whether it can be made of a thing."""
        if self.fits is not None:
            return self.fits(thing)
        try:
            self.of(thing, Request("shape"))
        except (TypeError, ValueError, PasError):
            return False
        return True


@dataclass(frozen=True)
class Format(Generic[C]):
    """A file format by its suffix, `name`, such as ".stl".

    `write(content, path, request)` writes to a path that exists already and becomes the file when it returns what is to
    be told of its parts, one dataclass each with a `str` of one line, or None;
    `require` raises `MissingLibraryError` where a package that it needs is absent, before any work; `limits` says of a
    thing of which the content can be made whether such files can hold it; `bodies` that they are taken for closed
    bodies, as for printing, and `closed` that they are for nothing else; `unitless` that they have no unit, neither
    told nor understood.
    """

    name: str
    content: Content[C]
    write: Callable[[C, Path, Request], Sequence[Any] | None]
    require: Callable[[], object] = lambda: None
    limits: Callable[[Any], bool] | None = None
    bodies: bool = False
    closed: bool = False
    unitless: bool = False

    def holds(self, thing: Any) -> bool:
        """Whether a thing can be written here, less what would first have to be filled with tetrahedra."""
        try:
            self.require()
        except MissingLibraryError:
            return False
        return self.content.can_be_of(thing) and (self.limits is None or self.limits(thing))

    def check(self, request: Request) -> None:
        """Raise `ValueError` for an option that says nothing of such files, such as a unit where they have none."""
        for name in given(request.mesh) | ({} if request.sew is None else {"sew": request.sew}):
            if name not in self.content.options:
                raise ValueError(f"{name} says nothing of {self.content.noun}, which {self.name} files hold")
        if self.unitless and request.unit is not None:
            raise ValueError(f"{self.name} files have no unit; leave out unit={request.unit!r}, and scale the shape")
        self.require()


FORMATS: Registry[Format[Any]] = Registry(
    "file format",
    {
        ".stl": "pas.exchange.formats.plain:STL",
        ".obj": "pas.exchange.formats.plain:OBJ",
        ".ply": "pas.exchange.formats.plain:PLY",
        ".3mf": "pas.exchange.formats.libraries:THREE_MF",
        ".glb": "pas.exchange.formats.libraries:GLB",
        ".vtp": "pas.exchange.formats.libraries:VTP",
        ".step": "pas.exchange.formats.libraries:STEP",
        ".stp": "pas.exchange.formats.libraries:STEP",
        ".vtu": "pas.exchange.formats.libraries:VTU",
        ".msh": "pas.exchange.formats.libraries:MSH",
        ".csv": "pas.exchange.formats.plain:CSV",
    },
)


def suffixes_for(thing: Any) -> tuple[str, ...]:
    """The suffixes that a thing can be written with, one for each format; see `Format.holds`."""
    return tuple(suffix for suffix in FORMATS if FORMATS[suffix].name == suffix and FORMATS[suffix].holds(thing))


def suffixes_of(noun: str) -> tuple[str, ...]:
    """The suffixes of the formats that hold "triangles", "faces", ..."""
    return tuple(suffix for suffix in FORMATS if FORMATS[suffix].content.noun == noun)
