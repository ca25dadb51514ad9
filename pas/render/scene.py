"""What a picture is made of: its settings, and the layers that the shapes add to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import Enum
from typing import Any, TypedDict

import numpy as np

from pas.algebra.inputs import check_tolerance
from pas.algebra.monomials import Floats
from pas.errors import meant
from pas.mesh.mesh import Mesh
from pas.render.layers import Layer
from pas.shape import Shape, kind_of

SIZE = (1200, 900)


class Style(Enum):
    """What the colours show."""

    PLAIN = "plain"
    ZEBRA = "zebra"
    CURVATURE = "curvature"


class PictureOptions(TypedDict, total=False):
    """The fields of `Picture` as keywords of `pas.draw` and `pas.show`."""

    style: Style
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

    `style`: what the colours show.  `size` in pixels.  `view`: the direction from where one looks, of blends by
    patches in the frame of the contact directions, else in the coordinates.  `domain`: that of
    `ParametricSurface.mesh`, for all parametric shapes.  `tolerance`: of the meshes, in the model's units.

    `four_views`: from four sides.  `exploded`: the parts lifted apart.  `cut`: without what is in front of the middle
    plane y = const.

    Raises `TypeError` for what is no `Style`, `ValueError` for a bad tolerance.
    """

    style: Style = Style.PLAIN
    size: tuple[int, int] = SIZE
    view: Any = None
    domain: Any = None
    tolerance: float | None = None
    four_views: bool = False
    exploded: bool = False
    cut: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.style, Style):
            raise TypeError(f"style must be a pas.Style, not {self.style!r}")
        if self.tolerance is not None:
            check_tolerance(self.tolerance)

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> Picture:
        """The settings of options by name; raises `TypeError` with a guess for another name."""
        known = [f.name for f in fields(cls)]
        for name in options:
            if name not in known:
                guess = meant(name, known) or f"; there are {', '.join(known)}"
                raise TypeError(f"a picture has no option {name!r}{guess}")
        return cls(**options)


@dataclass
class Scene:
    """What is to be seen: the kinds' `layers` functions add to it.

    `known` are meshes that spare meshing again, by the part's name, "" for a shape of one part.  `frame` (3, 3) are the
    directions that `view` and stripes are meant in; without a `view` the widest is taken.
    """

    picture: Picture
    known: Mapping[str, Mesh] = field(default_factory=dict)
    layers: list[Layer] = field(default_factory=list)
    frame: Floats = field(default_factory=lambda: np.eye(3))
    view: Any = None

    @property
    def style(self) -> Style:
        """What the colours show."""
        return self.picture.style

    def mesh(self, make: Callable[[], Mesh], name: str = "") -> Mesh:
        """The known mesh of a part, or the one that `make` makes."""
        return self.known[name] if name in self.known else make()

    def look(self, view: Any, frame: Floats | None = None) -> None:
        """Say from where the first shape is best seen."""
        if len(self.layers) == 0 and self.view is None:
            self.view, self.frame = view, self.frame if frame is None else frame


def scene_of(shapes: Shape | Sequence[Shape], picture: Picture, mesh: Mesh | Mapping[str, Mesh] | None = None) -> Scene:
    """The scene of one shape or several; `mesh` is that of the first, by part where it has parts.

    Raises `TypeError` for what is no shape, `ValueError` for none, and what meshing raises.
    """
    items = list(shapes) if isinstance(shapes, list | tuple) else [shapes]
    if not items:
        raise ValueError("there must be at least one surface to draw")
    kinds = [kind_of(item, "what to draw") for item in items]
    known = {} if mesh is None else mesh if isinstance(mesh, Mapping) else {"": mesh}
    scene = Scene(picture, known)
    for item, kind in zip(items, kinds, strict=True):
        kind.layers(item, scene)
        scene.known = {}
    return scene
