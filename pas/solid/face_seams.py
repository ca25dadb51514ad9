"""The edges in which two faces of a solid meet, as its mesh shows them, with what a fillet needs to know of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq

from pas.algebra.inputs import shown_point
from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import near
from pas.errors import GeometryError, meant
from pas.mesh.mesh import Mesh
from pas.mesh.projection import distances, newton
from pas.mesh.rows import Integers
from pas.solid.solid import Solid


@dataclass(frozen=True, eq=False)
class FaceSeam:
    """The edges in which two faces of a solid meet, as its mesh shows them, with what a fillet needs of them.

    `points` (N, 3) are on both faces, evenly along the edges.  `sign` is 1 where a fillet is added, -1 where it takes
    away.  `goes_on` says in words where a face goes on smoothly at an end.  `left` are polynomials, negative along it,
    of faces through which it leaves the solid; `entered` those of faces that it runs into, positive along it, over the
    lengths of their gradients there.  `beside` are the faces next to the two that it is inside of.
    """

    faces: tuple[Polynomial, Polynomial]
    points: Floats
    sign: int
    goes_on: str
    left: tuple[Polynomial, ...]
    entered: tuple[Polynomial, ...]
    beside: tuple[tuple[str, Polynomial], ...]

    @classmethod
    def of(cls, solid: Solid, names: tuple[str, str]) -> FaceSeam:
        """The seam of two faces by their names; raises `GeometryError` where there is none to be filled."""
        faces = _polynomial(solid, names[0]), _polynomial(solid, names[1])
        mesh = solid.mesh()
        numbers = [[k for k, several in enumerate(mesh.names) if name in several.split(" + ")] for name in names]
        edges = edges_between(mesh, *numbers)
        if not len(edges):
            raise GeometryError(f"the faces {names[0]!r} and {names[1]!r} of the solid do not meet in an edge")
        points, reach = _along(mesh.points[edges])
        points = newton(points, Levels(faces), _numbers(points, 0, 1), np.full(len(points), reach))
        middles, ways = mesh.points[edges].mean(axis=1), mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
        crossed = np.cross(faces[0].gradient(middles), faces[1].gradient(middles))
        above = (crossed * ways).sum(axis=1) < 0
        found = cls(faces, points, 1 if above.all() else -1, *_walls(solid, mesh, edges, names, points))
        flat = 1e-2  # sine of an angle between faces below which they are taken for tangent
        worst = int(np.argmax(found.cosines**2))
        if 1 - found.cosines[worst] ** 2 < flat**2:
            raise GeometryError(
                f"the faces {names[0]!r} and {names[1]!r} touch, or nearly so, near {shown_point(points[worst])}: a "
                f"fillet is for faces that meet with an angle, or for pipes whose axes meet"
            )
        if above.any() != above.all():
            raise GeometryError(
                f"the faces {names[0]!r} and {names[1]!r} meet in edges that go out and such that go in; "
                f"give the fillet of each its own solid, before they are united"
            )
        return found

    @cached_property
    def normals(self) -> Floats:
        """The unit normals (2, N, 3) of both faces outwards at the points."""
        return np.stack([unit(face.gradient(self.points)) for face in self.faces])

    @cached_property
    def cosines(self) -> Floats:
        """Those (N,) of the angles between the normals."""
        return np.asarray((self.normals[0] * self.normals[1]).sum(axis=1))

    def centers(self, radius: float) -> Floats:
        """Those (N, 3) of balls of a radius that touch both faces, where these are flat."""
        reach = self.sign * radius / (1 + self.cosines)[:, None]
        return np.asarray(self.points + reach * self.normals.sum(axis=0))

    def turned_back(self, radius: float) -> list[bool]:
        """Of both faces, whether somewhere its function falls again before the depth of such a ball's centre."""
        known = zip(self.faces, self.points + self.sign * radius * self.normals, self.normals, strict=True)
        return [bool(((face.gradient(deep) * n).sum(axis=1) <= 0).any()) for face, deep, n in known]

    def outwards(self, ends: Floats) -> Floats:
        """The unit normals (2 N, 3) of the faces at points of `ends`."""
        return np.concatenate([unit(f.gradient(some)) for f, some in zip(self.faces, np.split(ends, 2), strict=True)])

    def runs_out(self, radius: float) -> float:
        """How far beyond the ends of an edge a fillet goes, until it leaves the solid or is inside."""
        return 2 * radius * (1 + float(np.sqrt((1 - self.cosines) / (1 + self.cosines)).max()))

    def ends(self, heights: tuple[fmpq, fmpq], radius: float) -> Floats | None:
        """Points (2 N, 3) of the curves on the faces in which a fillet ends; None where a face does not go that far."""
        one, other = self.faces
        levels = Levels((one, other, one - heights[0] * self.sign, other - heights[1] * self.sign))
        tangents = radius * np.sqrt((1 - self.cosines) / (1 + self.cosines))[:, None]
        found = []
        for mine, its in ((0, 1), (1, 0)):
            way = self.sign * unit(self.normals[its] - self.cosines[:, None] * self.normals[mine])
            reach = np.full(len(way), radius)
            numbers = _numbers(way, mine, 2 + its)
            moved = newton(self.points + tangents * way, levels, numbers, reach)
            off = [distances(levels, moved, column).max() for column in numbers.T]
            if max(off) > 1e-6 * radius:  # beyond what rounding leaves
                return None
            found.append(moved)
        return np.concatenate(found)


