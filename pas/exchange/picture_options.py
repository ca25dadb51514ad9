"""The options of pictures as a value, for verbs, commands and problem files alike.

What they do stands in `pas.render`, above.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, TypedDict

from pas.algebra.brief import brief
from pas.algebra.inputs import check_flag, shown, whole
from pas.algebra.rational import check_tolerance, to_float, vector
from pas.errors import meant
from pas.registry import Registry
from pas.settings import option

View = tuple[float, float, float]

VIEWS: dict[str, View] = {
    "front": (0, -1, 0),
    "back": (0, 1, 0),
    "left": (-1, 0, 0),
    "right": (1, 0, 0),
    "top": (0, 0, 1),
    "bottom": (0, 0, -1),
    "iso": (1, -1, 0.8),
}
"""The views that have a name: where one stands, in the coordinates, with z upwards."""


class Style(Enum):
    """The styles that come with `pas`, each of which may be given by its name, too: what the colours show."""

    PLAIN = "plain"
    ZEBRA = "zebra"
    HIGHLIGHTS = "highlights"
    MEAN = "mean"
    GAUSS = "gauss"
    MAX = "max"
    MIN = "min"
    CURVATURE = "curvature"


STYLES: Registry[Any] = Registry(
    "style of pictures", {style.value: f"pas.render.styles:{style.name}" for style in Style}
)
"""The styles of pictures, by name; a user's own is added by `STYLES.register(...)`, see `pas.render.scene`."""


class PictureOptions(TypedDict, total=False):
    """The fields of `Picture` as keywords of `pas.draw` and `pas.show`."""

    style: Style | str
    combs: bool
    size: tuple[int, int] | str
    view: Any
    domain: Any
    tolerance: float | None
    four_views: bool
    exploded: bool
    cut: Any
    parallel: bool
    transparent: bool
    occlusion: bool
    colors: Mapping[str, str] | str | None
    labels: bool
    dimensions: bool


