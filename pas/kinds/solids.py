"""Solids, meshes, assemblies, their parts and teapots as kinds of shapes.

Solids are kept as their trees of inequalities and the claimed joints, meshes as their arrays in base 64, to the last
bit.  How near a mesh is to its surface is not kept: nobody could prove or measure it again from the file.
"""

from __future__ import annotations

import base64
import math
from operator import attrgetter
from typing import Any

import numpy as np

from pas.designs.teapot import STYLES, Teapot
from pas.exchange.schema import TEXT, Table, alone, choice, list_of, one_of, read_by
from pas.exchange.solid_records import RECORD
from pas.mesh.mesh import Mesh
from pas.render.scene import Scene, solid_layers
from pas.shape import Kind
from pas.solid.assembly import Assembly, Part, assembly
from pas.solid.solid import Solid

_ARRAYS = {
    "points": ("<f8", (-1, 3)),
    "triangles": ("<i8", (-1, 3)),
    "faces": ("<i8", (-1,)),
    "normals": ("<f8", (-1, 3, 3)),
    "parameters": ("<f8", (-1, 2)),
}
"""Their numbers as bytes, and their shapes; the last one only where it is known."""


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


def _mesh(names: list[str], **texts: str) -> Mesh:
    """The mesh of arrays; raises `ValueError` for arrays that make no mesh."""
    arrays = {name: _read_array(texts[name], name) for name in _ARRAYS if name in texts}
    points, triangles, faces, normals = (arrays[name] for name in ("points", "triangles", "faces", "normals"))
    parameters = arrays.get("parameters")
    if not 0 < len(triangles) == len(faces) == len(normals):
        raise ValueError("the mesh's triangles, faces and normals are not equally many")
    for numbers, size in ((triangles, len(points)), (faces, len(names))):
        if numbers.min() < 0 or numbers.max() >= size:
            raise ValueError("the mesh has numbers of points or faces that do not exist")
    if parameters is not None and len(parameters) != len(points):
        raise ValueError("the mesh's parameters are not as many as its points")
    return Mesh(points, triangles.astype(np.intp), faces.astype(np.intp), tuple(names), normals, parameters)


def _mesh_entries(mesh: Mesh) -> dict[str, Any]:
    """The arrays in base 64, little end first."""
    arrays = {name: (getattr(mesh, name), number) for name, (number, _) in _ARRAYS.items()}
    return {"names": mesh.names} | {
        name: base64.b64encode(np.ascontiguousarray(array, dtype=number).tobytes()).decode("ascii")
        for name, (array, number) in arrays.items()
        if array is not None
    }


_MESH = Table(
    {**dict.fromkeys(("points", "triangles", "faces", "normals"), TEXT), "names": list_of(TEXT)},
    {"parameters": TEXT},
    make=_mesh,
    entries=_mesh_entries,
)

SOLID = Kind(
    "solid",
    Solid,
    alone("solid", RECORD),
    solid_layers,
    solid=lambda solid: solid,
)
MESH = Kind(
    "mesh",
    Mesh,
    alone("mesh", _MESH),
    solid_layers,
    meshed=True,
)

_COMMON = {"name": TEXT, "color": TEXT}
_PART = choice(
    "a part: a table with a solid or a mesh",
    Table({"solid": RECORD, **_COMMON}, of=lambda part: "solid" in part),
    Table({"mesh": _MESH, **_COMMON}),
)


def _write_part(item: tuple[str, Part]) -> dict[str, Any]:
    """A part with its name and colour; raises `ValueError` naming a part that cannot be kept."""
    name, part = item
    kind = "solid" if isinstance(part.shape, Solid) else "mesh"
    try:
        return _PART.write({"name": name, "color": part.color, kind: part.shape})
    except ValueError as error:
        raise ValueError(f"the part {name!r}: {error}") from None


_PARTS = list_of(read_by(_PART, _PART.read, _write_part))


def _assembly(parts: list[dict[str, Any]]) -> Assembly:
    """The assembly of what was read of its parts."""
    if len({part["name"] for part in parts}) < len(parts):
        raise ValueError("two parts have the same name")
    return assembly({p["name"]: (p["solid"] if "solid" in p else p["mesh"], p["color"]) for p in parts})


def _layers(thing: Assembly, scene: Scene) -> None:
    for name, part in thing.parts.items():
        solid_layers(part.shape, scene, name, part.color)


ASSEMBLY = Kind(
    "assembly",
    Assembly,
    Table({"parts": _PARTS}, make=_assembly, entries=lambda thing: {"parts": thing.parts.items()}),
    _layers,
    parts=lambda thing: thing.parts,
)
_NAMED = read_by(_PART, lambda r: _assembly([_PART.read(r)])[r["name"]], lambda part: _write_part(("part", part)))
PART = Kind(
    "part",
    Part,
    alone("part", _NAMED),
    lambda part, scene: solid_layers(part.shape, scene, color=part.color),
    parts=lambda part: {"part": part},
)

TEAPOT = Kind(
    "teapot",
    Teapot,
    Table({"style": one_of(tuple(STYLES)), **dict.fromkeys(("solid", "pot", "lid"), RECORD)}, make=Teapot),
    lambda teapot, scene: solid_layers(teapot.solid, scene),
    solid=attrgetter("solid"),
)
