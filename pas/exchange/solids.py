"""Solids, their meshes and assemblies as triangle files.

| suffix | parts          | faces            | colours             | normals           | numbers |
|--------|----------------|------------------|---------------------|-------------------|---------|
| .stl   | put together   | no               | no                  | of the facets     | single  |
| .obj   | objects        | groups           | of the vertices     | of the corners    | double  |
| .ply   | `part`         | `face`           | of both             | no                | double  |
| .3mf   | named objects  | no               | of the objects      | no                | single  |
| .glb   | named nodes    | no               | materials           | of the points     | single  |
| .vtp   | `part`, names  | `face`, names    | `color`             | of the points     | double  |

Guaranteed: a file is written whole or not at all; triangles, their order within a part and their
orientation are those of `Solid.mesh`; .obj, .ply and .3mf keep closed meshes closed (.glb and .vtp
double the points of sharp edges, .stl has no points to share).  Not guaranteed: that single
precision tells apart points of a small solid far from the origin, and that parts put together in one
.stl are apart: no boolean is taken.  The unit is said where the format can say it (.3mf, and as extras
of .glb); no number is changed for it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pas.exchange.files import replacing, target
from pas.exchange.meshes import binary_stl
from pas.exchange.threemf import UNITS, require_library, write_3mf
from pas.limits import Report, limited
from pas.mesh.field import Floats, Integers
from pas.mesh.mesh import Mesh
from pas.solid.assembly import COLORS, Assembly
from pas.solid.solid import Solid


@dataclass(frozen=True)
class Piece:
    """One part as files see it: its name, colour (red, green, blue up to 255) and mesh."""

    name: str
    color: tuple[int, int, int]
    mesh: Mesh


@limited("writing a solid", "a coarser tolerance")
def write_solid(
    shape: Solid | Mesh | Assembly,
    path: str | Path,
    *,
    tolerance: float | None = None,
    unit: str = "millimeter",
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Write a solid, a mesh of one or an assembly as triangles; returns the path.

    The suffix says how: .stl, .obj, .ply, .3mf, .glb or .vtp.  `tolerance` is that of `Solid.mesh`;
    `unit` is micrometer, millimeter, centimeter, meter, inch or foot.  A shape that is no assembly is
    one part, named as the file, in the colour of an assembly's first part.

    Raises `ValueError` for another suffix or unit and for a folder that does not exist, `TypeError`
    for another shape, `MissingLibraryError` where a package for the format is absent, and what
    `Solid.mesh` raises.
    """
    suffix = check_solid_suffix(path)
    if suffix == ".3mf":
        require_library()
    write = _WRITERS[suffix]
    if unit not in UNITS:
        raise ValueError(f"unit must be one of {', '.join(UNITS)}, not {unit!r}")
    with replacing(path) as temporary:
        write(pieces(shape, Path(path).stem, tolerance), temporary, unit)
    return Path(path)


def pieces(shape: Solid | Mesh | Assembly, name: str, tolerance: float | None) -> list[Piece]:
    """The parts of a shape, meshed; a shape that is no assembly is one part with the given name."""
    if isinstance(shape, Assembly):
        return [Piece(n, _rgb(p.color), p.mesh(tolerance)) for n, p in shape.parts.items()]
    if isinstance(shape, Solid):
        return [Piece(name, _rgb(COLORS[0]), shape.mesh(tolerance))]
    if isinstance(shape, Mesh):
        return [Piece(name, _rgb(COLORS[0]), shape)]
    raise TypeError(f"shape must be a Solid, a Mesh or an Assembly, not {shape!r}")


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def _together(parts: Sequence[Piece]) -> tuple[Floats, Integers]:
    """Points and triangles of all parts, with no point shared between parts."""
    starts = np.cumsum([0, *(len(p.mesh.points) for p in parts)])
    triangles = [p.mesh.triangles + start for p, start in zip(parts, starts, strict=False)]
    return np.concatenate([p.mesh.points for p in parts]), np.concatenate(triangles)


def _faces(parts: Sequence[Piece]) -> tuple[Integers, list[str]]:
    """The number of each triangle's face among those of all parts, and their names, `part: face` for several."""
    starts = np.cumsum([0, *(len(p.mesh.names) for p in parts)])
    numbers = np.concatenate([p.mesh.faces + start for p, start in zip(parts, starts, strict=False)])
    single = len(parts) == 1
    return numbers, [name if single else f"{p.name}: {name}" for p in parts for name in p.mesh.names]


def _colors(parts: Sequence[Piece], count: Callable[[Mesh], int]) -> Any:
    """The parts' colours, each as often as its mesh has what is counted (M, 3)."""
    colors = np.array([p.color for p in parts], dtype=np.uint8)
    return np.repeat(colors, [count(p.mesh) for p in parts], axis=0)


def _points_of(mesh: Mesh) -> int:
    return len(mesh.points)


def _triangles_of(mesh: Mesh) -> int:
    return len(mesh.triangles)


def _write_stl(parts: Sequence[Piece], path: Path, unit: str) -> None:
    path.write_bytes(binary_stl(*_together(parts)))


