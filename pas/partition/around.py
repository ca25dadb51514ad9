"""That the cells of a partition surround its centre once, or fill a cone around it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flint import fmpq

from pas.algebra.rational import Vector, cross, dot, minus
from pas.errors import GeometryError

if TYPE_CHECKING:
    from pas.partition.cells import Partition


def check_around_center(partition: Partition, center: Vector) -> None:
    """That every cell touches the centre and that no two lie in the same direction.

    They surround the centre, or fill a convex cone with the centre as its apex: each side of it has all vertices on one
    side, so the directions of the sides bound that cone, and the number of cells in a direction is the same everywhere
    in it.
    """
    triangles = [triangle for triangle, _, _ in partition.inner_triangles]
    if any(not _through(partition.corners(triangle), center) for triangle in triangles):
        raise GeometryError("an interior face of the partition does not pass through its centre")
    if any(face.plane.at(center) >= 0 for face in partition.outer_faces):
        raise GeometryError("the centre of the partition is not inside the region")
    if partition.open and not partition.sides:
        raise GeometryError("the centre of a partition that is open must be a corner of the region")
    if any(side.plane.at(v) > 0 for side in partition.sides for v in partition.vertices):
        raise GeometryError("the cells of a partition that is open must fill a convex cone around its centre")
    if _times_seen(partition, center) != 1:
        raise GeometryError("the cells of the partition do not surround its centre exactly once")


def _through(corners: Sequence[Vector], center: Vector) -> bool:
    a, b, c = (minus(p, center) for p in corners)
    return dot(a, cross(b, c)) == 0


def _times_seen(partition: Partition, center: Vector) -> int:
    """How many outer faces a ray from the centre goes through, exact.

    Every face through the centre has a cell on either side, so the number is the same for all
    rays that avoid the edges: one is counted.  Of the directions a + t b + t^2 c from the centre
    to a face no more than two lie in the plane of an edge, so one that avoids them is found.
    """
    faces = [tuple(minus(p, center) for p in partition.corners(face.vertices)) for face in partition.outer_faces]
    tried = range(2, 3 + 6 * len(faces))
    directions = (tuple(a + t * b + t * t * c for a, b, c in zip(*faces[0], strict=True)) for t in tried)
    depths = next(filter(all, ([_least_weight(way, face) for face in faces] for way in directions)))
    return sum(depth > 0 for depth in depths)


def _least_weight(direction: Sequence[fmpq], triangle: Sequence[Vector]) -> fmpq:
    """The least of three weights, up to positive factors, with which the corners give a direction.

    Positive where a ray from the origin goes through the triangle, zero where it meets its rim.
    """
    a, b, c = triangle
    towards = dot(a, cross(b, c))
    weights = (dot(direction, cross(b, c)), dot(a, cross(direction, c)), dot(a, cross(b, direction)))
    return min(w * towards for w in weights)
