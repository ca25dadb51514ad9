"""File formats of other programs, by suffix.

A format is a `Format` with a suffix, what it holds (`TRIANGLES` or `PATCHES` of `pas.exchange.parts`, ...) and a
function that writes that.  `FORMATS.register(Format(...))` adds one from outside, for all that can be written so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from pas.errors import MissingLibraryError, PasError
from pas.registry import Registry
from pas.settings import MeshSettings, given, option

C = TypeVar("C")

UNITS = ("micrometer", "millimeter", "centimeter", "meter", "inch", "foot")
"""Units of lengths that a file may be said to be in; no number is changed for them."""


@dataclass(frozen=True)
class Request:
    """How something is to be written.

    `name` is the file's, without suffix; `mesh` says how the thing is meshed, where it is, and the domain of what has
    parameters; `unit` is one of UNITS; `sew` the distance within which faces are joined.
    """

    name: str
    mesh: MeshSettings = field(default_factory=MeshSettings)
    unit: str = option("millimeter", "of the model, for formats that have one", str, "UNIT")
    sew: float | None = option(None, "join exact faces whose sides are within that distance", float, "D")


@dataclass(frozen=True)
class Content(Generic[C]):
    """What files of some formats hold; `of` makes it of a thing, `options` are those of a request that it heeds.

    `fits` says of a thing whether it is soon made, without making it; where there is none, it is made to see.
    """

    noun: str
    of: Callable[[Any, Request], C]
    options: tuple[str, ...] = ()
    fits: Callable[[Any], bool] | None = None

    def can_be_of(self, thing: Any) -> bool:
        """Whether it can be made of a thing without long work."""
        if self.fits is not None:
            return self.fits(thing)
        try:
            self.of(thing, Request("shape"))
        except (TypeError, ValueError, PasError):
            return False
        return True


def _no_library() -> None:
    """Formats that need no library of their own."""


@dataclass(frozen=True)
class Format(Generic[C]):
    """A file format by its suffix, `name`, such as ".stl".

    `write(content, path, request)` writes to a path that exists already and becomes the file when it returns;
    `require` raises `MissingLibraryError` where a package that it needs is absent, before any work; `limits` says of a
    thing of which the content can be made whether such files can hold it; `closed` that they hold closed bodies only.
    """

    name: str
    content: Content[C]
    write: Callable[[C, Path, Request], None]
    require: Callable[[], object] = _no_library
    limits: Callable[[Any], bool] | None = None
    closed: bool = False

    def holds(self, thing: Any) -> bool:
        """Whether a thing can be written here, less what would first have to be filled with tetrahedra."""
        return self._installed() and self.content.can_be_of(thing) and (self.limits is None or self.limits(thing))

    def _installed(self) -> bool:
        try:
            self.require()
        except MissingLibraryError:
            return False
        return True

    def check(self, request: Request) -> None:
        """Raise `ValueError` for an option that says nothing of such files, or a unit that is none."""
        for name in given(request.mesh) | ({} if request.sew is None else {"sew": request.sew}):
            if name not in self.content.options:
                raise ValueError(f"{name} says nothing of {self.content.noun}, which {self.name} files hold")
        if request.unit not in UNITS:
            raise ValueError(f"unit must be one of {', '.join(UNITS)}, not {request.unit!r}")
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
        ".step": "pas.exchange.formats.step:STEP",
        ".stp": "pas.exchange.formats.step:STEP",
        ".vtu": "pas.exchange.formats.cells:VTU",
        ".msh": "pas.exchange.formats.cells:MSH",
    },
)


def suffixes_for(thing: Any) -> tuple[str, ...]:
    """The suffixes that a thing can be written with, one for each format; see `Format.holds`."""
    return tuple(suffix for suffix in FORMATS if FORMATS[suffix].name == suffix and FORMATS[suffix].holds(thing))


def suffixes_of(noun: str) -> tuple[str, ...]:
    """The suffixes of the formats that hold "triangles", "patches", ..."""
    return tuple(suffix for suffix in FORMATS if FORMATS[suffix].content.noun == noun)
