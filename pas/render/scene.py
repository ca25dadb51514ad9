"""The scene of a picture: the layers that shapes add to it, and what a style does with them.

A style of one's own is a `Coloring` with a name, registered by `pas.exchange.picture_options.STYLES.register(...)`;
then `pas.draw(..., style=NAME)`, `pas render --style NAME` and problem files know it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from pas.algebra.inputs import shown
from pas.arrays import Floats
from pas.exchange.picture_options import STYLES, Picture
from pas.mesh.mesh import Mesh
from pas.shape import Kind, Shape, kind_of, one

BLEND_COLOR, PIPE_COLOR, CURVE_COLOR = "#e8a33d", "#b9c4cf", "#22303c"

COLORS = ("#5b8db8", "#7fae7a", "#b07aa1", "#9c755f", "#76b7b2", "#c95d63")
"""The colours of the surfaces that a blend meets, in their order, and of several surfaces."""

BLEND_TINT, TINTS = "#f6c877", ("#b9d3ea", "#c6e2c0", "#dfc3d8", "#d9c3b4", "#c5e4e1", "#efbcbf")
"""The colours of their bright stripes."""


@dataclass(frozen=True, eq=False)
class Comb:
    """A curve on a surface: its `points` (n, 3), unit `normals` (n, 3) of the surface and its normal `curvatures` (n,).

    The curvatures, over the model's length, are those of the surface along the curve, positive where it bends like a
    ball whose normals point outwards.
    """

    points: Floats
    normals: Floats
    curvatures: Floats


@dataclass(frozen=True)
class Layer:
    """A mesh in a colour; `tint` is that of the bright stripes.

    `principal` gives the principal curvatures (N, 2) at the mesh's points, the larger first, positive where the
    surface bends like a ball whose normals point outwards; None where they are not known.  `unit` is a curvature to
    compare them with, `combs` are drawn on the layer.  `outlined` draws its boundary and the edges between its faces,
    `opacity` is 1 for what is not seen through.  `aside`: what stands around the surface that matters, and is drawn
    faintly where curvature is shown.  `name` is that of a part.
    """

    mesh: Mesh
    color: str
    tint: str = "white"
    principal: Callable[[], Floats] | None = None
    unit: float | None = None
    combs: tuple[Comb, ...] = ()
    outlined: bool = False
    opacity: float = 1.0
    aside: bool = False
    name: str = ""


@dataclass(frozen=True)
class Paint:
    """The colours of one layer: `values`, or `faces`, or neither for the layer's own colour.

    Values are (M,) at the points of `mesh.shading`, or (T, 3) at the corners of its triangles, where a point may have
    another one in each; `faces` are the colours of its faces as #rrggbb.  `options` are further keywords of pyvista's
    `add_mesh`.
    """

    values: Floats | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    faces: Sequence[str] = ()


@dataclass(frozen=True)
class Legend:
    """The meaning of the colours: a bar over `limits` in the colours `cmap` between lines of text."""

    title: str
    lines: tuple[str, ...]
    limits: tuple[float, float]
    cmap: Any


class Coloring(ABC):
    """What the colours of a picture show.

    `fine`: meshes are made finer, since it shows facets that shading hides.  `curved`: it needs curvatures, which not
    every kind of shape has.  `backdrop`: the colours of the background, low and high.
    """

    name: str
    shows: str
    fine: bool = False
    curved: bool = False
    backdrop: ClassVar[tuple[str, str]] = ("white", "#dfe8f0")

    @property
    def tolerance(self) -> float:
        """The tolerance of meshes for it, over the extent of the shape: stripes show facets that shading hides."""
        return 2e-4 if self.fine else 1e-3

    @abstractmethod
    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """The colours of each of the scene's layers, and what they stand for."""


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


def solid_layers(shape: Shape, scene: Scene, name: str = "", color: str = BLEND_COLOR) -> None:
    """Add a solid or a mesh in a colour."""
    mesh = scene.mesh(lambda: shape.mesh(scene.picture.tolerance), name)
    scene.look((0.35, -1.0, 0.45))  # past the front, from above
    scene.layers.append(Layer(mesh, color, outlined=True, name=name))


def _check_curved(kind: Kind[Any], picture: Picture) -> None:
    if picture.curved and not kind.curved:
        what = "combs" if picture.combs else "colours"
        others = [name for name, coloring in STYLES.items() if not coloring.curved]
        raise ValueError(
            f"curvature {what} exist for blends and surfaces, and this is {one(kind.name)}; "
            f"draw it in one of the styles {', '.join(others)}{' without combs' if picture.combs else ''}"
        )
