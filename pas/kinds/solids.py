"""Solids, meshes, assemblies, their parts and teapots as kinds of shapes.

Solids are kept as their trees of inequalities and the claimed joints, meshes as their arrays in base 64, to the last
bit.  How near a mesh is to its surface is not kept: nobody could prove or measure it again from the file.
"""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np

from pas.designs.teapot import STYLES, Teapot
from pas.exchange.schema import TEXT, Table, choice, list_of, one_of
from pas.exchange.solid_records import RECORD, read_solid, solid_record
from pas.mesh.mesh import Mesh
from pas.render.parts import part_layers, solid_layers
from pas.render.scene import Scene
from pas.shape import Kind
from pas.solid.assembly import Assembly, Part, assembly
from pas.solid.solid import Solid
from pas.verdicts import Verdicts

_MESH = Table(
    dict.fromkeys(("points", "triangles", "faces", "normals"), TEXT) | {"names": list_of(TEXT)},
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


def _mesh_record(mesh: Mesh) -> dict[str, Any]:
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


def _read_mesh(record: dict[str, Any]) -> Mesh:
    """The mesh of `_mesh_record`; raises `ValueError` for arrays that make no mesh."""
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


SOLID = Kind(
    "solid",
    Solid,
    Table({"solid": RECORD}),
    lambda solid, _: {"solid": solid_record(solid)},
    lambda content: read_solid(content["solid"]),
    solid_layers,
)
MESH = Kind(
    "mesh",
    Mesh,
    Table({"mesh": _MESH}),
    lambda mesh, _: {"mesh": _mesh_record(mesh)},
    lambda content: _read_mesh(content["mesh"]),
    solid_layers,
    meshed=True,
)

_COMMON = {"name": TEXT, "color": TEXT}
_PART = choice(
    "a part: a table with a solid or a mesh", Table({"solid": RECORD, **_COMMON}), Table({"mesh": _MESH, **_COMMON})
)


def _part_record(name: str, part: Part) -> dict[str, Any]:
    """A part with its name and colour; raises `ValueError` naming a part that cannot be kept."""
    try:
        shape = part.shape
        kept = {"solid": solid_record(shape)} if isinstance(shape, Solid) else {"mesh": _mesh_record(shape)}
    except ValueError as error:
        raise ValueError(f"the part {name!r}: {error}") from None
    return {"name": name, "color": part.color, **kept}


def _read_parts(records: list[dict[str, Any]]) -> Assembly:
    """The assembly of the parts of `_part_record`."""
    if len({record["name"] for record in records}) < len(records):
        raise ValueError("two parts have the same name")
    shapes = [read_solid(r["solid"]) if "solid" in r else _read_mesh(r["mesh"]) for r in records]
    return assembly({r["name"]: (shape, r["color"]) for r, shape in zip(records, shapes, strict=True)})


def _layers(thing: Assembly, scene: Scene) -> None:
    for name, part in thing.parts.items():
        part_layers(part, scene, name)


ASSEMBLY = Kind(
    "assembly",
    Assembly,
    Table({"parts": list_of(_PART)}),
    lambda thing, _: {"parts": [_part_record(name, part) for name, part in thing.parts.items()]},
    lambda content: _read_parts(content["parts"]),
    _layers,
    parts=lambda thing: thing.parts,
)
PART = Kind(
    "part",
    Part,
    Table({"part": _PART}),
    lambda part, _: {"part": _part_record("part", part)},
    lambda content: _read_parts([content["part"]])[content["part"]["name"]],
    part_layers,
    parts=lambda part: {"part": part},
)

_SOLIDS = ("solid", "pot", "lid")


def _teapot_record(teapot: Teapot, _: Verdicts | None = None) -> dict[str, Any]:
    """The closed solid, and that of each part, exact."""
    return {"style": teapot.style, **{name: solid_record(getattr(teapot, name)) for name in _SOLIDS}}


TEAPOT = Kind(
    "teapot",
    Teapot,
    Table({"style": one_of(tuple(STYLES))} | dict.fromkeys(_SOLIDS, RECORD)),
    _teapot_record,
    lambda content: Teapot(content["style"], *(read_solid(content[name]) for name in _SOLIDS)),
    lambda teapot, scene: solid_layers(teapot.solid, scene),
)
