"""The union of two solids with a fillet wherever a face of one crosses a face of the other.

The mesh of the union shows which faces do.  Each two of them get a fillet (`pas.solid.fillets`) in turn, with all in
which their edge goes on smoothly, until the mesh shows none.  Where edges of two pairs else end in one point, their
fillets would meet in a corner, which none can; but pipes whose axes meet there are joined by a node.
"""

from __future__ import annotations

from itertools import count
from typing import Unpack

import numpy as np

from pas.algebra.inputs import check_order, shown_point
from pas.algebra.rational import Exact, positive
from pas.arrays import Integers
from pas.errors import GeometryError
from pas.limits import WorkLimits, limited, part
from pas.mesh.topology import twins_of
from pas.registry import loaded
from pas.solid.assembly import only_solids
from pas.solid.face_seams import edges_between
from pas.solid.fillets import NODE, filled
from pas.solid.solid import Solid


@limited("rounding a union", "a smaller radius")
def smooth_union(a: Solid, b: Solid, radius: Exact, order: int = 1, **limits: Unpack[WorkLimits]) -> Solid:
    """The union of two solids, rounded with GC^`order` wherever a face of one crosses a face of the other.

    Each two such faces get a fillet of a `radius` (the model's units), with its joints proved; see `Solid.fillet`.
    Where both solids have a face of one name, that of `b` gets a number, as a copy's does: "box z+ #2".  Edges of faces
    that lie in one another, such as two tops of one height, stay as they are.  Raises `TypeError` for what is no solid,
    `ValueError` for an order below 1, `GeometryError` where the solids do not meet or one is inside the other, where an
    edge changes its faces in a corner, and where there is no such fillet, with the largest radius of one that there is.

        solid.smooth_union(solid.box((-2, -2, -1), (2, 2, 0)), solid.ball((0, 0, "1/2"), 1), radius="1/4")
    """
    only_solids([a, b], "smooth_union takes two solids and a radius, as in smooth_union(a, b, 1)")
    size = positive(radius, "radius")
    if check_order(order) < 1:
        raise ValueError("order must be at least 1; chamfer cuts edges off flatly")
    b = _told_apart(b, {*a.faces})
    made, sides = a | b, ({*a.faces}, {*b.faces})
    with part(0.3):
        left, corner = _crossing(made, sides)
    if not left:
        seen = {name for names in made.mesh().solid_faces for name in names}
        why = ", as one is inside the other" if any(seen.isdisjoint(side) for side in sides) else ""
        raise GeometryError(f"the solids do not meet in an edge where a face of one crosses a face of the other{why}")
    while left:
        pair = next(iter(left))
        node = loaded(NODE).of(made, pair, order, None) if corner else None
        if corner and (node is None or not node.is_needed):
            raise GeometryError(corner)
        with part(0.4 / len(left)):
            made = filled(made, pair, size, order, (), None)
        left, corner = _crossing(made, sides)
        if pair in left:
            place = shown_point(made.mesh().points[left[pair][0]])
            raise GeometryError(f"the fillet of {pair[0]!r} and {pair[1]!r} leaves a part of their edge near {place}")
    return made


def _told_apart(solid: Solid, taken: set[str]) -> Solid:
    """The solid with numbers after the names of faces that are taken."""
    names: dict[str, str] = {}
    for name in (face for face in solid.faces if face in taken):
        known = taken.union(solid.faces, names.values())
        names[name] = next(copy for number in count(2) if (copy := f"{name} #{number}") not in known)
    return solid._called(names) if names else solid


def _crossing(solid: Solid, sides: tuple[set[str], set[str]]) -> tuple[dict[tuple[str, str], Integers], str]:
    """Each two faces, by name, of two sets that meet in an edge, with the vertices of the solid's mesh on it; those in
    a corner come first, with what is wrong with that where they cannot be rounded together.
    """
    mesh = solid.mesh()
    parts = mesh.solid_faces
    first, second = (np.array([side.issuperset(names) for names in parts]) for side in sides)
    twins = twins_of(mesh.triangles, len(mesh.points))
    here, there = np.repeat(mesh.faces, 3), mesh.faces[twins // 3]
    pairs = np.unique(np.stack([here, there], axis=1)[first[here] & second[there]], axis=0)
    found, of_vertex = dict[tuple[str, str], Integers](), dict[int, tuple[str, str]]()
    joined = {frozenset((joint.first, joint.second)) for joint in solid.joints}
    for one, other in pairs.tolist():
        pair = parts[one][0], parts[other][0]
        found[pair] = np.unique(edges_between(mesh, [one], [other]))
        for vertex in found[pair].tolist():
            if (known := of_vertex.setdefault(vertex, pair)) != pair and {*known} ^ {*pair} not in joined:
                return {known: found[known], **found}, (
                    f"the edge of {known[0]!r} and {known[1]!r} goes on as that of {pair[0]!r} and {pair[1]!r} near "
                    f"{shown_point(mesh.points[vertex])}: fillets do not meet in corners, so that only edges are "
                    f"rounded each of which stays between two faces"
                )
    return found, ""