def _write_obj(parts: Sequence[Piece], path: Path, unit: str) -> None:
    """With vertex colours after the coordinates, since materials need a second file."""
    lines = [f"# unit: {unit}"]
    objects = _words([p.name for p in parts])
    names = iter(_words(_faces(parts)[1]))
    points_before = normals_before = 1
    for part, title in zip(parts, objects, strict=True):
        mesh = part.mesh
        color = " ".join(f"{c / 255:.6g}" for c in part.color)
        normals, numbers = np.unique(mesh.normals.reshape(-1, 3).round(7), axis=0, return_inverse=True)
        corners = np.stack([mesh.triangles.ravel() + points_before, numbers.ravel() + normals_before], axis=1)
        rows = corners.reshape(-1, 6).tolist()
        lines.append(f"o {title}")
        lines += [f"v {x!r} {y!r} {z!r} {color}" for x, y, z in mesh.points.tolist()]
        lines += [f"vn {x:.7g} {y:.7g} {z:.7g}" for x, y, z in normals.tolist()]
        for face in range(len(mesh.names)):
            group = next(names)
            here = np.flatnonzero(mesh.faces == face).tolist()
            if here:
                lines.append(f"g {group}")
                lines += ["f {}//{} {}//{} {}//{}".format(*rows[i]) for i in here]
        points_before += len(mesh.points)
        normals_before += len(normals)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _words(names: Sequence[str]) -> list[str]:
    """The names as single words, since OBJ reads spaces as several names, all different."""
    result: list[str] = []
    for name in names:
        base = word = "_".join(name.split()) or "unnamed"
        number = 1
        while word in result:
            number += 1
            word = f"{base}_{number}"
        result.append(word)
    return result


def _write_ply(parts: Sequence[Piece], path: Path, unit: str) -> None:
    points, triangles = _together(parts)
    vertices = np.zeros(len(points), dtype=[("point", "<f8", 3), ("color", "u1", 3)])
    vertices["point"], vertices["color"] = points, _colors(parts, _points_of)
    record = [("count", "u1"), ("corners", "<i4", 3), ("color", "u1", 3), ("face", "<i4"), ("part", "<i4")]
    faces = np.zeros(len(triangles), dtype=record)
    faces["count"], faces["corners"], faces["face"] = 3, triangles, _faces(parts)[0]
    faces["color"] = _colors(parts, _triangles_of)
    faces["part"] = np.repeat(np.arange(len(parts)), [len(p.mesh.triangles) for p in parts])
    colors = [f"property uchar {c}" for c in ("red", "green", "blue")]
    header = [
        *("ply", "format binary_little_endian 1.0", f"comment unit: {unit}"),
        *(f"comment part {i}: {_ascii(p.name)}" for i, p in enumerate(parts)),
        *(f"comment face {i}: {_ascii(name)}" for i, name in enumerate(_faces(parts)[1])),
        *(f"element vertex {len(points)}", *(f"property double {c}" for c in "xyz"), *colors),
        *(f"element face {len(triangles)}", "property list uchar int vertex_indices", *colors),
        *("property int face", "property int part", "end_header"),
    ]
    path.write_bytes(("\n".join(header) + "\n").encode("ascii") + vertices.tobytes() + faces.tobytes())


def _ascii(text: str) -> str:
    return " ".join(text.split()).encode("ascii", "backslashreplace").decode("ascii")


def _write_3mf(parts: Sequence[Piece], path: Path, unit: str) -> None:
    write_3mf([(p.name, p.color, p.mesh.points, p.mesh.triangles) for p in parts], path, unit)


def _write_glb(parts: Sequence[Piece], path: Path, unit: str) -> None:
    import trimesh

    names = [p.name for p in parts]
    root = "root"
    while root in names:
        root += "_"
    scene: Any = trimesh.Scene(metadata={"unit": unit}, base_frame=root)
    for part in parts:
        points, triangles, normals = part.mesh.shading
        mesh = trimesh.Trimesh(points, triangles, vertex_normals=normals, process=False)
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name)

    def paint(tree: dict[str, Any]) -> None:
        tree["materials"] = [_material(p) for p in parts]
        for mesh in tree["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["material"] = names.index(mesh["name"])

    path.write_bytes(scene.export(file_type="glb", include_normals=True, tree_postprocessor=paint))


def _material(part: Piece) -> dict[str, Any]:
    """A material of glTF, in which colours are linear, not those of screens (sRGB, IEC 61966-2-1)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (c / 255 for c in part.color)]
    surface = {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6}
    return {"name": part.name, "pbrMetallicRoughness": surface}


def _write_vtp(parts: Sequence[Piece], path: Path, unit: str) -> None:
    import pyvista

    shading = [p.mesh.shading for p in parts]
    starts = np.cumsum([0, *(len(points) for points, _, _ in shading)])
    triangles = [(t + start).astype(int) for (_, t, _), start in zip(shading, starts, strict=False)]
    data = pyvista.PolyData.from_regular_faces(np.concatenate([s[0] for s in shading]), np.concatenate(triangles))
    data.point_data.active_normals = np.concatenate([s[2] for s in shading])
    numbers, names = _faces(parts)
    data.cell_data["face"] = numbers
    data.cell_data["part"] = np.repeat(np.arange(len(parts)), [len(t) for t in triangles])
    data.cell_data["color"] = _colors(parts, _triangles_of)
    data.field_data["face names"] = np.array(names)
    data.field_data["part names"] = np.array([p.name for p in parts])
    data.field_data["unit"] = np.array([unit])
    data.save(path)


_WRITERS: dict[str, Callable[[Sequence[Piece], Path, str], None]] = {
    ".stl": _write_stl,
    ".obj": _write_obj,
    ".ply": _write_ply,
    ".3mf": _write_3mf,
    ".glb": _write_glb,
    ".vtp": _write_vtp,
}

SOLID_SUFFIXES = tuple(_WRITERS)


def check_solid_suffix(path: str | Path) -> str:
    """The suffix of a file of a solid that can be written at `path`; raises what `pas.exchange.files.target` raises."""
    return target(path, SOLID_SUFFIXES, "a solid")
