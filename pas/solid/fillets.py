"""Fillets and chamfers between two faces of a solid, and all along the edges in which theirs goes on smoothly.

Which surface each edge gets: `pas.solid.fillet_forms`.

Guaranteed: the joints, which are proved before a fillet is given.  Looked at on its mesh: that it ends nowhere but at
the solid's own faces.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count
from typing import Protocol

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_order, shown_point
from pas.algebra.polynomial import GENERATORS, Polynomial, PolynomialLike
from pas.algebra.rational import decimal, plain, to_float
from pas.arrays import Floats
from pas.errors import GeometryError, MeshError
from pas.limits import checkpoint
from pas.registry import loaded
from pas.solid.face_seams import FaceSeam
from pas.solid.fillet_forms import FilletPiece, radius_of_turned
from pas.solid.joints import Joint, Known, prove
from pas.solid.profile_rounds import filleted
from pas.solid.solid import Solid
from pas.solid.tree import Atom, Tree, combined, complement
from pas.verdicts import Verdict

NODE = "pas.pipeline.pipe_nodes:PipeNode"
"""The class of nodes that can replace the crossing of two pipes, in a module above."""


class FilletMethod(Protocol):
    """A construction of fillets of two faces: along their edge, or otherwise."""

    def made(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet of a radius, or why there is none."""

    def largest(self, above: fmpq) -> float | None:
        """The largest radius found of a fillet, below one; None where there is none."""


