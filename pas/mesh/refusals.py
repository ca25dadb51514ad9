"""The results of meshers: a mesh with its distance from the surface, or the reason for none, which is raised."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from pas.errors import MeshError
from pas.mesh.field import FaceField
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh, joined_names
from pas.mesh.projection import pair_normals

Made = TypeVar("Made")


@dataclass(frozen=True)
class FaceMesh:
    """A mesh whose triangles carry labels, and its `deviation`: the largest measured distance from the surface."""

    mesh: Labelled
    deviation: float

    def named(self, field: FaceField) -> Mesh:
        """The mesh in the user's coordinates, on the field's faces; those of equal names are one.

        Each connected piece of a label is named by itself, so that faces that are apart keep their names.
        """
        mesh = self.mesh
        corners = mesh.points[mesh.triangles]
        low, high = corners.min(axis=1) - self.deviation, corners.max(axis=1) + self.deviation
        centers, halves = (low + high) / 2, (high - low) / 2
        pieces = mesh.topology.pieces
        labels = [int(mesh.labels[rows[0]]) for rows in pieces]
        owners = [field.faces_within(k, centers[rows], halves[rows]) for k, rows in zip(labels, pieces, strict=True)]
        faces = tuple(dict.fromkeys(names for _, names in sorted(zip(labels, owners, strict=True))))
        numbers = np.empty(len(mesh.triangles), dtype=np.intp)
        for rows, names in zip(pieces, owners, strict=True):
            numbers[rows] = faces.index(names)
        return Mesh(
            field.world(mesh.points),
            mesh.triangles,
            numbers,
            tuple(map(joined_names, faces)),
            pair_normals(mesh, field)[mesh.topology.corner_pairs],
            deviation=self.deviation * field.scale,
            solid_faces=faces,
        )


class RefusalError(MeshError):
    """The reason why one of several ways made no mesh; the last one's is what the user is told."""


def attempted(make: Callable[[], Made]) -> Made | RefusalError:
    """The result of one way of several, or the reason why it has none."""
    try:
        return make()
    except RefusalError as refusal:
        return refusal.with_traceback(None)  # in which all that was tried is kept


def too_many(scale: float, triangles: int, most: int, tolerance: float, reached: float) -> RefusalError:
    """The refusal of a tolerance, in units of `scale` of the user's, that needs more than `most` triangles, with what
    fewer reach; or the coarsest mesh, if it has more."""
    near = f"{reached * scale:.2g} is reached"
    some = f"{near} with {triangles}"
    if triangles > most:
        some = f"even the coarsest mesh has {triangles}, and {near} by it"
    return RefusalError(f"the tolerance {tolerance * scale:.3g} needs more than {most} triangles; {some}")


def not_reached(field: FaceField, triangles: int, tolerance: float, reached: float, why: str) -> RefusalError:
    """The refusal of a tolerance that was not reached, with the reason."""
    return RefusalError(
        f"the tolerance {tolerance * field.scale:g} was not reached with {triangles} triangles "
        f"({reached * field.scale:.2g} was): {why}"
    )
