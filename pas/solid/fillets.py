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
from typing import Protocol

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_order, shown_point
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import Vector, dot, plain, rational, square_root, to_float
from pas.errors import GeometryError, MeshError
from pas.limits import checkpoint
from pas.registry import Registry, loaded
from pas.solid.face_seams import FaceSeam
from pas.solid.joints import Joint
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree, combined, complement
from pas.verdicts import Verdict

NODE = "pas.pipeline.pipe_nodes:PipeNode"
"""What finds a node that can take the place of where two pipes cross, in a module above."""


class Way(Protocol):
    """What makes fillets of two faces: along their edge, or otherwise."""

    def made(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet of a radius, or why there is none."""

    def largest(self, above: fmpq) -> float | None:
        """The largest radius found of a fillet, below one; None where there is none."""


FilletForm = tuple[Polynomial, tuple[Polynomial, ...], tuple[fmpq, fmpq]]
"""A surface, not positive on the side of the seam, polynomials positive where it counts, and how high over each face it
touches the other."""

FILLET_MAKERS: Registry[Callable[[FaceSeam, fmpq, int], FilletForm | None]] = Registry(
    "maker of fillets", {"torus": "pas.solid.fillet_forms:torus", "polynomial": "pas.solid.fillet_forms:bent"}
)
"""What makes the surface along a seam of a radius and an order: the first that has one there."""


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
        """That of arguments of `Solid.fillet`, which are checked but for faces that touch."""
        check_order(order)
        walls = tuple(Polynomial.named(wall, f"within[{i}]", constant=False) for i, wall in enumerate(within))
        return cls(solid, names, FaceSeam.of(solid, names), order, walls, title_of(solid, order, face))

    def made(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet of a radius, or why there is none."""
        found = self.joined(radius)
        return found if isinstance(found, str) else strays(found) or found

    def joined(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet whose joints are proved, or why there is none; not looked at on a mesh."""
        checkpoint("proving a fillet")
        sign, (f, g), size = self.seam.sign, self.seam.faces, to_float(radius)
        if True in (bent := self.seam.turned_back(size)):
            return f"{self.names[bent.index(True)]!r} is bent more than a ball of this radius that touches it there"
        forms = (maker(self.seam, radius, self.order) for maker in FILLET_MAKERS.values())
        surface, sides, (a, b) = next(form for form in forms if form is not None)
        ends = self.seam.ends((a, b), size) if a > 0 and b > 0 else None
        if ends is None:
            return "one of the faces does not go on so far from the edge"
        s, t = f * (sign / a), g * (sign / b)
        h = 1 - s - t
        ended = self.seam.left if sign > 0 else ()
        walls = [s, t, *([h] if self.order else sides), *self.within, *(-wall for wall in ended)]
        far, trims = sign < 0 or bool(self.seam.entered or self.seam.goes_on), list[Atom]()
        walls += _box(np.concatenate([self.seam.points, ends]), self.seam.runs_out(size) if far else size)
        if sign > 0:
            hidden = radius / 8  # how deep it goes on in what it runs into
            walls += [wall + hidden for wall in self.seam.entered]
            bare = ends[~self.solid.contains(ends - 1e-4 * size * self.seam.outwards(ends))]
            around = [(name, w) for name, some in self.solid.polynomials.items() for w in some if far and w.degree == 1]
            inner = (one for one in around if (one[1](np.concatenate([self.seam.points, ends])) < 0).all())
            over = (one for one in self.seam.beside if (one[1](bare) > 0).any())
            trims = [Atom(wall, name) for name, wall in dict.fromkeys([*over, *inner])]
        piece = combined(False, Atom(surface, self.face), *trims, *(Atom(-wall, "") for wall in walls))
        whole = self.solid.tree
        tree = combined(True, whole, piece) if sign > 0 else combined(False, whole, complement(piece))
        claims = (
            Joint(self.face, self.names[0], (f, g - b * sign), self.order, [-wall for wall in ended]),
            Joint(self.face, self.names[1], (g, f - a * sign), self.order, [-wall for wall in ended]),
        )
        made = replace(self.solid, tree=tree, joints=claims, sheets=None)
        wrong = next((_told(v) + self.seam.goes_on for v in made.verdicts if not v.proved), None)
        return wrong or self._broken(made) or replace(made, joints=(*self.solid.joints, *claims))

    def _broken(self, made: Solid) -> str | None:
        """What joint of the two faces, proved before, is none beside the fillet; None where there is none."""
        own = tuple(joint for joint in self.solid.joints if {joint.first, joint.second} & {*self.names})
        before, after = (replace(one, joints=own, sheets=None).verdicts for one in (self.solid, made))
        lost = (new for old, new in zip(before, after, strict=True) if old.proved and not new.proved)
        return next((f"make it before another fillet, of which then {_told(verdict)}" for verdict in lost), None)

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


def strays(made: Solid) -> str | None:
    """What is wrong where a fillet is away from the edge, too, as the mesh shows; None where all is well.

    Pieces of it there end in walls of its box, or beside a face that the solid has not got there: so they are flat in
    one, and touch the other without any thickness, which no mesh has.
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


def _told(verdict: Verdict) -> str:
    """What is wrong with a joint, and where."""
    where = "" if verdict.witness is None else f" near {shown_point(verdict.witness)}"
    return f"{verdict.claim}: {verdict.reason}{where}"


def ways(
    solid: Solid, names: tuple[str, str], order: int, within: Sequence[PolynomialLike], face: str | None = None
) -> list[Way]:
    """What can make a fillet, first what is tried first: along the edge, and of pipes whose axes meet by a node.

    Raises `GeometryError` for faces that touch otherwise.
    """
    node = loaded(NODE).of(solid, names, order, face) if order and not within else None
    if node is not None and node.is_needed:
        return [node]
    filling = Filling.of(solid, names, order, within, face)
    return [filling] if node is None else [filling, node]


def filled(
    solid: Solid, names: tuple[str, str], radius: fmpq, order: int, within: Sequence[PolynomialLike], face: str | None
) -> Solid:
    """The solid with its edge between two faces rounded, or of order 0 cut off flatly; see `Solid.fillet`.

    Raises `GeometryError` where there is no such fillet, with the largest radius found of one that there is.
    """
    known, reasons = ways(solid, names, order, within, face), []
    for way in known:
        made = way.made(radius)
        if not isinstance(made, str):
            return made
        reasons.append(made)
    found = _largest_of(known, radius)
    raise GeometryError(
        f"a {'fillet' if order else 'chamfer'} of radius {plain(radius)} between {names[0]!r} and {names[1]!r} is not "
        f"proved: {reasons[0]}; " + ("no smaller one is either" if found is None else f"one of radius {found:.3g} is")
    )


def _largest_of(known: Sequence[Way], above: fmpq) -> float | None:
    """The largest radius of the last of several ways that has any: nodes go as far as pipes do."""
    return next((found for way in known[::-1] if (found := way.largest(above)) is not None), None)


def largest(solid: Solid, names: tuple[str, str], order: int, within: Sequence[PolynomialLike]) -> float:
    """The largest radius, nearly, of a fillet that is proved; see `Solid.largest_fillet`."""
    size = short(float(np.ptp(solid.box, axis=0).max()))
    found = _largest_of(ways(solid, names, order, within), size)
    if found is None:
        raise GeometryError(f"no fillet between {names[0]!r} and {names[1]!r} is proved, however small")
    return found


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


def title_of(solid: Solid, order: int, face: str | None) -> str:
    """The name of the face of a fillet: the given one, or the first that the solid has not got."""
    name = "fillet" if order else "chamfer"
    later = (f"{name} {number}" for number in count(2))
    return face or next(found for found in chain([name], later) if found not in solid.faces)


@dataclass(frozen=True, eq=False)
class PlaneFace:
    """A plane face: its name ("" for a wall), its polynomial, and normal . x + offset, which that is."""

    name: str
    polynomial: Polynomial
    normal: Vector
    offset: fmpq

    @classmethod
    def of(cls, part: Tree) -> PlaneFace | None:
        """That of a part of an intersection; None where it is no half space."""
        if not isinstance(part, Atom) or not isinstance(part.function, Polynomial) or part.function.degree != 1:
            return None
        polynomial = -part.function if part.outside else part.function
        terms = polynomial.raw.to_dict()
        x, y, z, offset = (terms.get(key, fmpq(0)) for key in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)))
        return cls(part.face, polynomial, (x, y, z), offset)

    @cached_property
    def length(self) -> fmpq:
        """Of the normal, to six digits where it is not rational."""
        root = square_root(dot(self.normal, self.normal))
        return root if root * root == dot(self.normal, self.normal) else short(to_float(root))

    def cosine(self, other: PlaneFace) -> fmpq:
        """Of the angle between the normals."""
        return fmpq(1) if other is self else dot(self.normal, other.normal) / (self.length * other.length)


def short(value: float) -> fmpq:
    """The decimal number of six digits nearest to a double."""
    return rational(f"{value:.6g}")
