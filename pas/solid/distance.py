"""Distances as functions of solids: values that change by at most 1 per unit of length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from itertools import product
from typing import ClassVar

import numpy as np

from pas.algebra.affine import Affine
from pas.algebra.monomials import Floats
from pas.solid.tree import Atom, Bools, Node, Tree, combined, image, mapped

CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))
"""Of a cube about the origin."""


@dataclass(frozen=True)
class Followed:
    """Faces, by name, of a set from which something is a distance, less a thickness; the names of all of its faces."""

    tree: Tree
    faces: frozenset[str]
    all: frozenset[str]
    thickness: float

    def moved(self, map_: Affine) -> Followed:
        """The image under a similarity."""

        def move(atom: Atom) -> Atom:
            return replace(atom, function=image(atom.function, map_))

        return replace(self, tree=mapped(self.tree, move), thickness=self.thickness * map_.similarity())


class Distance(ABC):
    """A function whose values change by at most 1 per unit of length, such as a distance less a radius.

    `follows` are the faces of a set, if any, on which it is negative: it is a distance from them, less a thickness.
    """

    follows: Followed | None = None
    exponent: ClassVar[int] = 0

    @abstractmethod
    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4) at points (N, 3)."""

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in boxes: in the balls about them."""
        return self.decided_within(centers, np.sqrt((halves * halves).sum(axis=1)))

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """Whether it is certainly <= 0, and certainly > 0, in balls of given centres (N, 3) and radii (N,)."""
        value = self.jets(centers)[:, 0]
        return value + radii <= 0, value - radii > 0

    def slopes(self, centers: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Gradients (N, 3) at the centres of boxes, and how much they differ at the corners (N, 3)."""
        gradients = self.jets(centers)[:, 1:]
        corners = (centers[:, None] + halves[:, None] * CORNERS).reshape(-1, 3)
        changes = self.jets(corners)[:, 1:].reshape(-1, len(CORNERS), 3) - gradients[:, None]
        return gradients, np.abs(changes).max(axis=1)

    def moved(self, map_: Affine) -> Distance:
        """The distance after a similarity; raises `ValueError` for other maps."""
        return Moved(self, map_, map_.similarity())


@dataclass(frozen=True, eq=False)
class Moved(Distance):
    """A distance after a similarity that changes lengths by a factor."""

    inner: Distance
    map: Affine
    factor: float

    @property
    def follows(self) -> Followed | None:  # type: ignore[override]
        """The images of the faces that the inner one follows."""
        return self.inner.follows and self.inner.follows.moved(self.map)

    def jets(self, points: Floats) -> Floats:
        """Values and gradients (N, 4)."""
        jets = self.inner.jets(self.map.inverse.points(points))
        jets[:, 0] *= self.factor
        jets[:, 1:] = self.factor * jets[:, 1:] @ self.map.inverse.floats[0]
        return jets

    def decided_within(self, centers: Floats, radii: Floats) -> tuple[Bools, Bools]:
        """What the inner one says of the balls before they were moved."""
        return self.inner.decided_within(self.map.inverse.points(centers), radii / self.factor)


def followed_by(tree: Tree) -> tuple[Tree, list[tuple[Distance, Followed]]] | None:
    """The set of which a tree is a shell, and the distances from its faces, and what they follow; or None."""
    parts = tree.parts if isinstance(tree, Node) and not tree.union else ()
    for part in parts:
        others = [other for other in parts if other is not part]
        walls = part.parts if isinstance(part, Node) and part.union else (part,)
        functions = [w.function for w in walls if isinstance(w, Atom) and not w.outside]
        found = [(f, f.follows) for f in functions if isinstance(f, Distance) and f.follows is not None]
        if others and len(found) == len(walls):
            rest = combined(False, *others)
            if all(follows.tree == rest for _, follows in found):
                return rest, found
    return None
