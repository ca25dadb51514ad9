"""Options as values: one frozen dataclass for each family of options, whose fields say how they are given elsewhere.

A verb takes its options as keywords and makes such an object of them, which then goes through all layers as a whole.
What is made by `option` is also an argument of commands (`pas.cli.common.add_settings`) and a key of problem files
(`pas.exchange.problem`), with the help, type and default that stand here: so a new one is a field, its use and its
test.  Drawing has `pas.Picture`, fitting `pas.Wishes`, fairness `pas.FairnessLimits`, writing
`pas.exchange.formats.Request`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import Field, dataclass, field, fields
from enum import Enum
from typing import Any

from pas.algebra.inputs import check_limit, shown
from pas.algebra.rational import check_tolerance


def option(default: Any, text: str, kind: type = bool, metavar: str = "", *, file: bool = True) -> Any:
    """A field of settings that the command line and problem files have, too.

    `text` is its help, which may name what is usual as {usual}; `kind` the type that is written (bool, int, float, str
    or list), `metavar` what stands for it in the help.  It is a key of files unless `file` is false.
    """
    return field(
        default=default,
        metadata={"text": text, "kind": kind, "metavar": metavar, "command": True, "file": file},
    )


def options(settings: type[Any], place: str, leave: Iterable[str] = ()) -> list[Field[Any]]:
    """The fields of settings that a place has ("command" or "file"), but for those to leave out."""
    return [f for f in fields(settings) if f.metadata.get(place) and f.name not in leave]


def given(settings: Any) -> dict[str, Any]:
    """The options of a settings object that are not as usual, by name."""
    values = {f.name: (getattr(settings, f.name), f.default) for f in fields(settings)}
    return {name: value for name, (value, usual) in values.items() if value is not usual and value != usual}


RELATIVE_TOLERANCE = 1e-3
"""The tolerance of a mesh for which none is given, over the size of the shape: a thousandth is seen by nobody."""

QUALITIES = ("angles", "balanced", "count")
"""The names of `pas.mesh.quality.Quality`."""


def check_quality(given: Any) -> str:
    """The name of a quality of meshes, from that or a `pas.mesh.quality.Quality`; raises `ValueError` for any other."""
    name = given.value if isinstance(given, Enum) else given
    if name not in QUALITIES:
        raise ValueError(f"quality must be one of {', '.join(map(repr, QUALITIES))}, not {shown(given)}")
    return str(name)


@dataclass(frozen=True)
class MeshSettings:
    """How a shape is meshed; `Shape.mesh` of each kind takes those as keywords that mean something to it.

    `tolerance` is in the model's units, None for the shape's own; `domain` that of a surface with parameters.  Raises
    `TypeError` and `ValueError` for a tolerance, a quality or a number of triangles that is none.
    """

    tolerance: float | None = option(
        None, "largest distance of the mesh from the surface (default: {usual})", float, "T", file=False
    )
    quality: str | Enum = option(
        "balanced", "angles for no long triangles, count for few of them (default: balanced)", str, "WORD"
    )
    max_triangles: int | None = option(None, "fail rather than make more triangles than that", int, "N")
    domain: Any = None

    def __post_init__(self) -> None:
        if self.tolerance is not None:
            object.__setattr__(self, "tolerance", check_tolerance(self.tolerance))
        check_quality(self.quality)
        check_limit(self.max_triangles)
