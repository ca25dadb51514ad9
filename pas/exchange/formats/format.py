"""What a file format is: a suffix, what such files hold, and a function that writes it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from pas.errors import MissingLibraryError, PasError
from pas.parametric.domain import DomainLike

C = TypeVar("C")

UNITS = ("micrometer", "millimeter", "centimeter", "meter", "inch", "foot")
"""Units of lengths that a file may be said to be in; no number is changed for them."""


@dataclass(frozen=True)
class Request:
    """How something is to be written.

    `name` is the file's, without suffix; `tolerance` that of the thing's mesh (None for its own), `domain` a
    parametric surface's; `unit` one of UNITS; `sew` the distance within which faces are joined.
    """

    name: str
    tolerance: float | None = None
    domain: DomainLike = None
    unit: str = "millimeter"
    sew: float | None = None


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


def _nothing() -> None:
    """Formats that need no library of their own."""


@dataclass(frozen=True)
class Format(Generic[C]):
    """A file format by its suffix, `name`, such as ".stl".

    `write(content, path, request)` writes to a path that exists already and becomes the file when it returns;
    `require` raises `MissingLibraryError` where a package that it needs is absent, before any work; `limits` says of a
    thing of which the content can be made whether such files can hold it.
    """

    name: str
    content: Content[C]
    write: Callable[[C, Path, Request], None]
    require: Callable[[], object] = _nothing
    limits: Callable[[Any], bool] | None = None

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
        for option in ("tolerance", "domain", "sew"):
            if getattr(request, option) is not None and option not in self.content.options:
                raise ValueError(f"{option} says nothing of {self.content.noun}, which {self.name} files hold")
        if request.unit not in UNITS:
            raise ValueError(f"unit must be one of {', '.join(UNITS)}, not {request.unit!r}")
        self.require()
