"""The edges in which two faces of a solid meet, as its mesh shows them, with the data that a fillet needs."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from flint import fmpq

from pas.algebra.affine import slope_at
from pas.algebra.inputs import shown_point
from pas.algebra.lengths import lengths, unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, decimal, dot, near, square_root, to_float
from pas.arrays import Floats, Integers
from pas.errors import GeometryError, meant
from pas.mesh.mesh import Mesh
from pas.mesh.projection import CommonZeros, distances, newton
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree

_WHERE = ": it does of order 0 to 2 along a plane with planes and circular cylinders that stand on it"


@dataclass(frozen=True)
class SmoothEnd:
    """An end of a seam from which it continues smoothly as the seam of two faces with given `names`.

    `plane` is across it, positive along it; `tangent` is what both faces touch there that continue one another.
    """

    names: tuple[str, str]
    plane: Polynomial
    tangent: Polynomial


@dataclass(frozen=True, eq=False)
class FaceSeam:
    """The edges in which two faces of a solid meet, as its mesh shows them, with what a fillet needs of them.

    `points` (N, 3) are on both faces, evenly along the edges.  `sign` is 1 where a fillet is added, -1 where it takes
    away.  `smooth` are its ends where one of the faces goes on as another one by a claimed joint; where a face does and
    the seam does not, `goes_on` says it in words.  `left` are polynomials, negative along it, of faces through which it
    leaves the solid; `entered` those of faces that it runs into, positive along it, over the lengths of their gradients
    there.  `beside` are the faces next to the two that it is inside of.
    """

    names: tuple[str, str]
    faces: tuple[Polynomial, Polynomial]
    points: Floats
    sign: int
    smooth: tuple[SmoothEnd, ...] = ()
    goes_on: str = ""
    left: tuple[Polynomial, ...] = ()
    entered: tuple[Polynomial, ...] = ()
    beside: tuple[tuple[str, Polynomial], ...] = ()

    @classmethod
    def of(cls, solid: Solid, names: tuple[str, str], sharp: Set[frozenset[tuple[str, str]]] = frozenset()) -> FaceSeam:
        """The seam of two faces by name, at sharp ends not of others; raises `GeometryError` where none can be
        filled."""
        mesh = solid.mesh()
        numbers = [face_numbers(mesh, name) for name in names]
        edges = edges_between(mesh, *numbers)
        if not len(edges):
            if unknown := next((name for name in names if name not in solid.faces), None):
                known = meant(unknown, solid.faces) or f"; its faces are {', '.join(map(repr, solid.faces))}"
                raise GeometryError(f"the solid has no face {unknown!r}{known}")
            raise GeometryError(f"the faces {names[0]!r} and {names[1]!r} of the solid do not meet in an edge")
        first, second = (_polynomial(solid, mesh, name, np.unique(edges)) for name in names)
        faces = first, second
        points, reach = _along(mesh.points[edges])
        points = CommonZeros(faces).placed(points, reach)
        middles, ways = mesh.points[edges].mean(axis=1), mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
        crossed = np.cross(faces[0].gradient(middles), faces[1].gradient(middles))
        above = (crossed * ways).sum(axis=1) < 0
        found = _ended(cls(names, faces, points, 1 if above.all() else -1), solid, mesh, edges, sharp)
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

    @classmethod
    def chain(
        cls, solid: Solid, names: tuple[str, str], fits: Callable[[FaceSeam, SmoothEnd], bool]
    ) -> tuple[FaceSeam, ...]:
        """The seam of two faces and all in which it goes on smoothly at ends that fit.

        A name may be that of several numbered faces.  Raises `GeometryError` where there is none to be filled, and
        where it does not go on along all such faces.
        """
        mesh, sides = solid.mesh(), [[n] if n in solid.faces else _numbered(solid, n) or [n] for n in names]
        pairs = [(one, other) for one in sides[0] for other in sides[1]]
        numbers = {name: face_numbers(mesh, name) for name in (*sides[0], *sides[1])}
        met = [(a, b) for a, b in pairs if len(edges_between(mesh, numbers[a], numbers[b]))] or pairs
        sharp, wrong = set[frozenset[tuple[str, str]]](), {frozenset(pairs[:1])}
        while wrong:
            sharp |= wrong
            found, left = dict[tuple[str, str], FaceSeam](), met[:1]
            while left:
                pair = left.pop()
                if pair not in found:
                    found[pair] = cls.of(solid, pair, sharp)
                    left += [end.names for end in found[pair].smooth]
            ends = ((pair, seam, end) for pair, seam in found.items() for end in seam.smooth)
            wrong = {frozenset((pair, end.names)) for pair, seam, end in ends if not fits(seam, end)}
        if alone := next((pair for pair in met if len(pairs) > 1 and pair not in found), None):
            raise GeometryError(
                f"the edge of {alone[0]!r} and {alone[1]!r} does not go on smoothly from that of {met[0][0]!r} and "
                f"{met[0][1]!r}: give the name of one face, not one for several with numbers{found[met[0]].goes_on}"
            )
        return tuple(found.values())

    @cached_property
    def sectors(self) -> tuple[tuple[Polynomial, ...], ...]:
        """Planes at its smooth ends: of one set of them all are positive at each point, unless it turns too far."""
        planes, size = tuple(dict.fromkeys(end.plane for end in self.smooth)), float(np.ptp(self.points, axis=0).max())
        ahead = (plane(self.points) > -1e-9 * size * lengths(plane.gradient(self.points)) for plane in planes)
        return (planes,) if all(some.all() for some in ahead) else tuple((plane,) for plane in planes)

    @cached_property
    def normals(self) -> Floats:
        """The unit normals (2, N, 3) of both faces outwards at the points."""
        return np.stack([unit(face.gradient(self.points)) for face in self.faces])

    @cached_property
    def cosines(self) -> Floats:
        """The cosines (N,) of the angles between the normals."""
        return np.asarray((self.normals[0] * self.normals[1]).sum(axis=1))

    def centers(self, radius: float) -> Floats:
        """The centres (N, 3) of balls of a radius that touch both faces, where these are flat."""
        reach = self.sign * radius / (1 + self.cosines)[:, None]
        return np.asarray(self.points + reach * self.normals.sum(axis=0))

    def turned_back(self, radius: float) -> list[bool]:
        """For each face, whether its function somewhere falls again before the depth of such a ball's centre."""
        known = zip(self.faces, self.points + self.sign * radius * self.normals, self.normals, strict=True)
        flat = 1e-9  # slope where such a ball is as large as the face is bent, over that on the face
        return [
            bool(((face.gradient(deep) * n).sum(axis=1) < -flat * lengths(face.gradient(self.points))).any())
            for face, deep, n in known
        ]

    def outwards(self, ends: Floats) -> Floats:
        """The unit normals (2 N, 3) of the faces at points of `ends`."""
        return np.concatenate([unit(f.gradient(some)) for f, some in zip(self.faces, np.split(ends, 2), strict=True)])

    def runs_out(self, radius: float) -> float:
        """How far beyond the ends of an edge a fillet goes, until it leaves the solid or is inside."""
        return 2 * radius * (1 + float(np.sqrt((1 - self.cosines) / (1 + self.cosines)).max()))

    def ends(self, heights: tuple[fmpq, fmpq], radius: float, curves: tuple[bool, bool]) -> Floats | None:
        """Points (2 N, 3) on the faces in which a fillet ends, in points alone where that is no curve; None where a
        face does not go that far."""
        one, other = self.faces
        levels = CommonZeros((one, other, one - heights[0] * self.sign, other - heights[1] * self.sign))
        tangents = radius * np.sqrt((1 - self.cosines) / (1 + self.cosines))[:, None]
        found = []
        for mine, its in ((0, 1), (1, 0)):
            way = self.sign * unit(self.normals[its] - self.cosines[:, None] * self.normals[mine])
            reach = np.full(len(way), radius)
            numbers = mine, 2 + its
            moved = self.points + tangents * way
            moved = newton(moved, levels, numbers, reach) if curves[mine] else moved
            off = [distances(levels, moved, number).max() for number in numbers]
            if curves[mine] and max(off) > 1e-6 * radius:  # beyond what rounding leaves
                return None
            found.append(moved)
        return np.concatenate(found)


