"""What a picture is made of: its settings, and the layers that the shapes add to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pas.algebra.inputs import shown
from pas.algebra.monomials import Floats
from pas.exchange.picture_options import STYLES, Picture
from pas.mesh.mesh import Mesh
from pas.render.coloring import Coloring
from pas.render.layers import Layer
from pas.shape import Kind, Shape, kind_of


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
    def coloring(self) -> Coloring:
        """What the colours show."""
        coloring: Coloring = self.picture.coloring
        return coloring

    def mesh(self, make: Callable[[], Mesh], name: str = "") -> Mesh:
        """The known mesh of a part, or the one that `make` makes."""
        return self.known[name] if name in self.known else make()

    def look(self, view: Any, frame: Floats | None = None) -> None:
        """Say from where the first shape is best seen."""
        if len(self.layers) == 0 and self.view is None:
            self.view, self.frame = view, self.frame if frame is None else frame


def scene_of(shapes: Shape | Sequence[Shape], picture: Picture, mesh: Mesh | Mapping[str, Mesh] | None = None) -> Scene:
    """The scene of one shape or several; `mesh` is that of the first, by part where it has parts.

    Raises `TypeError` for what is no shape, `ValueError` for none and where curvatures are to be shown that a kind of
    shapes does not have, and what meshing raises.
    """
    items = list(shapes) if isinstance(shapes, list | tuple) else [shapes]
    if not items:
        raise ValueError("there must be at least one surface to draw")
    kinds = [kind_of(item, "what to draw") for item in items]
    for kind in kinds:
        _check_curved(kind, picture)
    known = {} if mesh is None else mesh if isinstance(mesh, Mapping) else {"": mesh}
    if not all(isinstance(part, Mesh) for part in known.values()):
        raise TypeError(f"mesh must be a pas.Mesh or map names of parts to such, not {shown(mesh)}")
    scene = Scene(picture, known)
    for item, kind in zip(items, kinds, strict=True):
        kind.layers(item, scene)
        scene.known = {}
    return scene


def _check_curved(kind: Kind[Any], picture: Picture) -> None:
    if picture.curved and not kind.curved:
        what = "combs" if picture.combs else "colours"
        others = [name for name, coloring in STYLES.items() if not coloring.curved]
        article = "an" if kind.name[0] in "aeiou" else "a"
        raise ValueError(
            f"curvature {what} exist for blends and surfaces, and this is {article} {kind.name}; "
            f"draw it in one of the styles {', '.join(others)}{' without combs' if picture.combs else ''}"
        )
