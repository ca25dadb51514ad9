"""Fillets and chamfers between two faces of a solid.

With s and t the faces' polynomials over heights a and b, and h = 1 - s - t, the fillet of order k is

    mu s t = h^(k+1)  where s, t, h >= 0,

which has contact of order k with the faces f = 0 and g = 0 along g = b and f = a (Hoffmann and Hopcroft 1985, Warren
1989).  The heights are those at which a rolling ball touches the other face, in the mean along the edge; mu = 2 + 2 c
with the mean cosine c between normals, which makes the fillet of two planes a circular cylinder.

Guaranteed: the joints, which are proved before a fillet is given.  Not guaranteed: that the fillet of curved faces is
near a rolling ball's, which is no algebraic surface of such a degree.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_order
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import plain, rational, to_float
from pas.errors import GeometryError, meant
from pas.limits import checkpoint
from pas.mesh.mesh import Mesh
from pas.mesh.rows import Integers
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined, complement


@dataclass(frozen=True, eq=False)
class FaceSeam:
    """The edges in which two faces of a solid meet, as its mesh shows them, with what a fillet needs of them.

    `points` (N, 3) are on both faces, with unit normals (2, N, 3) outwards.  `is_concave` says on which side the solid
    is.  `walls` are the polynomials, negative inside, of the faces in which the seam ends, where it leaves the solid.
    """

    faces: tuple[Polynomial, Polynomial]
    points: Floats
    normals: Floats
    is_concave: bool
    walls: tuple[Polynomial, ...]

    @classmethod
    def of(cls, solid: Solid, names: tuple[str, str]) -> FaceSeam:
        """The seam of two faces by their names; raises `GeometryError` where there is none to be filled."""
        faces = _polynomial(solid, names[0]), _polynomial(solid, names[1])
        mesh = solid.mesh()
        numbers = [mesh.names.index(name) if name in mesh.names else -1 for name in names]
        edges, across = _between(mesh, *numbers)
        if not len(edges):
            raise GeometryError(f"the faces {names[0]!r} and {names[1]!r} of the solid do not meet in an edge")
        points = mesh.points[np.unique(edges)]
        gradients = np.stack([face.gradient(points) for face in faces])
        normals = gradients / np.linalg.norm(gradients, axis=2, keepdims=True)
        cosines = (normals[0] * normals[1]).sum(axis=1)
        flat = 1e-2  # sine of an angle between faces below which they are taken for tangent
        if (1 - cosines**2).min() < flat**2:
            x, y, z = points[int(np.argmax(cosines**2))]
            raise GeometryError(
                f"the faces {names[0]!r} and {names[1]!r} touch, or nearly so, near ({x:.4g}, {y:.4g}, {z:.4g}): "
                f"a fillet is for faces that meet with an angle"
            )
        above = faces[0](mesh.points[across]) > 0
        if above.any() != above.all():
            raise GeometryError(
                f"the faces {names[0]!r} and {names[1]!r} meet in edges that go out and such that go in; "
                f"give the fillet of each its own solid, before they are united"
            )
        return cls(faces, points, normals, bool(above.all()), tuple(_walls(solid, mesh, edges, numbers)))

    def heights(self, radius: float) -> tuple[fmpq, fmpq]:
        """How high over each face, by its polynomial, a ball of a radius touches the other, in the mean."""
        sign = 1 if self.is_concave else -1
        reach = radius * (1 - (self.normals[0] * self.normals[1]).sum(axis=1))[:, None]
        a, b = (
            short(sign * float(face(self.points + sign * reach * normal).mean()))
            for face, normal in zip(self.faces, self.normals, strict=True)
        )
        return a, b

    def box(self, radius: float) -> list[Polynomial]:
        """Polynomials that are positive in a box which holds a fillet of a radius."""
        cosines = (self.normals[0] * self.normals[1]).sum(axis=1)
        margin = radius * (1 + 2 * float(np.sqrt((1 - cosines) / (1 + cosines)).max()))
        low, high = self.points.min(axis=0) - margin, self.points.max(axis=0) + margin
        found = []
        for axis, g in enumerate(GENERATORS):
            found += [Polynomial.from_raw(g - short(low[axis])), Polynomial.from_raw(short(high[axis]) - g)]
        return found


def filled(
    solid: Solid, names: tuple[str, str], radius: fmpq, order: int, within: Sequence[PolynomialLike], face: str | None
) -> Solid:
    """The solid with its edge between two faces rounded, or of order 0 cut off flatly; see `Solid.fillet`.

    Raises `GeometryError` where a joint is not proved, with the largest radius of which they are.
    """
    check_order(order)
    walls = [Polynomial(wall) for wall in within]
    seam, face = FaceSeam.of(solid, names), face or _free(solid, "fillet" if order else "chamfer")
    made = _made(solid, seam, names, radius, order, walls, face)
    wrong = _unproved(made, face)
    if wrong is None:
        return made
    largest = _largest(lambda r: _unproved(_made(solid, seam, names, r, order, walls, face), face) is None, radius)
    raise GeometryError(
        f"a fillet of radius {plain(radius)} between {names[0]!r} and {names[1]!r} is not proved: {wrong}; "
        + ("no smaller one is either" if largest is None else f"one of radius {largest:.3g} is")
    )


def largest(solid: Solid, names: tuple[str, str], order: int, within: Sequence[PolynomialLike]) -> float:
    """The largest radius, nearly, of a fillet whose joints are proved; see `Solid.largest_fillet`."""
    check_order(order)
    walls = [Polynomial(wall) for wall in within]
    seam, face = FaceSeam.of(solid, names), _free(solid, "fillet")
    size = short(float(np.ptp(solid.box, axis=0).max()))
    found = _largest(lambda r: _unproved(_made(solid, seam, names, r, order, walls, face), face) is None, size)
    if found is None:
        raise GeometryError(f"no fillet between {names[0]!r} and {names[1]!r} is proved, however small")
    return found


def _made(
    solid: Solid,
    seam: FaceSeam,
    names: tuple[str, str],
    radius: fmpq,
    order: int,
    within: Sequence[Polynomial],
    face: str,
) -> Solid:
    sign = 1 if seam.is_concave else -1
    (a, b), (f, g) = seam.heights(to_float(radius)), seam.faces
    if a <= 0 or b <= 0:
        return solid
    s, t = f * (sign / a), g * (sign / b)
    h = 1 - s - t
    cosine = float((seam.normals[0] * seam.normals[1]).sum(axis=1).mean())
    surface = s * t * short(2 + 2 * cosine) - h ** (order + 1) if order else -h
    walls = [s, t] + ([h] if order else []) + [*within, *seam.box(to_float(radius))]
    walls += [-wall for wall in seam.walls] if seam.is_concave else []
    piece = combined(False, Atom(surface, face), *(Atom(-wall, "") for wall in walls))
    tree = combined(True, solid.tree, piece) if seam.is_concave else combined(False, solid.tree, complement(piece))
    claims: tuple[Joint, ...] = ()
    if order:
        claims = Joint(face, names[0], (f, g - b * sign), order), Joint(face, names[1], (g, f - a * sign), order)
    return replace(solid, tree=tree, joints=(*solid.joints, *claims), sheets=None)


def _unproved(made: Solid, face: str) -> str | None:
    """Why a joint of a face is not proved; None where all are."""
    checkpoint("proving a fillet")
    if face not in made.faces:
        return "the face next to it is curved the other way there"
    mine = [replace(made, joints=(joint,)) for joint in made.joints if joint.first == face]
    wrong = next((verdict for one in mine for verdict in one.verdicts if not verdict.proved), None)
    return None if wrong is None else f"{wrong.claim}: {wrong.reason}"


def _largest(holds: Callable[[fmpq], bool], above: fmpq) -> float | None:
    """The largest radius below one of which a condition holds, to a thirtieth; None where none is found."""
    low, high = above / 2, above
    halvings = 10
    for _ in range(halvings):
        if holds(low):
            break
        low, high = low / 2, low
    else:
        return None
    while high - low > low / 30:
        middle = short(to_float(low + high) / 2)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return to_float(low)


def _free(solid: Solid, name: str) -> str:
    """The name, or with the first number behind it with which the solid has no face."""
    found, number = name, 1
    while found in solid.faces:
        number += 1
        found = f"{name} {number}"
    return found


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


def _between(mesh: Mesh, first: int, second: int) -> tuple[Integers, Integers]:
    """The edges (E, 2) between two faces of a mesh, by number, and the third corners (E,) of the second's triangles."""
    corners = mesh.triangles[mesh.faces == first], mesh.triangles[mesh.faces == second]
    sides = [np.concatenate([np.roll(c, -i, axis=1) for i in range(3)]) for c in corners]
    n = len(mesh.points)
    keys = sides[0][:, 0] * n + sides[0][:, 1], sides[1][:, 1] * n + sides[1][:, 0]
    _, mine, others = np.intersect1d(*keys, return_indices=True)
    return sides[0][mine, :2], sides[1][others, 2]


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
