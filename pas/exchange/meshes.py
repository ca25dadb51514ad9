"""Mesh files, by pyvista and trimesh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pas.exchange.files import replacing
from pas.mesh.field import Floats, Integers, TriangleMesh

SUFFIXES = (".stl", ".obj", ".ply", ".vtp", ".glb")


def check_mesh_suffix(path: str | Path) -> str:
    """The suffix of a mesh file, or `ValueError` naming those that exist."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"cannot write a mesh as {Path(path).name!r}; the suffix must be one of {', '.join(SUFFIXES)}")
    return suffix


def write_mesh(mesh: TriangleMesh, path: str | Path) -> Path:
    """Write a mesh with its normals (STL has those of its facets only); returns the path.

    `.stl` is binary; `.vtp` is VTK's XML format.  Raises `ValueError` for another suffix.
    """
    suffix = check_mesh_suffix(path)
    with replacing(path) as temporary:
        if suffix == ".stl":
            temporary.write_bytes(binary_stl(mesh.points, mesh.triangles))
        elif suffix == ".vtp":
            mesh.to_pyvista().save(temporary)
        else:
            _trimesh(mesh).export(temporary, file_type=suffix[1:], **_options(suffix))
    return Path(path)


def _options(suffix: str) -> dict[str, Any]:
    return {"include_normals": True} if suffix in (".obj", ".glb") else {"vertex_normal": True}


def binary_stl(points: Floats, triangles: Integers) -> bytes:
    """A binary STL file of points (N, 3), rounded to single precision, and triangles (T, 3)."""
    corners = points[triangles]
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facets /= np.maximum(np.linalg.norm(facets, axis=1, keepdims=True), 1e-300)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    data = np.zeros(len(corners), dtype=record)
    data["normal"], data["corners"] = facets, corners
    return b"binary STL".ljust(80) + np.uint32(len(corners)).tobytes() + data.tobytes()


def _trimesh(mesh: TriangleMesh) -> Any:
    import trimesh

    return trimesh.Trimesh(mesh.points, mesh.triangles, vertex_normals=mesh.normals, process=False)
