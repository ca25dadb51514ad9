"""The surface of a project file, read anew: cells, patches, contacts, and the faces of the cells."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from itertools import combinations, product
from typing import Any, NamedTuple

from flint import fmpq, fmpq_mpoly

from pas.algebra.inputs import check_order, check_surface_degree, shown
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational
from pas.exchange.schema import SURFACE, read_polynomial
from pas.independent.signs import RING, Point, on_simplex


class Face(NamedTuple):
    """A triangle as a face of a cell: its corners, the cell's fourth one, and the numbers of the cell and its patch."""

    corners: tuple[Point, ...]
    off: Point
    cell: int
    patch: int

    def series(self, p: fmpq_mpoly, order: int) -> list[fmpq_mpoly]:
        """p = p_0 + p_1 t + ..., t the barycentric coordinate across the face: the coefficients up to t^order."""
        terms: list[dict[tuple[int, ...], Any]] = [{} for _ in range(order + 1)]
        for (i, j, k, power), value in on_simplex(p, (*self.corners, self.off)).to_dict().items():
            if power <= order:
                terms[power][i, j, k, 0] = value
        return [RING.from_dict(t) for t in terms]


class Surface:
    """What a project file says; `ValueError` or `TypeError` for what makes no sense.  Patches are of one degree."""

    def __init__(self, record: Any) -> None:
        SURFACE.check(record, "content.surface")
        self.order = check_order(record["order"])
        given = [(read_polynomial(c["surface"]), read_polynomial(c["clip"])) for c in record["contacts"]]
        if any(f.degree < 1 or h.degree < 1 or not f.raw.gcd(h.raw).is_constant() for f, h in given):
            raise ValueError("a clip must cut its surface in a curve")
        self.contacts = [(_homogeneous(f, f.degree), _homogeneous(h, h.degree)) for f, h in given]
        patches = [read_polynomial(terms) for terms in record["patches"]]
        degree = check_surface_degree(max((p.degree for p in patches), default=0))
        self.patches = [_homogeneous(p, degree) for p in patches]
        self.centre, points, cells, pieces = _partition(record["partition"])
        if len(pieces) != len(patches) or sorted(c for p in pieces for c in p) != list(range(len(cells))):
            raise ValueError("each cell must have one patch")
        known = dict(enumerate(points))
        self.cells = [tuple(sorted({known[i] for i in cell if i in known})) for cell in cells]
        if any(len(cell) != 4 for cell in self.cells):
            raise ValueError("each cell must have four corners")
        self.patch_of = {cell: number for number, piece in enumerate(pieces) for cell in piece}
        faces: dict[tuple[Point, ...], list[Face]] = defaultdict(list)
        for number in sorted(self.patch_of, key=self.patch_of.__getitem__):
            for off in self.cells[number]:
                triangle = tuple(p for p in self.cells[number] if p != off)
                faces[triangle].append(Face(triangle, off, number, self.patch_of[number]))
        self.faces = list(faces.values())
        self.inner = [two for sides in self.faces for two in combinations(sides, 2)]
        bound = [sides[0] for sides in self.faces if len(sides) == 1]
        self.open = record["partition"]["kind"] == "open region"  # whose cells fill a cone with the centre as its apex
        self.sides = [face for face in bound if self.open and self.centre in face.corners]
        self.outer = [face for face in bound if face not in self.sides]
        self.clipped = [
            [f for f in self.outer if h.total_degree() == 1 and all(h(*p) == 0 for p in f.corners)]
            for _, h in self.contacts
        ]
        """For each contact the outer faces in its clip plane; none where the clip is no plane."""


def _homogeneous(p: Polynomial, degree: int) -> fmpq_mpoly:
    return RING.from_dict({(*e, degree - sum(e)): c for e, c in p.raw.to_dict().items()})


def _point(coordinates: Iterable[Any]) -> Point:
    return (*(rational(c, "coordinate") for c in coordinates), fmpq(1))


def _partition(record: dict[str, Any]) -> tuple[Point | None, list[Point], list[Any], list[Any]]:
    """Centre, points, cells (four point numbers each), and the cells of each patch."""
    # the corners Z1, Z2, V1, ..., V6 of the six tetrahedra Z1 Z2 V_(i-1) V_i, as sums of the three legs
    corners_of_six = ((1, 1, 1), (-1, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 1, 0), (-1, 0, 1), (0, -1, 1), (1, -1, 0))
    centre = None if record["center"] is None else _point(record["center"])
    match record:
        case {"kind": "tetrahedra" | "region" | "open region", "vertices": vertices, "cells": cells, "pieces": pieces}:
            return centre, [_point(p) for p in vertices], cells, pieces
        case {"kind": "six tetrahedra", "legs": legs} if centre:
            axes = list(zip(centre, *map(_point, legs), strict=True))[:3]
            points = [_point(o + u * a + v * b + w * c for o, a, b, c in axes) for u, v, w in corners_of_six]
            return centre, points, [(0, 1, 2 + (i - 1) % 6, 2 + i) for i in range(6)], [(i,) for i in range(6)]
        case {"kind": "single cell", "lower": lower, "upper": upper} if centre:
            box = [_point(p) for p in product(*zip(lower, upper, strict=True))]
            sides = [[v for v in range(8) if (v >> axis) % 2 == end] for axis in range(3) for end in (0, 1)]
            cells = [(8, *side[i : i + 3]) for side in sides for i in (0, 1)]
            return centre, [*box, centre], cells, [tuple(range(12))]
        case {"kind": "single cell"} if not {"lower", "upper"} & record.keys():
            return centre, [], [], [()]
    entries = ", ".join(map(str, record))
    raise ValueError(f"there is no partition {shown(record['kind'])} with {entries} and such a centre")
