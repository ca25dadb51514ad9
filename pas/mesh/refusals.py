"""What meshers return: a mesh with its distance from the surface, or why there is none, which is raised."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.errors import MeshError
from pas.mesh.field import FaceField
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.projection import pair_normals


@dataclass(frozen=True)
class FaceMesh:
    """A mesh whose triangles carry labels, and its `deviation`: the largest measured distance from the surface."""

    mesh: Labelled
    deviation: float

    def named(self, field: FaceField) -> Mesh:
        """The mesh in the user's coordinates, with the names of the field's faces; equal names are one face.

        Each connected piece of a label is named by itself, so that faces that are apart keep their names.
        """
        mesh = self.mesh
        corners = mesh.points[mesh.triangles]
        low, high = corners.min(axis=1) - self.deviation, corners.max(axis=1) + self.deviation
        centers, halves = (low + high) / 2, (high - low) / 2
        pieces = mesh.topology.pieces
        labels = [int(mesh.labels[rows[0]]) for rows in pieces]
        titles = [
            field.face_within(label, centers[rows], halves[rows]) for label, rows in zip(labels, pieces, strict=True)
        ]
        names = tuple(dict.fromkeys(title for _, title in sorted(zip(labels, titles, strict=True))))
        numbers = np.empty(len(mesh.triangles), dtype=np.intp)
        for rows, title in zip(pieces, titles, strict=True):
            numbers[rows] = names.index(title)
        return Mesh(
            field.world(mesh.points),
            mesh.triangles,
            numbers,
            names,
            pair_normals(mesh, field)[mesh.topology.corner_pairs],
            deviation=self.deviation * field.scale,
        )


@dataclass(frozen=True)
class Refusal:
    """Why a mesh was not made, in a sentence."""

    sentence: str

    @property
    def error(self) -> MeshError:
        """The error to raise."""
        return MeshError(self.sentence)


Made = FaceMesh | Refusal


def too_many(scale: float, triangles: int, most: int, tolerance: float, reached: float) -> Refusal:
    """That a tolerance, in units of so much of the user's, needs more than `most` triangles, and what is reached with
    some: with those of the coarsest mesh if these are more."""
    near = f"{reached * scale:.2g} is reached"
    some = f"{near} with {triangles}"
    if triangles > most:
        some = f"even the coarsest mesh has {triangles}, and {near} by it"
    return Refusal(f"the tolerance {tolerance * scale:.3g} needs more than {most} triangles; {some}")


def not_reached(field: FaceField, triangles: int, tolerance: float, reached: float, why: str) -> Refusal:
    """That a tolerance was not reached, and why."""
    return Refusal(
        f"the tolerance {tolerance * field.scale:g} was not reached with {triangles} triangles "
        f"({reached * field.scale:.2g} was): {why}"
    )
