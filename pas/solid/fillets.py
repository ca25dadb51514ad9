"""Fillets and chamfers between two faces of a solid.

What surface is taken, and how high over each face it touches the other, the first of the makers says that has one for
the seam (`pas.solid.fillet_forms`).  With s and t the faces' polynomials over these heights and h = 1 - s - t, the
fillet is the part of it where s, t, h >= 0.

Guaranteed: the joints, which are proved before a fillet is given.  Looked at on its mesh: that it ends nowhere but at
the solid's own faces.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, count

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_order, shown_point
from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import plain, rational, to_float
from pas.errors import GeometryError, MeshError, meant
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh
from pas.mesh.projection import distances, newton
from pas.mesh.rows import Integers
from pas.registry import Registry
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined, complement

PIPES = (
    "; pipes of one radius are joined by pas.node, three of radius 1 in a T by "
    "pas.node([((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 0, 1), 1)]).solid(length=5)"
)
"""The end of a sentence about two quadrics that touch."""


@dataclass(frozen=True, eq=False)
class FaceSeam:
    """The edges in which two faces of a solid meet, as its mesh shows them, with what a fillet needs of them.

    `points` (N, 3) are on both faces, evenly along the edges.  `sign` is 1 where a fillet is added, -1 where it takes
    away.  `walls` are the polynomials, negative inside, of the faces in which the seam ends, where it leaves the solid.
    """

    faces: tuple[Polynomial, Polynomial]
    points: Floats
    sign: int
    walls: tuple[Polynomial, ...]

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
        found = cls(
            faces, points, 1 if above.all() else -1, tuple(_walls(solid, mesh, edges, [*numbers[0], *numbers[1]]))
        )
        flat = 1e-2  # sine of an angle between faces below which they are taken for tangent
        worst = int(np.argmax(found.cosines**2))
        if 1 - found.cosines[worst] ** 2 < flat**2:
            raise GeometryError(
                f"the faces {names[0]!r} and {names[1]!r} touch, or nearly so, near {shown_point(points[worst])}: a "
                f"fillet is for faces that meet with an angle" + (PIPES if all(f.degree == 2 for f in faces) else "")
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

    def runs_out(self, radius: float) -> float:
        """How far beyond the ends of an edge a fillet may take away, until it leaves the solid there."""
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


FilletForm = tuple[Polynomial, tuple[fmpq, fmpq]]
"""A surface, not positive on the side of the seam, and how high over each face it touches the other."""

FILLET_MAKERS: Registry[Callable[[FaceSeam, fmpq, int], FilletForm | None]] = Registry(
    "maker of fillets", {"torus": "pas.solid.fillet_forms:torus", "polynomial": "pas.solid.fillet_forms:bent"}
)
"""What makes the surface along a seam of a radius and an order: the first that has one there."""


@dataclass(frozen=True, eq=False)
class Levels:
    """Polynomials by number, whose common zeros are looked for."""

    functions: tuple[Polynomial, ...]

    def jets(self, points: Floats, labels: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of the polynomial that has the number, one for all of them."""
        function = self.functions[int(np.ravel(labels)[0])]
        return np.concatenate([function(points)[:, None], function.gradient(points)], axis=1)


