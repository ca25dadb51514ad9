"""How shapes are drawn, as a value: the options of pictures, for verbs, commands and problem files alike.

What they do stands in `pas.render`, above.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, TypedDict

from pas.algebra.inputs import check_flag, check_tolerance, shown, whole
from pas.algebra.rational import to_float, vector
from pas.errors import meant
from pas.registry import Registry
from pas.settings import option

STYLES: Registry[Any] = Registry(
    "style of pictures",
    {
        "plain": "pas.render.styles:PLAIN",
        "zebra": "pas.render.styles:ZEBRA",
        "highlights": "pas.render.styles:HIGHLIGHTS",
        "mean": "pas.render.curvature:MEAN",
        "gauss": "pas.render.curvature:GAUSS",
        "max": "pas.render.curvature:MAX",
        "min": "pas.render.curvature:MIN",
        "curvature": "pas.render.curvature:CURVATURE",
    },
)
"""What the colours of a picture show; a user's own is added by `STYLES.register(...)`, see `pas.render.scene`."""

View = tuple[float, float, float]


class Style(Enum):
    """What the colours show: the styles that come with `pas`, each of which may be given by its name, too."""

    PLAIN = "plain"
    ZEBRA = "zebra"
    HIGHLIGHTS = "highlights"
    MEAN = "mean"
    GAUSS = "gauss"
    MAX = "max"
    MIN = "min"
    CURVATURE = "curvature"


class PictureOptions(TypedDict, total=False):
    """The fields of `Picture` as keywords of `pas.draw` and `pas.show`."""

    style: Style | str
    combs: bool
    size: tuple[int, int]
    view: Any
    domain: Any
    tolerance: float | None
    four_views: bool
    exploded: bool
    cut: bool


@dataclass(frozen=True)
class Picture:
    """How shapes are drawn; `pas.draw` and `pas.show` take each of these by name.

    `style`: what the colours show, a `pas.Style` or a name.  `combs`: with curvature combs, hairs whose lengths are the
    normal curvature along sections and contact curves.  `size` in pixels.  `view`: the direction from where one looks,
    of blends by patches in the frame of the contact directions, else in the coordinates.  `domain`: that of
    `ParametricSurface.mesh`, for all parametric shapes.  `tolerance`: of the meshes, in the model's units.

    `four_views`: from four sides.  `exploded`: the parts lifted apart.  `cut`: without what is in front of the middle
    plane y = const.

    Raises `TypeError` for what is no style or no truth value, `ValueError` for an unknown style and a bad tolerance.
    """

    style: Style | str = option(
        Style.PLAIN, "any style by its name: plain, zebra, highlights, mean, gauss, max, min", str, "STYLE"
    )
    combs: bool = option(False, "curvature combs along sections and contact curves")
    size: tuple[int, int] = option((1200, 900), "width and height in pixels", list, command=False)
    view: Any = option(None, "the direction from where one looks", list, command=False)
    domain: Any = None
    tolerance: float | None = option(
        None, "largest distance of the mesh from the surface (default: {usual})", float, "T", file=False
    )
    four_views: bool = option(False, "from four sides")
    exploded: bool = option(False, "the parts lifted apart")
    cut: bool = option(False, "without what is in front of the middle plane")

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise TypeError(f"style must be a pas.Style or the name of one, not {self.name!r}")
        if self.name not in STYLES:
            raise ValueError(STYLES.unknown(self.name))
        for name in ("combs", "four_views", "exploded", "cut"):
            check_flag(getattr(self, name), name)
        if isinstance(self.size, str) or not hasattr(self.size, "__len__") or len(self.size) != 2:
            raise TypeError(f"size must be width and height in pixels, not {shown(self.size)}")
        for i, pixels in enumerate(self.size):
            whole(pixels, f"size[{i}]", 1, 16384)  # as graphics libraries have it
        if self.view is not None:
            object.__setattr__(self, "view", _direction(self.view))
        if self.tolerance is not None:
            check_tolerance(self.tolerance)

    @property
    def name(self) -> str:
        """The style's name."""
        return self.style.value if isinstance(self.style, Style) else self.style

    @property
    def coloring(self) -> Any:
        """What the style does, a `pas.render.scene.Coloring`."""
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


def _direction(value: Any) -> View:
    x, y, z = map(to_float, vector(value, "view"))
    if x == y == z == 0:
        raise ValueError("view must not be the zero vector")
    return x, y, z
