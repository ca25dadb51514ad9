"""OBJ: an object for each part, a group for each face, normals of the corners, double precision.

Colours stand after the coordinates of the points, since materials need a second file.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pas.exchange.formats import Format, Request
from pas.exchange.parts import TRIANGLES, Piece, all_different, face_names
from pas.limits import checkpoint


def write_obj(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts, closed meshes closed."""
    lines = [f"# unit: {request.unit}"]
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


OBJ = Format(".obj", TRIANGLES, write_obj)