def _along(edges: Floats) -> tuple[Floats, float]:
    """Points (N, 3) along edges (E, 2, 3), at their ends and between, and how far these are apart at most."""
    lengths = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    parts = np.ceil(lengths / (lengths.sum() / 64)).astype(np.intp)
    rows = np.repeat(np.arange(len(edges)), parts)
    shares = (np.arange(len(rows)) - np.repeat(np.cumsum(parts) - parts, parts) + 0.5) / parts[rows]
    middles = edges[rows, 0] + shares[:, None] * (edges[rows, 1] - edges[rows, 0])
    return np.concatenate([middles, np.unique(edges.reshape(-1, 3), axis=0)]), float((lengths / parts).max())


def _polynomial(solid: Solid, mesh: Mesh, name: str, vertices: Integers) -> Polynomial:
    """The one polynomial, negative inside, of a face on which vertices of its mesh are."""
    found, points = solid.polynomials.get(name, ()), mesh.points[vertices]
    if len(found) > 1:  # of several of one name that on which all of the edge is, and which is outwards there
        corners = np.isin(mesh.triangles, vertices) & np.isin(mesh.faces, face_numbers(mesh, name))[:, None]
        places, normals, close = mesh.points[mesh.triangles[corners]], mesh.normals[corners], 1e-6 * np.ptp(points)
        on = [f for f in found if (abs(f(points)) <= close * lengths(f.gradient(points))).all()]
        found = tuple(f for f in on if ((f.gradient(places) * normals).sum(axis=1) > 0).all())
    if len(found) != 1:
        many = "has its edge on several polynomials: give faces names of their own"
        what = many if solid.polynomials.get(name) else "is on no polynomial: a fillet needs a face that is on one"
        raise GeometryError(f"the face {name!r} {what}")
    return found[0]


