"""What a style of pictures is: colours for the layers of a scene, and a legend where they stand for numbers.

A style of one's own is a `Coloring` with a name, registered by `pas.exchange.picture_options.STYLES.register(...)`;
then `pas.draw(..., style=NAME)`, `pas render --style NAME` and problem files know it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from pas.algebra.monomials import Floats

if TYPE_CHECKING:
    from pas.render.scene import Scene


@dataclass(frozen=True)
class Paint:
    """The colours of one layer: `values`, or None for the layer's own colour.

    Values are (M,) at the points of `mesh.shading`, or (T, 3) at the corners of its triangles, where a point may have
    another one in each.  `options` are further keywords of pyvista's `add_mesh`.
    """

    values: Floats | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Legend:
    """What numbers the colours stand for: a bar over `limits` in the colours `cmap` between lines of text."""

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

    @abstractmethod
    def paint(self, scene: Scene) -> tuple[list[Paint], Legend | None]:
        """The colours of each of the scene's layers, and what they stand for."""