@dataclass(frozen=True)
class Picture:
    """How shapes are drawn; `pas.draw` and `pas.show` take each of these by name.

    `style`: what the colours show, a `pas.Style` or a name.  `combs`: with curvature combs, hairs whose lengths are the
    normal curvature along sections and contact curves.  `size` in pixels, also as "1200x900".  `view`: from where one
    looks, one of `VIEWS` by name, or a direction, of blends by patches in the frame of the contact directions, else in
    the coordinates, also as "1,-1,1/2".  `domain`: that of `ParametricSurface.mesh`, for all parametric shapes.
    `tolerance`: of the meshes, in the model's units.

    `four_views`: from four sides.  `exploded`: the parts lifted apart.  `cut`: without what is in front of the middle
    plane, as seen from the front, or from another view, by name or as a direction.  `parallel`: parallel projection.
    `transparent`: without background.  `occlusion`: with ambient occlusion, shadows where surfaces are near each other,
    which takes three times as long.  `colors`: one for all, as #rrggbb or by a CSS name; "faces" for another for each
    face; or a table from names of parts, faces or "part: face", * for any letters, to colours, of which the first that
    fits counts; also as "boss=tomato,*=#c0c0c0".  `labels`: the names of the parts, or of the faces of a single one.
    `dimensions`: the sides of the box around it.

    Raises `TypeError` for what is no style or no truth value, `ValueError` for an unknown style, view or colour and a
    bad tolerance.
    """

    style: Style | str = option(
        Style.PLAIN, "any style by its name: plain, zebra, highlights, mean, gauss, max, min", str, "STYLE"
    )
    combs: bool = option(False, "curvature combs along sections and contact curves")
    size: tuple[int, int] = option((1200, 900), "in pixels (default: 1200x900)", list, "WxH")
    view: str | View | None = option(
        None, f"from where one looks: {', '.join(VIEWS)}, or a direction", list, "WORD or X,Y,Z"
    )
    domain: Any = None
    tolerance: float | None = option(
        None, "largest distance of the mesh from the surface (default: {usual})", float, "T", file=False
    )
    four_views: bool = option(False, "from four sides")
    exploded: bool = option(False, "the parts lifted apart")
    cut: bool | str | View = option(
        False, "without what is before the middle plane, seen from the front or a view", bool, "VIEW"
    )
    parallel: bool = option(False, "parallel projection")
    transparent: bool = option(False, "no background")
    occlusion: bool = option(False, "ambient occlusion: shadows where surfaces are near each other")
    colors: Mapping[str, str] | str | None = option(
        None, "a colour, faces for one for each face, or NAME=COLOUR,... of parts and faces", str, "COLOURS"
    )
    labels: bool = option(False, "the names of parts, or of the faces of a single one")
    dimensions: bool = option(False, "the sides of the box around it")
    __repr__ = brief

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise TypeError(f"style must be a pas.Style or the name of one, not {self.name!r}")
        if self.name not in STYLES:
            raise ValueError(STYLES.unknown(self.name))
        for field in fields(self):
            if field.metadata.get("kind") is bool and field.name != "cut":
                check_flag(getattr(self, field.name), field.name)
        size: Any = tuple(self.size.lower().split("x")) if isinstance(self.size, str) else self.size
        if not hasattr(size, "__len__") or len(size) != 2:
            raise TypeError(f"size must be width and height in pixels, as in 1200x900, not {shown(self.size)}")
        numbers = [int(n) if isinstance(n, str) and n.isdecimal() else n for n in size]
        for i, pixels in enumerate(numbers):
            whole(pixels, f"size[{i}]", 1, 16384)  # as graphics libraries have it
        object.__setattr__(self, "size", tuple(numbers))
        if self.view is not None:
            object.__setattr__(self, "view", _direction(self.view, "view"))
        if not isinstance(self.cut, bool):
            object.__setattr__(self, "cut", _direction(self.cut, "cut"))
        object.__setattr__(self, "colors", _colors(self.colors))
        if self.colors is not None and self.name != "plain":
            raise ValueError(f"colors are those of the style plain; the style {self.name} has its own")
        if self.tolerance is not None:
            object.__setattr__(self, "tolerance", check_tolerance(self.tolerance))

    @property
    def name(self) -> str:
        """The style's name."""
        return self.style.value if isinstance(self.style, Style) else self.style

    @property
    def coloring(self) -> Any:
        """The style's implementation, a `pas.render.scene.Coloring`."""
        return STYLES[self.name]

    @property
    def curved(self) -> bool:
        """Whether curvatures are needed."""
        return self.combs or bool(self.coloring.curved)

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> Picture:
        """The settings of options by name; raises `TypeError` with a guess for another name."""
        known = [f.name for f in fields(cls)]
        for name in options:
            if name not in known:
                guess = meant(name, known) or f"; there are {', '.join(known)}"
                raise TypeError(f"a picture has no option {name!r}{guess}")
        return cls(**options)


def _direction(value: Any, name: str) -> View | str:
    if isinstance(value, str) and "," not in value:
        if value not in VIEWS:
            raise ValueError(f"there is no {name} {value!r}{meant(value, VIEWS) or '; there are ' + ', '.join(VIEWS)}")
        return value
    x, y, z = map(to_float, vector(value.split(",") if isinstance(value, str) else value, name))
    if x == y == z == 0:
        raise ValueError(f"{name} must not be the zero vector")
    return x, y, z


def _colors(value: Any) -> Any:
    """Colours as #rrggbb: one, "faces", or a table by name."""
    if value is None or value == "faces":
        return value
    if isinstance(value, str) and "=" in value:
        value = dict(entry.rpartition("=")[::2] for entry in value.split(","))
    if isinstance(value, Mapping):
        return {str(name).strip(): _color(color) for name, color in value.items()}
    return _color(value)


def _color(value: Any) -> str:
    from PIL import ImageColor

    if isinstance(value, str) and re.fullmatch("#[0-9a-fA-F]{6}", value.strip()):
        return value.strip()
    name = value.strip().lower() if isinstance(value, str) else ""
    if name not in ImageColor.colormap:
        raise ValueError(
            f"{shown(value)} is no colour{meant(name, ImageColor.colormap) or ', which is a CSS name or #rrggbb'}"
        )
    return "#{:02x}{:02x}{:02x}".format(*ImageColor.getrgb(name)[:3])
