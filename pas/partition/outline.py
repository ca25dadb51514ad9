"""The layout of a partition with a centre: the directions in which its pieces lie."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pas.algebra.rational import Vector
from pas.errors import GeometryError
from pas.partition.layout import Layout, Ray, primitive, turns

if TYPE_CHECKING:
    from pas.partition.cells import Partition


def outline(partition: Partition) -> Layout | None:
    """The layout of a partition; None without a centre, and where the outer faces of a piece are no disc."""
    center = partition.center
    if center is None or len(partition.pieces) < 2:
        return None
    rays = {v: _ray(partition.vertices[v], center) for face in partition.outer_faces for v in face.vertices}
    numbers: dict[Ray, int] = {}
    pieces = []
    for piece in range(len(partition.pieces)):
        round_it = _boundary([_turned(f.vertices, rays) for f in partition.outer_faces if f.piece == piece])
        if round_it is None:
            return None
        pieces.append([numbers.setdefault(rays[v], len(numbers)) for v in round_it])
    try:
        return Layout(list(numbers), pieces, center, partition.title)
    except GeometryError:  # of a piece that is star-shaped from no ray: the cells serve
        return None


def _ray(point: Vector, center: Vector) -> Ray:
    x, y, z = (a - o for a, o in zip(point, center, strict=True))
    return primitive((x, y, z))


def _turned(face: tuple[int, ...], rays: dict[int, Ray]) -> tuple[int, int, int]:
    """A face's vertices, counterclockwise seen from outside."""
    a, b, c = face
    return (a, b, c) if turns(rays[a], rays[b], rays[c]) > 0 else (a, c, b)


def _boundary(faces: list[tuple[int, int, int]]) -> list[int] | None:
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