@dataclass(frozen=True, eq=False)
class Levels:
    """Polynomials by number, whose common zeros are looked for."""

    functions: tuple[Polynomial, ...]

    def jets(self, points: Floats, labels: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of the polynomial that has the number, one for all of them."""
        function = self.functions[int(np.ravel(labels)[0])]
        return np.concatenate([function(points)[:, None], function.gradient(points)], axis=1)


def _along(edges: Floats) -> tuple[Floats, float]:
    """Points (N, 3) along edges (E, 2, 3), at their ends and between, and how far these are apart at most."""
    lengths = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    parts = np.ceil(lengths / (lengths.sum() / 64)).astype(np.intp)
    rows = np.repeat(np.arange(len(edges)), parts)
    shares = (np.arange(len(rows)) - np.repeat(np.cumsum(parts) - parts, parts) + 0.5) / parts[rows]
    middles = edges[rows, 0] + shares[:, None] * (edges[rows, 1] - edges[rows, 0])
    return np.concatenate([middles, np.unique(edges.reshape(-1, 3), axis=0)]), float((lengths / parts).max())


def _numbers(points: Floats, *numbers: int) -> Integers:
    """Functions by number, (N, m), which are those of each of N points."""
    return np.tile(np.array(numbers, dtype=np.intp), (len(points), 1))


def _polynomial(solid: Solid, name: str) -> Polynomial:
    """The one polynomial, negative inside, of a face."""
    if name not in solid.faces:
        known = meant(name, solid.faces) or f"; its faces are {', '.join(map(repr, solid.faces))}"
        raise GeometryError(f"the solid has no face {name!r}{known}")
    found = solid.polynomials.get(name, ())
    if len(found) != 1:
        what = f"is on {len(found)} polynomials" if found else "is on no polynomial"
        raise GeometryError(f"the face {name!r} {what}: a fillet needs a face that is on one")
    return found[0]


def edges_between(mesh: Mesh, first: Sequence[int], second: Sequence[int]) -> Integers:
    """The edges (E, 2) between some faces of a mesh and others, with the former on their left."""
    corners = [mesh.triangles[np.isin(mesh.faces, numbers)] for numbers in (first, second)]
    sides = [np.concatenate([np.roll(c, -i, axis=1) for i in range(3)]) for c in corners]
    n = len(mesh.points)
    keys = sides[0][:, 0] * n + sides[0][:, 1], sides[1][:, 1] * n + sides[1][:, 0]
    _, mine, _ = np.intersect1d(*keys, return_indices=True)
    return np.asarray(sides[0][mine, :2])


Walls = tuple[Polynomial, ...]


def _walls(
    solid: Solid, mesh: Mesh, edges: Integers, names: tuple[str, str], points: Floats
) -> tuple[str, Walls, Walls, tuple[tuple[str, Polynomial], ...]]:
    """What ends a seam with points (N, 3), and the faces beside it, as in `FaceSeam`."""
    parts = [name.split(" + ") for name in mesh.names]
    own = [number for number, some in enumerate(parts) if not {*names}.isdisjoint(some)]
    vertices, times = np.unique(edges, return_counts=True)
    size, flat = float(np.ptp(mesh.points, axis=0).max()), 1e-6  # below which a seam goes along a face
    smooth, left, entered = dict[tuple[str, str], None](), list[Polynomial](), list[Polynomial]()
    for end in vertices[times == 1].tolist():
        place, (edge, *_) = mesh.points[end], edges[(edges == end).any(axis=1)]
        way = unit(place - mesh.points[edge[edge != end][0]])
        around = np.unique(mesh.faces[(mesh.triangles == end).any(axis=1)])
        here = {name for number in around.tolist() if number not in own for name in parts[number]}
        pairs = (pair for j in solid.joints for pair in ((j.first, j.second), (j.second, j.first)))
        smooth |= dict.fromkeys(pair for pair in pairs if pair[0] in names and pair[1] in here)
        for wall in (wall for name in here for wall in solid.polynomials.get(name, ())):
            length = float(np.linalg.norm(wall.gradient(place)))
            rise = float(wall.gradient(place) @ way) / length
            if abs(rise) <= flat:  # what it runs into may begin tangentially
                rise = min(0.0, float(wall(place + 1e-3 * size * way)) / (1e-3 * size * length))
            if abs(rise) > 1e-7:
                (left if rise > 0 else entered).append(wall if rise > 0 else wall * near(1 / length))

    def ahead(wall: Polynomial) -> bool:
        """Whether the seam is nowhere behind a wall."""
        return bool((wall(points) <= flat * size * np.linalg.norm(wall.gradient(points), axis=1)).all())

    numbers = [number for number in range(len(parts)) if number not in own and len(edges_between(mesh, own, [number]))]
    next_to = dict.fromkeys(name for number in numbers for name in parts[number])
    return (
        "".join(f", where {one!r} goes on smoothly in {other!r} and a fillet does not" for one, other in [*smooth][:1]),
        tuple(filter(ahead, dict.fromkeys(left))),
        tuple(wall for wall in dict.fromkeys(entered) if ahead(-wall)),
        tuple((name, w) for name in next_to for w in solid.polynomials.get(name, ()) if (w(points) < 0).all()),
    )
