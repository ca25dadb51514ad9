"""VTP (VTK's XML of polygons), by pyvista: `face`, `part` and `color` of triangles, names, normals, double precision.

Points are doubled along sharp edges; they have `parameters` where all parts are meshes of parametric surfaces.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pas.exchange.formats import Format, Request
from pas.exchange.parts import TRIANGLES, Piece, face_numbers, repeated_colors, triangles_of
from pas.limits import checkpoint


def write_vtp(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts put together."""
    import pyvista

    checkpoint()  # that library takes long to load
    shading = [p.mesh.shading for p in parts]
    checkpoint()
    starts = np.cumsum([0, *(len(points) for points, _, _ in shading)])
    triangles = [(t + start).astype(int) for (_, t, _), start in zip(shading, starts, strict=False)]
    data = pyvista.PolyData.from_regular_faces(np.concatenate([s[0] for s in shading]), np.concatenate(triangles))
    data.point_data.active_normals = np.concatenate([s[2] for s in shading])
    parameters = [p.mesh.parameters[p.mesh.shading_points] for p in parts if p.mesh.parameters is not None]
    if len(parameters) == len(parts):
        data.point_data["parameters"] = np.concatenate(parameters)
    numbers, names = face_numbers(parts)
    data.cell_data["face"] = numbers
    data.cell_data["part"] = np.repeat(np.arange(len(parts)), [len(t) for t in triangles])
    data.cell_data["color"] = repeated_colors(parts, triangles_of)
    data.field_data["face names"] = np.array(names)
    data.field_data["part names"] = np.array([p.name for p in parts])
    data.field_data["unit"] = np.array([request.unit])
    checkpoint()
    data.save(path)


VTP = Format(".vtp", TRIANGLES, write_vtp)