def edges_between(mesh: Mesh, first: Sequence[int], second: Sequence[int]) -> Integers:
    """The edges (E, 2) between some faces of a mesh and others, with the former on their left."""
    corners = [mesh.triangles[np.isin(mesh.faces, numbers)] for numbers in (first, second)]
    sides = [np.concatenate([np.roll(c, -i, axis=1) for i in range(3)]) for c in corners]
    n = len(mesh.points)
    keys = sides[0][:, 0] * n + sides[0][:, 1], sides[1][:, 1] * n + sides[1][:, 0]
    _, mine, _ = np.intersect1d(*keys, return_indices=True)
    return np.asarray(sides[0][mine, :2])


def face_numbers(mesh: Mesh, name: str) -> list[int]:
    """The faces of a mesh, by number, that have a name."""
    return [number for number, names in enumerate(mesh.solid_faces) if name in names]


def _numbered(solid: Solid, name: str) -> list[str]:
    """The faces that have this name followed by a number."""
    return [face for face in solid.faces if face.startswith(f"{name} ") and face[len(name) + 1 :].isdigit()]


def _ended(
    seam: FaceSeam, solid: Solid, mesh: Mesh, edges: Integers, sharp: Set[frozenset[tuple[str, str]]]
) -> FaceSeam:
    """A seam with what ends it, and the faces beside it."""
    names, points, parts = seam.names, seam.points, mesh.solid_faces
    own = [number for number, some in enumerate(parts) if not {*names}.isdisjoint(some)]
    vertices, times = np.unique(edges, return_counts=True)
    size, flat = float(np.ptp(mesh.points, axis=0).max()), 1e-6  # below which a seam goes along a face
    smooth, left, entered, goes_on = list[SmoothEnd](), list[Polynomial](), list[Polynomial](), ""
    for end in vertices[times == 1].tolist():
        place, (edge, *_) = mesh.points[end], edges[(edges == end).any(axis=1)]
        way = unit(place - mesh.points[edge[edge != end][0]])
        around = np.unique(mesh.faces[(mesh.triangles == end).any(axis=1)])
        here = dict.fromkeys(name for number in around.tolist() if number not in own for name in parts[number])
        for joint in (joint for joint in solid.joints if joint.order):
            for one, other in ((joint.first, joint.second), (joint.second, joint.first)):
                if one in names and other in here:
                    found = _smooth_end(seam, mesh, joint, (one, other), end, way)
                    if found and frozenset((names, found.names)) not in sharp:
                        smooth.append(found)
                        del here[other]
                    else:
                        sharply = f", where {one!r} goes on smoothly in {other!r} and a fillet does not{_WHERE}"
                        goes_on = goes_on or sharply
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
    return replace(
        seam,
        smooth=tuple(smooth),
        goes_on=goes_on,
        left=tuple(filter(ahead, dict.fromkeys(left))),
        entered=tuple(wall for wall in dict.fromkeys(entered) if ahead(-wall)),
        beside=tuple((name, w) for name in next_to for w in solid.polynomials.get(name, ()) if (w(points) < 0).all()),
    )


