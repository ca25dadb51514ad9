"""Cells as their centre sees them: that they surround it once, or fill a cone around it, and their layout."""

from __future__ import annotations

from collections.abc import Sequence

from pas.algebra.rational import Vector, determinant, minus
from pas.errors import GeometryError
from pas.partition.complex import CellComplex, OuterFace
from pas.partition.layout import Layout, Ray, Triangle, primitive, times_covered


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