@dataclass(frozen=True, eq=False)
class Filling:
    """What is asked: a solid, two of its faces with their seam, the order, where, and the name of the new face."""

    solid: Solid
    names: tuple[str, str]
    seam: FaceSeam
    order: int
    within: tuple[Polynomial, ...]
    face: str

    @classmethod
    def of(
        cls,
        solid: Solid,
        names: tuple[str, str],
        order: int,
        within: Sequence[PolynomialLike],
        face: str | None = None,
    ) -> Filling:
        """That of arguments of `Solid.fillet`, which are checked."""
        check_order(order)
        walls = tuple(Polynomial.named(wall, f"within[{i}]", constant=False) for i, wall in enumerate(within))
        title = face or _free(solid, "fillet" if order else "chamfer")
        return cls(solid, names, FaceSeam.of(solid, names), order, walls, title)

    def made(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet of a radius, or why there is none."""
        found = self.joined(radius)
        return found if isinstance(found, str) else self._strays(found) or found

    def joined(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet whose joints are proved, or why there is none; not looked at on a mesh."""
        checkpoint("proving a fillet")
        sign, (f, g), size = self.seam.sign, self.seam.faces, to_float(radius)
        forms = (maker(self.seam, radius, self.order) for maker in FILLET_MAKERS.values())
        surface, (a, b) = next(form for form in forms if form is not None)
        ends = self.seam.ends((a, b), size) if a > 0 and b > 0 else None
        if ends is None:
            return "one of the faces does not go on so far from the edge"
        s, t = f * (sign / a), g * (sign / b)
        h = 1 - s - t
        walls = [s, t, *([h] if self.order else []), *self.within]
        walls += _box(np.concatenate([self.seam.points, ends]), size if sign > 0 else self.seam.runs_out(size))
        walls += [-wall for wall in self.seam.walls] if sign > 0 else []
        piece = combined(False, Atom(surface, self.face), *(Atom(-wall, "") for wall in walls))
        whole = self.solid.tree
        tree = combined(True, whole, piece) if sign > 0 else combined(False, whole, complement(piece))
        claims = (
            Joint(self.face, self.names[0], (f, g - b * sign), self.order),
            Joint(self.face, self.names[1], (g, f - a * sign), self.order),
        )
        made = replace(self.solid, tree=tree, joints=claims, sheets=None)
        wrong = next((f"{v.claim}: {v.reason}" for v in made.verdicts if not v.proved), None)
        made = replace(made, joints=(*self.solid.joints, *claims))
        return wrong or made

    def _strays(self, made: Solid) -> str | None:
        """What is wrong where surfaces meet away from the edge, too, as the mesh shows; None where all is well.

        Pieces of a fillet there end in walls of its box, or beside a face that the solid has not got there: so they are
        flat in one, and touch the other without any thickness, which no mesh has.
        """
        try:
            mesh = made.mesh()
        except MeshError as error:
            return f"it has no mesh: {error}"
        known = {*made.faces}
        for face, name in enumerate(mesh.names):
            if not known.issuperset(name.split(" + ")):
                place = mesh.points[mesh.triangles[mesh.faces == face][0, 0]]
                return (
                    f"it would end in a wall near {shown_point(place)}: give as `within` polynomials that are positive "
                    f"where it is wanted"
                )
        return None

    def largest(self, above: fmpq) -> float | None:
        """The largest radius found below one, to a thirtieth, of a fillet that there is; None where there is none.

        Joints are proved for each that is tried.  A mesh is looked at of one a little smaller, as what nearly uses up a
        face takes long, and of others only where that one has strays.
        """
        found = _largest(self.joined, above)
        if found is not None and isinstance(self.made(found := found * fmpq(59, 60)), str):
            found = _largest(self.made, found)
        return None if found is None else to_float(found)


def _largest(made: Callable[[fmpq], Solid | str], above: fmpq) -> fmpq | None:
    """The largest number found below one, to a sixtieth, for which there is a solid; None where there is none."""
    share = fmpq(47, 100)  # at halves of the solid's size fillets may just touch its other faces, which takes long
    low, high, attempts = above * share, above, 10
    while isinstance(made(low), str):
        low, high, attempts = low * share, low, attempts - 1
        if not attempts:
            return None
    while high - low > low / 60:
        middle = short(to_float(low + (high - low) * share))
        low, high = (low, middle) if isinstance(made(middle), str) else (middle, high)
    return low


def filled(
    solid: Solid, names: tuple[str, str], radius: fmpq, order: int, within: Sequence[PolynomialLike], face: str | None
) -> Solid:
    """The solid with its edge between two faces rounded, or of order 0 cut off flatly; see `Solid.fillet`.

    Raises `GeometryError` where there is no such fillet, with the largest radius found of one that there is.
    """
    filling = Filling.of(solid, names, order, within, face)
    made = filling.made(radius)
    if not isinstance(made, str):
        return made
    largest = filling.largest(radius)
    raise GeometryError(
        f"a {'fillet' if order else 'chamfer'} of radius {plain(radius)} between {names[0]!r} and {names[1]!r} is not "
        f"proved: {made}; " + ("no smaller one is either" if largest is None else f"one of radius {largest:.3g} is")
    )


def largest(solid: Solid, names: tuple[str, str], order: int, within: Sequence[PolynomialLike]) -> float:
    """The largest radius, nearly, of a fillet that is proved; see `Solid.largest_fillet`."""
    found = Filling.of(solid, names, order, within).largest(short(float(np.ptp(solid.box, axis=0).max())))
    if found is None:
        raise GeometryError(f"no fillet between {names[0]!r} and {names[1]!r} is proved, however small")
    return found


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


def _box(points: Floats, room: float) -> list[Polynomial]:
    """Polynomials that are positive in a box around points (N, 3) with room to spare."""
    step = fmpq(2) ** int(np.floor(np.log2(room / 8)))
    found = []
    for g, values in zip(GENERATORS, points.T, strict=True):
        low, high = (int(np.floor(end / float(step))) for end in (values.min() - room, values.max() + room))
        # Planes at thirds of short numbers are not where the faces of solids mostly are.
        found += [
            Polynomial.from_raw(g - (low + fmpq(1, 3)) * step),
            Polynomial.from_raw((high + fmpq(2, 3)) * step - g),
        ]
    return found


def _free(solid: Solid, name: str) -> str:
    """The name, or with the first number behind it with which the solid has no face."""
    later = (f"{name} {number}" for number in count(2))
    return next(found for found in chain([name], later) if found not in solid.faces)


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


def _walls(solid: Solid, mesh: Mesh, edges: Integers, numbers: Sequence[int]) -> list[Polynomial]:
    """The polynomials of the faces through which the seam leaves the solid at its ends."""
    vertices, times = np.unique(edges, return_counts=True)
    found: dict[Polynomial, None] = {}
    for end in vertices[times == 1].tolist():
        edge = edges[(edges == end).any(axis=1)][0]
        way = mesh.points[end] - mesh.points[edge[edge != end][0]]
        around = np.unique(mesh.faces[(mesh.triangles == end).any(axis=1)])
        others = [mesh.names[number] for number in around.tolist() if number not in numbers]
        names = [name for together in others for name in together.split(" + ")]
        for wall in (wall for name in names for wall in solid.polynomials.get(name, ())):
            if wall.gradient(mesh.points[end]) @ way > 0:
                found[wall] = None
    return [*found]


def short(value: float) -> fmpq:
    """The decimal number of six digits nearest to a double."""
    return rational(f"{value:.6g}")