def _smooth_end(
    seam: FaceSeam, mesh: Mesh, joint: Joint, going: tuple[str, str], end: int, way: Floats
) -> SmoothEnd | None:
    """The smooth end of a seam at a vertex, up to which its way is given, where one of its faces continues as another.

    None where the other face of the seam ends there, or where the joint is not in a plane across it.
    """
    first, second = (going[1] if name == going[0] else name for name in seam.names)
    if end not in edges_between(mesh, face_numbers(mesh, first), face_numbers(mesh, second)):
        return None
    place, close = mesh.points[end], 1 - 1e-12  # the cosine of directions of exact functions at a vertex of a mesh
    normals = unit(seam.faces[0].gradient(place)), unit(seam.faces[1].gradient(place))
    along, normal = unit(np.cross(*normals)), normals[seam.names.index(going[0])]
    for plane, tangent in (joint.along, joint.along[::-1]):
        cosines = float(unit(plane.gradient(place)) @ along), float(unit(tangent.gradient(place)) @ normal)
        if plane.degree == tangent.degree == 1 and min(map(abs, cosines)) > close:
            back = 1 if (along @ way) * cosines[0] < 0 else -1
            return SmoothEnd((first, second), plane * back, tangent * (1 if cosines[1] > 0 else -1))
    return None


@dataclass(frozen=True, eq=False)
class PlaneFace:
    """A plane face: its name ("" for a wall), its polynomial, and normal . x + offset, which that is."""

    name: str
    polynomial: Polynomial
    normal: Vector
    offset: fmpq

    @classmethod
    def of(cls, part: Tree) -> PlaneFace | None:
        """The plane face of a part of an intersection; None where it is no half space."""
        if not isinstance(part, Atom) or not isinstance(part.function, Polynomial) or part.function.degree != 1:
            return None
        polynomial = -part.function if part.outside else part.function
        return cls(part.face, polynomial, slope_at(polynomial), polynomial.raw(0, 0, 0))

    @cached_property
    def length(self) -> fmpq:
        """The length of the normal, to six digits where it is not rational."""
        root = square_root(dot(self.normal, self.normal))
        return root if root * root == dot(self.normal, self.normal) else decimal(to_float(root))

    def cosine(self, other: PlaneFace) -> fmpq:
        """The cosine of the angle between the normals."""
        return fmpq(1) if other is self else dot(self.normal, other.normal) / (self.length * other.length)
