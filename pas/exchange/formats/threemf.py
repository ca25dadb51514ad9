"""3MF files, by lib3mf: one named object a part, its colour and the unit of lengths.

Guaranteed: each part is a closed object of its own in the file's build.  Not guaranteed: more than single precision,
which is what lib3mf takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pas.errors import MissingLibraryError
from pas.exchange.formats import Format, Request
from pas.exchange.parts import TRIANGLES, Piece, is_closed
from pas.limits import checkpoint

UNITS = {
    "micrometer": "MicroMeter",
    "millimeter": "MilliMeter",
    "centimeter": "CentiMeter",
    "meter": "Meter",
    "inch": "Inch",
    "foot": "Foot",
}
"""Units of lengths by name, and what lib3mf calls them."""

DIGITS = 9
"""Of coordinates after the point (lib3mf's six would round a part of a few units visibly)."""


def require_library() -> Any:
    """The module lib3mf; raises `MissingLibraryError` without it."""
    try:
        import lib3mf
    except ImportError:
        raise MissingLibraryError(
            "3MF files need lib3mf: pip install lib3mf (Linux on Arm has no ready packages; .stl, .obj, .ply, "
            ".glb and .vtp need nothing more)"
        ) from None
    return lib3mf


def write_3mf(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts; raises `ValueError` for one that is open."""
    lib3mf = require_library()
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(getattr(lib3mf.ModelUnit, UNITS[request.unit]))
    for part in parts:
        checkpoint()
        if not part.mesh.is_closed:
            raise ValueError(f"3MF files hold closed bodies, and the mesh of {part.name!r} is open")
        item = model.AddMeshObject()
        item.SetName(part.name)
        points, triangles = part.mesh.points, part.mesh.triangles
        item.SetGeometry(_records(lib3mf.Position, points, "<f4"), _records(lib3mf.Triangle, triangles, "<u4"))
        group = model.AddColorGroup()
        item.SetObjectLevelProperty(group.GetResourceID(), group.AddColor(wrapper.RGBAToColor(*part.color, 255)))
        model.AddBuildItem(item, wrapper.GetIdentityTransform())
    checkpoint()
    writer = model.QueryWriter("3mf")
    writer.SetDecimalPrecision(DIGITS)
    writer.WriteToFile(str(path))


def _records(kind: Any, rows: Any, number: str) -> Any:
    """The rows (N, 3) as an array of structures."""
    data = np.ascontiguousarray(rows, dtype=number).tobytes()
    return (kind * len(rows)).from_buffer_copy(data)


THREE_MF = Format(".3mf", TRIANGLES, write_3mf, require_library, is_closed, closed=True)
