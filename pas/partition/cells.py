"""Partitions of a region into tetrahedra, exact.

With a centre, every interior face lies in a plane through it and every cell touches it, so a ray from the centre stays
in one cell until it leaves the region.  That is what lets a surface be proved to be met once by each ray (see
`pas.certify.proofs`).  A mesh without a centre serves for everything but that proof.

Regions are partitions that the program laid out around contacts, closed and open ones.  `PARTITIONS` are those that
files know, by name.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import accumulate, chain, pairwise
from typing import Any, Self

import numpy as np
from flint import fmpq

from pas.algebra.affine import Affine, Frame
from pas.algebra.inputs import shown
from pas.algebra.rational import (
    Vector,
    VectorLike,
    binary_exponent,
    determinant,
    listed,
    minus,
    texts,
    three,
    to_float,
    to_floats,
    vector,
)
from pas.errors import GeometryError
from pas.partition.complex import CellComplex, Location, OuterFace
from pas.partition.layout import Layout, Ray, Triangle, primitive, times_covered
from pas.registry import Registry, Serialisable, read_record

DIRECTION = re.compile(r"\(-?\d+, -?\d+, -?\d+\)")
"""A direction in the title of a layout, as that of the axis of a fan."""


class Partition(CellComplex, Serialisable):
    """A region cut into tetrahedra.

    `vertices` are exact points (three numbers each), `cells` quadruples of vertex indices,
    `center` an exact point in the interior of the region from which every cell is seen
    undivided, or None for a mesh that has none.  `pieces` groups cells (tuples of their numbers)
    that share one polynomial; by default each cell is a piece of its own.  `title` says in summaries what it is.

    Raises `GeometryError` for a flat cell, cells that overlap at a common face, or cells that do not
    surround the centre exactly once (so that none overlap; without a centre that is not looked into);
    `ValueError` for indices that do not exist or pieces that do not hold each cell once.
    """

    name = "tetrahedra"

    def __repr__(self) -> str:
        called = f" {self.title!r}" if self.title != self.name else ""
        return f"<{type(self).__name__}{called}: {len(self.cells)} cells in {len(self.pieces)} pieces>"

    def __init__(
        self,
        vertices: Sequence[VectorLike],
        cells: Sequence[Sequence[int]],
        center: VectorLike | None = None,
        pieces: Sequence[Sequence[int]] | None = None,
        title: str = "",
    ) -> None:
        self.title = title or self.name
        self.vertices = tuple(vector(v, f"vertices[{i}]") for i, v in enumerate(vertices))
        self.cells = tuple(tuple(cell) for cell in cells)
        self.center = None if center is None else vector(center, "center")
        self.pieces = tuple((i,) for i in range(len(self.cells))) if pieces is None else tuple(map(tuple, pieces))
        self._check_indices()
        self._check()

    def _check_indices(self) -> None:
        for i, cell in enumerate(self.cells):
            if len(set(cell)) != 4 or not all(0 <= v < len(self.vertices) for v in cell):
                raise ValueError(f"cells[{i}] must be four different vertex numbers below {len(self.vertices)}")
        if sorted(c for piece in self.pieces for c in piece) != list(range(len(self.cells))):
            raise ValueError(f"pieces must hold each of the {len(self.cells)} cells once")

    def _check(self) -> None:
        """Raise `GeometryError` unless the cells are a region around the centre."""
        self.check_cells()
        if self.center is not None and self.cells:
            check_around_center(self, self.center)
        elif self.open:
            raise GeometryError("a partition that is open must have a centre, the corner of its cells")

    def to_record(self) -> dict[str, Any]:
        """The partition as a table of plain data, exact numbers as texts; its kind is its `name`."""
        return {
            "kind": Partition.name,
            "center": None if self.center is None else texts(self.center),
            "vertices": [texts(v) for v in self.vertices],
            "cells": [list(cell) for cell in self.cells],
            "pieces": [list(piece) for piece in self.pieces],
        } | ({} if self.title == self.name else {"title": self.title})

    def moved(self, map_: Affine) -> Partition:
        """The image under an affine map, exact; cells and pieces keep their numbers."""
        center = None if self.center is None else map_.exact(self.center)
        return Partition([map_.exact(v) for v in self.vertices], self.cells, center, self.pieces)

    @cached_property
    def frame(self) -> Frame:
        """The local frame of this region."""
        if not self.vertices:
            return Frame((fmpq(0), fmpq(0), fmpq(0)), fmpq(1))
        return Frame.around(self.center or _middle(self.vertices), self.vertices)

    @cached_property
    def local(self) -> Partition:
        """This partition in its local coordinates (centre, if any, 0; size about 1)."""
        return self.in_frame(self.frame)

    def in_frame(self, frame: Frame) -> Partition:
        """This partition in the local coordinates of a frame, as open as it is."""
        image = object.__new__(Partition)  # what was looked at in the constructor holds in it as well
        image.vertices = tuple(frame.local_point(v) for v in self.vertices)
        image.center = None if self.center is None else frame.local_point(self.center)
        image.title, image.cells, image.pieces, image.open = self.title, self.cells, self.pieces, self.open
        image.owners = self.owners  # which do not depend on coordinates
        return image

    @cached_property
    def layout(self) -> Layout | None:
        """The directions in which the pieces lie; None without a centre or where a piece is no disc seen from it."""
        return outline(self, self.title)

    @cached_property
    def location(self) -> Location:
        """The search for the pieces of many points; for a partition in local coordinates."""
        return Location(self)

    def place(self, point: Vector, name: str = "the point") -> tuple[int, Vector]:
        """The piece that holds a point, and the point's local coordinates.

        Raises `ValueError`, with the point's `name`, outside the region (all of space where there are no cells).
        """
        local = self.frame.local_point(point)
        if not self.cells:
            return 0, local
        cell = int(self.local.locate(np.array([to_floats(local)]))[0])
        if cell < 0:
            raise ValueError(
                f"{name} lies outside the region of the partition; a point at ({listed(point)}) "
                "has no influence on the surface"
            )
        return int(self.piece_of[cell]), local


def _middle(points: Sequence[Vector]) -> Vector:
    """The middle of the bounding box, rounded to few binary digits: any origin nearby will do."""
    ends = [(min(column), max(column)) for column in zip(*points, strict=True)]
    step = fmpq(2) ** (binary_exponent(max(high - low for low, high in ends)) - 4)
    return three(fmpq(round(to_float((low + high) / (2 * step)))) * step for low, high in ends)


class Region(Partition):
    """A partition built around the curves of contacts, as `pas.layouts` does: its extent follows from the contacts.

    What counts as fair in it is judged by the arcs that fit between the contacts (`pas.FairnessLimits.of_node`),
    since no cell was given by the user.  Arguments and errors are those of `Partition`.
    """

    name = "region"

    @classmethod
    def of_triangles(cls, pieces: Sequence[Sequence[tuple[Vector, ...]]], center: Vector, title: str) -> Self:
        """The cells from the centre over triangles, whose corners are given relative to it, piece by piece."""
        numbers: dict[Vector, int] = {}
        cells = [
            [(0, *(numbers.setdefault(corner, 1 + len(numbers)) for corner in triangle)) for triangle in piece]
            for piece in pieces
        ]
        ends = [0, *accumulate(map(len, cells))]
        vertices = [center, *(tuple(a + b for a, b in zip(center, corner, strict=True)) for corner in numbers)]
        return cls(vertices, list(chain(*cells)), center, [range(a, b) for a, b in pairwise(ends)], title)

    def moved(self, map_: Affine) -> Region:
        """See `Partition.moved`; a direction in the title goes along."""
        center = None if self.center is None else map_.exact(self.center)
        title = DIRECTION.sub(lambda found: _moved(found[0], map_), self.title)
        return type(self)([map_.exact(v) for v in self.vertices], self.cells, center, self.pieces, title)

    def to_record(self) -> dict[str, Any]:
        return super().to_record() | {"kind": self.name}


class OpenRegion(Region):
    """Cells that fill a convex cone up to its outer faces, its apex the centre, as `pas.layouts.opened` makes them.

    One contact has no face of it: its clip is a cone of degree 2 with the same apex, inside this one, as that through
    the edge of a plate.  Arguments are those of `Partition`; raises `GeometryError` without a centre, and where cells
    fill no convex cone around it.
    """

    name = "open region"
    open = True


def _moved(words: str, map_: Affine) -> str:
    """A direction in words, moved."""
    return str(primitive(map_.direction(vector(words.strip("()").split(", ")))))


PARTITIONS: Registry[type[Partition]] = Registry(
    "partition",
    {
        "six tetrahedra": "pas.partition.boxes:SixTetrahedra",
        "single cell": "pas.partition.boxes:SingleCell",
        "tetrahedra": Partition,
        "region": Region,
        "open region": OpenRegion,
        "alfeld split": "pas.partition.boxes:AlfeldSplit",
        "worsey-farin split": "pas.partition.boxes:WorseyFarinSplit",
        "kuhn cube": "pas.partition.boxes:KuhnCube",
    },
)
"""The first is that of a table that does not say its kind."""


def register_partition(partition: type[Partition]) -> type[Partition]:
    """Make a class of partitions known to project files and problem files, by its `name`; returns it.

    Unless the class says otherwise (`to_record`, `keys`, `from_record`) it is written as its tetrahedra.
    Raises `ValueError` for a name that is taken, `TypeError` for what is no class of partitions.
    """
    if not isinstance(partition, type) or not issubclass(partition, Partition):
        raise TypeError(f"partition must be a subclass of pas.Partition, not {shown(partition)}")
    return PARTITIONS.register(partition)


def read_partition(record: Mapping[str, Any]) -> Partition:
    """The partition that a table describes.

    Raises `ValueError`, `TypeError` or `GeometryError`; sentences begin with the key at fault where there is one.
    """
    return read_record(PARTITIONS, record, next(iter(PARTITIONS)))


def check_around_center(cells: CellComplex, center: Vector) -> None:
    """That every cell touches the centre and that no two lie in the same direction.

    They surround the centre, or fill a convex cone with the centre as its apex: each side of it has all vertices on one
    side, so the directions of the sides bound that cone, and the number of cells in a direction is the same everywhere
    in it.
    """
    triangles = [triangle for triangle, _, _ in cells.inner_triangles]
    if any(determinant(*(minus(p, center) for p in cells.corners(triangle))) != 0 for triangle in triangles):
        raise GeometryError("an interior face of the partition does not pass through its centre")
    if any(face.plane.at(center) >= 0 for face in cells.outer_faces):
        raise GeometryError("the centre of the partition is not inside the region")
    if cells.open and not cells.sides:
        raise GeometryError("the centre of a partition that is open must be a corner of the region")
    if any(side.plane.at(v) > 0 for side in cells.sides for v in cells.vertices):
        raise GeometryError("the cells of a partition that is open must fill a convex cone around its centre")
    rays = _rays(cells, center)
    # every face through the centre has a cell on either side, so all rays from there go through as many outer faces
    if times_covered([tuple(rays[v] for v in _turned(face, rays)) for face in cells.outer_faces]) != 1:
        raise GeometryError("the cells of the partition do not surround its centre exactly once")


def outline(cells: CellComplex, title: str) -> Layout | None:
    """The layout of cells; None without a centre, and where the outer faces of a piece are no disc."""
    if cells.center is None or len(cells.pieces) < 2:
        return None
    rays = _rays(cells, cells.center)
    numbers: dict[Ray, int] = {}
    pieces = []
    for piece in range(len(cells.pieces)):
        boundary = _boundary([_turned(face, rays) for face in cells.outer_faces if face.piece == piece])
        if boundary is None:
            return None
        pieces.append([numbers.setdefault(rays[v], len(numbers)) for v in boundary])
    try:
        return Layout(list(numbers), pieces, cells.center, title)
    except GeometryError:  # of a piece that is star-shaped from no ray: the cells serve
        return None


def _rays(cells: CellComplex, center: Vector) -> dict[int, Ray]:
    """The directions in which the centre sees the vertices of outer faces."""
    seen = {v for face in cells.outer_faces for v in face.vertices}
    return {v: primitive(minus(cells.vertices[v], center)) for v in seen}


def _turned(face: OuterFace, rays: dict[int, Ray]) -> Triangle:
    """A face's vertices, counterclockwise seen from outside."""
    a, b, c = face.vertices
    return (a, b, c) if determinant(rays[a], rays[b], rays[c]) > 0 else (a, c, b)


def _boundary(faces: Sequence[Triangle]) -> list[int] | None:
    """The vertices round a union of faces; None where that is not one closed line."""
    edges = {edge for a, b, c in faces for edge in ((a, b), (b, c), (c, a))}
    after: dict[int, int] = {}
    for edge in edges:
        if edge[::-1] not in edges:
            if edge[0] in after:
                return None
            after[edge[0]] = edge[1]
    if not after:
        return None
    start = min(after)
    found = [start]
    while after[found[-1]] != start:
        found.append(after[found[-1]])
    return found if len(found) == len(after) else None
