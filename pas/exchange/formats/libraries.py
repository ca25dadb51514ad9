"""GLB and VTP of all triangles, and 3MF of closed bodies, each by a library.

GLB (binary glTF), by trimesh: a named node and a material for each part, normals of the points, single precision;
what stands in many places is one mesh, of which that node has a child for each.  Its lengths are meters (glTF 2.0,
3.4): of a model with a unit they are.  The unit of the numbers is written as the scene's extras.

VTP (VTK's XML of polygons), by pyvista: `face`, `part` and `color` of triangles, names, normals, double precision;
points have `parameters` where all parts are meshes of parametric surfaces.  In both, points are doubled along sharp
edges.

3MF, by lib3mf: one named object a part, its colour and the unit of lengths.  Guaranteed: each part is an object of its
own in the file's build, of the type "surface" where it is open (3MF core 1.3, 4.1); what stands in many places is
written once, as components of one object.  Not guaranteed: more than single
precision, which is what lib3mf takes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pas.errors import library, optional
from pas.exchange.formats import Format, Request
from pas.exchange.parts import (
    PLACED,
    TRIANGLES,
    Piece,
    counted_on,
    face_numbers,
    in_unit,
    is_closed,
    repeated_colors,
    triangles_of,
)
from pas.limits import checkpoint


def write_glb(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts as a scene, in meters if the model has a unit."""
    import trimesh

    parts, told = in_unit(parts, request, "meter"), "meter" if request.unit else request.told_unit
    names = [p.name for p in parts]
    root = "root"
    while root in names:
        root += "_"
    scene: Any = trimesh.Scene(metadata={"unit": told}, base_frame=root)
    for part in parts:
        checkpoint()
        scene.add_geometry(part.mesh.to_trimesh(), node_name=part.name, geom_name=part.name)

    def paint(tree: dict[str, Any]) -> None:
        tree["materials"] = [_material(p) for p in parts]
        for mesh in tree["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["material"] = names.index(mesh["name"])
        nodes, places = tree["nodes"], {part.name: part.places for part in parts if part.places is not None}
        for node in [node for node in nodes if node["name"] in places]:
            mesh, shifts = node.pop("mesh"), np.char.mod("%.9g", places[node["name"]]).astype(float).tolist()
            node["children"] = list(range(len(nodes), len(nodes) + len(shifts)))
            nodes += [{"mesh": mesh, "translation": shift} for shift in shifts]

    checkpoint()
    path.write_bytes(scene.export(file_type="glb", include_normals=True, tree_postprocessor=paint))


def _material(part: Piece) -> dict[str, Any]:
    """A material of glTF, in which colours are linear, not those of screens (sRGB, IEC 61966-2-1)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (c / 255 for c in part.color)]
    surface = {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6}
    return {"name": part.name, "pbrMetallicRoughness": surface}


GLB = Format(".glb", PLACED, write_glb)


def write_vtp(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts put together."""
    pyvista = optional("pyvista")
    checkpoint()  # that library takes long to load
    shading = [p.mesh.shading for p in parts]
    checkpoint()
    triangles = counted_on([s[1] for s in shading], [len(s[0]) for s in shading]).astype(int)
    data = pyvista.PolyData.from_regular_faces(np.concatenate([s[0] for s in shading]), triangles)
    data.point_data.active_normals = np.concatenate([s[2] for s in shading])
    parameters = [p.mesh.parameters[p.mesh.shading_points] for p in parts if p.mesh.parameters is not None]
    if len(parameters) == len(parts):
        data.point_data["parameters"] = np.concatenate(parameters)
    numbers, names = face_numbers(parts)
    data.cell_data["face"] = numbers
    data.cell_data["part"] = np.repeat(np.arange(len(parts)), [len(s[1]) for s in shading])
    data.cell_data["color"] = repeated_colors(parts, triangles_of)
    data.field_data["face names"] = np.array(names)
    data.field_data["part names"] = np.array([p.name for p in parts])
    data.field_data["unit"] = np.array([request.told_unit])
    checkpoint()
    data.save(path)


VTP = Format(".vtp", TRIANGLES, write_vtp)


def require_lib3mf() -> Any:
    """The module lib3mf; raises `MissingLibraryError` without it."""
    return library(
        "lib3mf",
        "3MF files need lib3mf: pip install lib3mf (Linux on Arm has no ready packages; .stl, .obj, .ply, .glb and "
        ".vtp need nothing more)",
    )


def three_mf_unit(name: str) -> Any:
    """The unit of lib3mf that has this name in `UNITS`."""
    units = {unit.lower(): unit for unit in ("MicroMeter", "MilliMeter", "CentiMeter", "Meter", "Inch", "Foot")}
    return getattr(require_lib3mf().ModelUnit, units[name])


def write_3mf(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts."""
    lib3mf = require_lib3mf()
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(three_mf_unit(request.told_unit))
    together: Any = None
    for part in parts:
        checkpoint()
        item = model.AddMeshObject()
        item.SetType(lib3mf.ObjectType.Model if part.mesh.is_closed else lib3mf.ObjectType.Surface)
        item.SetName(part.name)
        points, triangles = part.mesh.points, part.mesh.triangles
        item.SetGeometry(_records(lib3mf.Position, points, "<f4"), _records(lib3mf.Triangle, triangles, "<u4"))
        group = model.AddColorGroup()
        item.SetObjectLevelProperty(group.GetResourceID(), group.AddColor(wrapper.RGBAToColor(*part.color, 255)))
        if part.places is None:
            model.AddBuildItem(item, wrapper.GetIdentityTransform())
            continue
        if together is None:
            together = model.AddComponentsObject()
            together.SetName(request.name)
            model.AddBuildItem(together, wrapper.GetIdentityTransform())
        matrices = np.zeros((len(part.places), 4, 3), dtype="<f4")
        matrices[:, :3], matrices[:, 3] = np.eye(3), part.places
        handle = ctypes.c_void_p()  # `AddComponent` makes a class for each place, which takes twenty times as long
        for transform in (lib3mf.Transform * len(matrices)).from_buffer_copy(matrices.tobytes()):
            placed = together._handle, item._handle, transform, handle
            wrapper.checkError(together, wrapper.lib.lib3mf_componentsobject_addcomponent(*placed))
            wrapper.lib.lib3mf_release(handle)
    checkpoint()
    writer = model.QueryWriter("3mf")
    writer.SetDecimalPrecision(9)  # its usual six would round a part of a few units visibly
    writer.WriteToFile(str(path))


def _records(kind: Any, rows: Any, number: str) -> Any:
    """The rows (N, 3) as an array of structures."""
    data = np.ascontiguousarray(rows, dtype=number).tobytes()
    return (kind * len(rows)).from_buffer_copy(data)


THREE_MF = Format(".3mf", PLACED, write_3mf, require_lib3mf, is_closed, bodies=True, closed=True)
