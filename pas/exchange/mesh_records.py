"""Meshes in project files: their arrays in base 64, to the last bit.

How near a mesh is to its surface is not kept: nobody could prove or measure it again from the file.
"""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np

from pas.exchange.schema import TEXT, List, Table
from pas.mesh.mesh import Mesh

MESH = Table(
    dict.fromkeys(("points", "triangles", "faces", "normals"), TEXT) | {"names": List(TEXT)},
    {"parameters": TEXT},
)

_ARRAYS = {
    "points": ("<f8", (-1, 3)),
    "triangles": ("<i8", (-1, 3)),
    "faces": ("<i8", (-1,)),
    "normals": ("<f8", (-1, 3, 3)),
    "parameters": ("<f8", (-1, 2)),
}
"""Their numbers as bytes, and their shapes; the last one only where it is known."""


def mesh_record(mesh: Mesh) -> dict[str, Any]:
    """The arrays in base 64, little end first."""
    record: dict[str, Any] = {"names": list(mesh.names)}
    for name, (number, _) in _ARRAYS.items():
        array = getattr(mesh, name)
        if array is not None:
            data = np.ascontiguousarray(array, dtype=number).tobytes()
            record[name] = base64.b64encode(data).decode("ascii")
    return record


def _read_array(text: str, name: str) -> Any:
    number, shape = _ARRAYS[name]
    size = np.dtype(number).itemsize * -math.prod(shape)
    try:
        data = base64.b64decode(text, validate=True)
    except ValueError:
        raise ValueError(f"the mesh's {name} are not written in base 64") from None
    if len(data) % size:
        raise ValueError(f"the mesh's {name} have {len(data)} bytes, which is no multiple of {size}")
    array = np.frombuffer(data, dtype=number).reshape(shape).copy()
    if not np.isfinite(array).all():
        raise ValueError(f"the mesh's {name} are not all finite")
    return array


def read_mesh(record: dict[str, Any]) -> Mesh:
    """The mesh of `mesh_record`; raises `ValueError` for arrays that make no mesh."""
    arrays = {name: _read_array(record[name], name) for name in _ARRAYS if name in record}
    points, triangles, faces, normals = (arrays[name] for name in ("points", "triangles", "faces", "normals"))
    parameters = arrays.get("parameters")
    names = tuple(record["names"])
    if not 0 < len(triangles) == len(faces) == len(normals):
        raise ValueError("the mesh's triangles, faces and normals are not equally many")
    for numbers, size in ((triangles, len(points)), (faces, len(names))):
        if numbers.min() < 0 or numbers.max() >= size:
            raise ValueError("the mesh has numbers of points or faces that do not exist")
    if parameters is not None and len(parameters) != len(points):
        raise ValueError("the mesh's parameters are not as many as its points")
    return Mesh(points, triangles.astype(np.intp), faces.astype(np.intp), names, normals, parameters)
