"""Booleans of closed meshes, by manifold3d, and programs of several in turn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pas.arrays import Floats, Integers
from pas.errors import GeometryError, library


class Triangles(NamedTuple):
    """Points (N, 3), triangles (T, 3) and the numbers (T,) of their faces."""

    points: Floats
    triangles: Integers
    faces: Integers


Value = TypeVar("Value")


@dataclass(frozen=True)
class BooleanStep:
    """Once so many operands were `read`, an `operation` of the last `many` of them and of earlier results, which makes
    one result of these: the union ("Add"), the intersection ("Intersect"), or the first less the others ("Subtract").
    """

    read: int
    operation: str
    many: int


def carried_out(
    steps: Sequence[BooleanStep], operands: Sequence[Value], do: Callable[[str, list[Value]], Value]
) -> Value:
    """The result of the last of some steps, which are in postfix order, where `do` carries out one."""
    results, first = list[Value](), 0
    for step in steps:
        results += operands[first : step.read]
        first = step.read
        results[-step.many :] = [do(step.operation, results[-step.many :])]
    return results[0]


def boolean(meshes: Sequence[Triangles], steps: Sequence[BooleanStep]) -> Triangles:
    """The triangles that bound the result of the steps on what meshes enclose.

    Raises `GeometryError` where one is refused or the result is empty, `MissingLibraryError` without manifold3d.
    """
    manifold3d = library("manifold3d", "booleans of meshes need manifold3d: pip install manifold3d")

    def do(operation: str, solids: list[Any]) -> Any:
        return manifold3d.Manifold.batch_boolean(solids, getattr(manifold3d.OpType, operation))

    result = carried_out(steps, [_manifold(manifold3d, mesh) for mesh in meshes], do)
    _check_status(result, "the result")
    if result.is_empty():
        raise GeometryError("the boolean of the meshes is empty")
    mesh = result.to_mesh64()
    return Triangles(
        np.asarray(mesh.vert_properties)[:, :3],
        np.asarray(mesh.tri_verts).astype(np.intp),
        np.asarray(mesh.face_id).astype(np.intp),
    )


def _manifold(manifold3d: Any, mesh: Triangles) -> Any:
    made = manifold3d.Mesh64(  # which takes no arrays that cannot be written to, as are those that it gives
        vert_properties=np.array(mesh.points, dtype=np.float64, order="C"),
        tri_verts=mesh.triangles.astype(np.uint64),
        face_id=mesh.faces.astype(np.uint64),
    )
    solid = manifold3d.Manifold(made)
    _check_status(solid, "a mesh")
    return solid


def _check_status(solid: Any, name: str) -> None:
    status = solid.status()
    if status.name != "NoError":
        raise GeometryError(f"{name} was refused as no closed manifold ({status.name}); mend it before a boolean")
