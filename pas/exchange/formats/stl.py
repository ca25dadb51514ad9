"""STL, binary: bare triangles with the normals of the facets, in single precision.

Parts are put together without a boolean, and there are no points to share.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pas.exchange.formats import Format, Request
from pas.exchange.parts import TRIANGLES, Piece, joined
from pas.mesh.rows import Floats, Integers


def write_stl(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts' triangles."""
    path.write_bytes(binary_stl(*joined(parts)))


def binary_stl(points: Floats, triangles: Integers) -> bytes:
    """A binary STL file of points (N, 3), rounded to single precision, and triangles (T, 3)."""
    corners = points[triangles]
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facets /= np.maximum(np.linalg.norm(facets, axis=1, keepdims=True), 1e-300)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    data = np.zeros(len(corners), dtype=record)
    data["normal"], data["corners"] = facets, corners
    return b"binary STL".ljust(80) + np.uint32(len(corners)).tobytes() + data.tobytes()


STL = Format(".stl", TRIANGLES, write_stl)