@dataclass(frozen=True, eq=False)
class Filling:
    """The arguments of a fillet: a solid, the seams of two of its faces, the order, where, and the new face's name."""

    solid: Solid
    seams: tuple[FaceSeam, ...]
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
        """The filling for arguments of `Solid.fillet`, which are checked but for faces that touch."""
        check_order(order)
        walls = tuple(Polynomial.named(wall, f"within[{i}]", constant=False) for i, wall in enumerate(within))
        tiny = fmpq(1, 2**20) * decimal(float(np.ptp(solid.mesh().points, axis=0).max()))
        seams = FaceSeam.chain(solid, names, lambda seam, end: FilletPiece("", seam, tiny, order).goes_on(end))
        return cls(solid, seams, order, walls, title_of(solid, order, face))

    def made(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet of a radius, or why there is none."""
        found = self.joined(radius)
        return found if isinstance(found, str) else strays(found) or found

    def joined(self, radius: fmpq) -> Solid | str:
        """The solid with a fillet whose joints are proved, or why there is none; not looked at on a mesh."""
        checkpoint("proving a fillet")
        found = self._trees(radius)
        if isinstance(found, str):
            return found
        pieces, trees = found
        ends = [(piece, end) for piece in pieces for end in piece.seam.smooth]
        joined = dict.fromkeys(Joint(self.face, self.face, piece.section(end), 1) for piece, end in ends)
        claims = tuple(dict.fromkeys([*(claim for piece in pieces for claim in piece.claims()), *joined]))
        whole, add = self.solid.tree, self.seams[0].sign > 0
        tree = combined(add, whole, *(tree if add else complement(tree) for tree in trees))
        sheets = None if self.within else filleted(self.solid.sheets, pieces, add)
        made = replace(self.solid, tree=tree, joints=claims, sheets=sheets)
        goes_on = next((seam.goes_on for seam in self.seams if seam.goes_on), "")
        names = {name for seam in self.seams for name in seam.names}
        beside = [joint for joint in self.solid.joints if {joint.first, joint.second} & names]
        verdicts = dict[Joint, Verdict]()
        for joint in (*claims, *beside):
            proof = verdicts[joint] = prove(joint, tree, lambda: made.box)
            if not proof.proved and joint in claims:
                return _fault(proof) + goes_on
            if not proof.proved and prove(joint, whole, lambda: self.solid.box, self.solid.known).proved:
                return f"make it before another fillet, of which then {_fault(proof)}"
        return replace(made, joints=(*self.solid.joints, *claims), known=Known(tree, verdicts))

    def _trees(self, radius: fmpq) -> tuple[list[FilletPiece], list[Tree]] | str:
        """The pieces of a fillet with what is added or taken away, or why there is none, as points of it show."""
        pieces, trees = [FilletPiece(self.face, seam, radius, self.order) for seam in self.seams], list[Tree]()
        for piece in pieces:
            found = self._tree(piece)
            if isinstance(found, str):
                return found
            trees.append(found)
        return pieces, trees

    def _tree(self, piece: FilletPiece) -> Tree | str:
        """The set to be added or taken away along one seam, or why there is no fillet."""
        seam, size = piece.seam, to_float(piece.radius)
        bent = seam.turned_back(size)
        if True in bent:
            return f"{seam.names[bent.index(True)]!r} is bent more than a ball of this radius that touches it there"
        a, b = piece.form.heights
        if a <= 0 or b <= 0:
            return "no ball of this radius that touches both faces rolls along all of the edge"
        ends = seam.ends((a, b), size, piece.form.curves)
        if ends is None:
            return "one of the faces does not go on so far from the edge"
        held = self.solid.contains(ends - 1e-4 * size * seam.outwards(ends))
        for name, curve, some in zip(seam.names, piece.form.curves, np.split(held, 2), strict=True):
            if curve and not some.any():
                return f"{name!r} does not go on so far from the edge"
        far, around = seam.sign < 0 or bool(seam.entered or seam.goes_on), np.concatenate([seam.points, ends])
        walls = [*self.within, *(-wall for wall in piece.ended), *_box(around, seam.runs_out(size) if far else size)]
        if seam.sign < 0:
            return piece.tree(walls)
        hidden = piece.radius / 8  # how deep it goes on in what it runs into
        planes = [(name, w) for name, some in self.solid.polynomials.items() for w in some if far and w.degree == 1]
        inner = (one for one in planes if (one[1](around) < 0).all())
        over = (one for one in seam.beside if (one[1](ends[~held]) > 0).any())
        trims = [Atom(wall, name) for name, wall in dict.fromkeys([*over, *inner])]
        return piece.tree([*walls, *(wall + hidden for wall in seam.entered)], trims)

    def largest(self, above: fmpq) -> float | None:
        """The largest radius found below one, to a thirtieth, of a fillet that there is; None where there is none.

        Where no larger ball fits into a cylinder or another one that is that, or a little less, if there is such a
        fillet.  Joints are proved for each that is tried.  A mesh is looked at of one a little smaller, as what nearly
        uses up a face takes long, and of others only where that one has strays.
        """
        bends = (zip(seam.faces, seam.turned_back(to_float(above)), strict=True) for seam in self.seams)
        sizes = (radius_of_turned(face) for some in bends for face, bent in some if bent)
        most = min((size for size in sizes if size), default=None)
        for size in (most, most * fmpq(59, 60)) if most is not None else ():
            if not isinstance(self.made(size), str):
                return to_float(size)
        bound = _largest(self._trees, most or above)  # without proofs, which take long
        found = None if bound is None else _largest(self.joined, bound)
        if found is not None and isinstance(self.made(found := found * fmpq(59, 60)), str):
            found = _largest(self.made, found)
        return None if found is None else to_float(found)


def _largest(made: Callable[[fmpq], object], most: fmpq) -> fmpq | None:
    """The largest number found up to one, to a sixtieth, for which there is more than a reason; None where none is."""
    if not isinstance(made(most), str):
        return most
    share = fmpq(47, 100)  # at halves of the solid's size fillets may just touch its other faces, which takes long
    low, high, attempts = most * share, most, 10
    while isinstance(made(low), str):
        low, high, attempts = low * share, low, attempts - 1
        if not attempts:
            return None
    while high - low > low / 60:
        middle = decimal(to_float(low + (high - low) * share))
        low, high = (low, middle) if isinstance(made(middle), str) else (middle, high)
    return low


def strays(made: Solid) -> str | None:
    """The fault of a fillet with parts away from the edge, as the mesh shows; None where there are none.

    Such parts end in walls of its box, or beside a face that the solid does not have there: so they are flat in one,
    and touch the other without any thickness, which no mesh has.
    """
    try:
        mesh = made.mesh()
    except MeshError as error:
        return f"it has no mesh: {error}"
    known = {*made.faces}
    for face, names in enumerate(mesh.solid_faces):
        if not known.issuperset(names):
            place = mesh.points[mesh.triangles[mesh.faces == face][0, 0]]
            return (
                f"it would end in a wall near {shown_point(place)}: give as `within` polynomials that are positive "
                f"where it is wanted"
            )
    return None


def _fault(verdict: Verdict) -> str:
    """The fault of a joint, and where it is."""
    where = "" if verdict.witness is None else f" near {shown_point(verdict.witness)}"
    return f"{verdict.claim}: {verdict.reason}{where}"


def fillet_methods(
    solid: Solid, names: tuple[str, str], order: int, within: Sequence[PolynomialLike], face: str | None = None
) -> list[FilletMethod]:
    """The constructions that may make a fillet, in order: along the edge; for pipes whose axes meet by a node.

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
    known, reasons = fillet_methods(solid, names, order, within, face), []
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


def _largest_of(known: Sequence[FilletMethod], above: fmpq) -> float | None:
    """The largest radius of the last of several constructions that has any: nodes go as far as pipes do."""
    return next((found for way in known[::-1] if (found := way.largest(above)) is not None), None)


def largest(solid: Solid, names: tuple[str, str], order: int, within: Sequence[PolynomialLike]) -> float:
    """The largest radius, nearly, of a fillet that is proved; see `Solid.largest_fillet`."""
    size = decimal(float(np.ptp(solid.box, axis=0).max()))
    found = _largest_of(fillet_methods(solid, names, order, within), size)
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
