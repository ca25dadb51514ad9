"""STL, OBJ, PLY and CSV, which are written here, without a library; `pas.exchange.write` says what they hold.

In OBJ files colours stand after the coordinates of the points, since materials need a second file.  In PLY files, which
are binary as those of STL, names are comments, and points have normals where no part has a sharp edge, at which a point
has several.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from pas.arrays import Floats
from pas.exchange.formats import UNITS, Format, Request
from pas.exchange.parts import (
    MEASURES,
    TRIANGLES,
    Piece,
    all_different,
    face_names,
    face_numbers,
    in_unit,
    joined,
    repeated_colors,
)
from pas.limits import checkpoint
from pas.solid.measures import PartList

AT_ONCE = 2**16
"""Triangles that are written together."""


def write_stl(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts' triangles, in millimeters if the model has a unit."""
    points, triangles = joined(in_unit(parts, request, "millimeter"))
    some = (triangles[start : start + AT_ONCE] for start in range(0, len(triangles), AT_ONCE))
    save_stl(path, len(triangles), (points[of] for of in some))


def save_stl(path: Path, count: int, triangles: Iterable[Floats]) -> None:
    """Write `count` triangles as binary STL, in single precision; their corners (n, 3, 3) come some at a time."""
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    with path.open("wb") as stream:
        stream.write(b"binary STL".ljust(80) + np.uint32(count).tobytes())
        for corners in triangles:
            facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            facets /= np.maximum(np.linalg.norm(facets, axis=1, keepdims=True), 1e-300)
            data = np.zeros(len(corners), dtype=record)
            data["normal"], data["corners"] = facets, corners
            stream.write(data.tobytes())


STL = Format(".stl", TRIANGLES, write_stl, bodies=True)


def write_obj(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts, closed meshes closed."""
    lines = [f"# unit: {request.told_unit}"]
    objects = _words([p.name for p in parts])
    names = iter(_words(face_names(parts)))
    points_before = normals_before = 1
    for part, title in zip(parts, objects, strict=True):
        mesh = part.mesh
        color = " ".join(f"{c / 255:.6g}" for c in part.color)
        normals, numbers = np.unique(mesh.normals.reshape(-1, 3).round(7), axis=0, return_inverse=True)
        corners = np.stack([mesh.triangles.ravel() + points_before, numbers.ravel() + normals_before], axis=1)
        rows = corners.reshape(-1, 6).tolist()
        lines.append(f"o {title}")
        checkpoint()
        lines += [f"v {x!r} {y!r} {z!r} {color}" for x, y, z in mesh.points.tolist()]
        checkpoint()
        lines += [f"vn {x:.7g} {y:.7g} {z:.7g}" for x, y, z in normals.tolist()]
        for face in range(len(mesh.names)):
            group = next(names)
            here = np.flatnonzero(mesh.faces == face).tolist()
            checkpoint()
            if here:
                lines.append(f"g {group}")
                lines += ["f {}//{} {}//{} {}//{}".format(*rows[i]) for i in here]
        points_before += len(mesh.points)
        normals_before += len(normals)
    checkpoint()
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _words(names: Sequence[str]) -> list[str]:
    """The names as single words, since OBJ reads spaces as several names, all different."""
    return all_different(("_".join(name.split()) for name in names), "_")


OBJ = Format(".obj", TRIANGLES, write_obj, bodies=True)


def write_ply(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts put together, closed meshes closed."""
    points, triangles = joined(parts)
    numbers, names = face_numbers(parts)
    smooth = all(len(p.mesh.shading_points) <= len(p.mesh.points) for p in parts)
    fields = [("point", "<f8", 3), *([("normal", "<f8", 3)] if smooth else []), ("color", "u1", 3)]
    vertices = np.zeros(len(points), dtype=fields)
    vertices["point"], vertices["color"] = points, repeated_colors(parts, [len(p.mesh.points) for p in parts])
    if smooth:
        vertices["normal"] = np.concatenate([p.mesh.point_normals for p in parts])
    record = [("count", "u1"), ("corners", "<i4", 3), ("color", "u1", 3), ("face", "<i4"), ("part", "<i4")]
    faces = np.zeros(len(triangles), dtype=record)
    faces["count"], faces["corners"], faces["face"] = 3, triangles, numbers
    counts = [len(p.mesh.triangles) for p in parts]
    faces["color"], faces["part"] = repeated_colors(parts, counts), np.repeat(np.arange(len(parts)), counts)
    colors = [f"property uchar {c}" for c in ("red", "green", "blue")]
    header = [
        *("ply", "format binary_little_endian 1.0", f"comment unit: {request.told_unit}"),
        *(f"comment part {i}: {_ascii(p.name)}" for i, p in enumerate(parts)),
        *(f"comment face {i}: {_ascii(name)}" for i, name in enumerate(names)),
        *(f"element vertex {len(points)}", *(f"property double {c}" for c in "xyz")),
        *(f"property double n{c}" for c in "xyz" if smooth),
        *(*colors, f"element face {len(triangles)}", "property list uchar int vertex_indices", *colors),
        *("property int face", "property int part", "end_header"),
    ]
    path.write_bytes(("\n".join(header) + "\n").encode("ascii") + vertices.tobytes() + faces.tobytes())


def _ascii(text: str) -> str:
    return " ".join(text.split()).encode("ascii", "backslashreplace").decode("ascii")


PLY = Format(".ply", TRIANGLES, write_ply)


def write_csv(parts: PartList, path: Path, request: Request) -> None:
    """A line for each part, with its name and what it measures; heads tell the unit of a model that has one."""
    short = "" if request.unit is None else UNITS[request.unit].others[0]
    powers = {"volume": 3, "area": 2, "center": 1, "y": 1, "z": 1}
    heads = [f"{h} ({short}^{powers[w]})" if short and (w := h.split()[0]) in powers else h for h in PartList.HEADS]
    with path.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream).writerows([[h.replace("^1)", ")") for h in heads], *parts.rows])


CSV = Format(".csv", MEASURES, write_csv)
