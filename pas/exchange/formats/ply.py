"""PLY, binary: points in double precision, colours, `face` and `part` of each triangle, their names as comments.

Points have normals where no part has a sharp edge, at which a point has several.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pas.exchange.formats import Format, Request
from pas.exchange.parts import TRIANGLES, Piece, face_numbers, joined, points_of, repeated_colors, triangles_of

AXES, COLORS = ("x", "y", "z"), ("red", "green", "blue")


def write_ply(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts put together, closed meshes closed."""
    points, triangles = joined(parts)
    numbers, names = face_numbers(parts)
    smooth = all(len(p.mesh.shading_points) <= len(p.mesh.points) for p in parts)
    fields = [("point", "<f8", 3), *([("normal", "<f8", 3)] if smooth else []), ("color", "u1", 3)]
    vertices = np.zeros(len(points), dtype=fields)
    vertices["point"], vertices["color"] = points, repeated_colors(parts, points_of)
    if smooth:
        vertices["normal"] = np.concatenate([p.mesh.point_normals for p in parts])
    record = [("count", "u1"), ("corners", "<i4", 3), ("color", "u1", 3), ("face", "<i4"), ("part", "<i4")]
    faces = np.zeros(len(triangles), dtype=record)
    faces["count"], faces["corners"], faces["face"] = 3, triangles, numbers
    faces["color"] = repeated_colors(parts, triangles_of)
    faces["part"] = np.repeat(np.arange(len(parts)), [len(p.mesh.triangles) for p in parts])
    colors = [f"property uchar {c}" for c in COLORS]
    header = [
        *("ply", "format binary_little_endian 1.0", f"comment unit: {request.unit}"),
        *(f"comment part {i}: {_ascii(p.name)}" for i, p in enumerate(parts)),
        *(f"comment face {i}: {_ascii(name)}" for i, name in enumerate(names)),
        *(f"element vertex {len(points)}", *(f"property double {c}" for c in AXES)),
        *(f"property double n{c}" for c in AXES if smooth),
        *(*colors, f"element face {len(triangles)}", "property list uchar int vertex_indices", *colors),
        *("property int face", "property int part", "end_header"),
    ]
    path.write_bytes(("\n".join(header) + "\n").encode("ascii") + vertices.tobytes() + faces.tobytes())


def _ascii(text: str) -> str:
    return " ".join(text.split()).encode("ascii", "backslashreplace").decode("ascii")


PLY = Format(".ply", TRIANGLES, write_ply)
