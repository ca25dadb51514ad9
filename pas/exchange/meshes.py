"""Mesh files, by pyvista and trimesh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pas.exchange.files import replacing, target
from pas.generatrix.blend import GeneratrixBlend
from pas.generatrix.quadrics import SphereBlend
from pas.limits import Report, limited
from pas.mesh.field import Floats, Integers
from pas.mesh.mesh import Mesh
from pas.parametric.blends import ParametricBlend
from pas.parametric.surface import ParametricSurface

SUFFIXES = (".stl", ".obj", ".ply", ".vtp", ".glb")


def check_mesh_suffix(path: str | Path) -> str:
    """The suffix of a mesh file that can be written at `path`; raises what `pas.exchange.files.target` raises."""
    return target(path, SUFFIXES, "a mesh", {".3mf": "; a blend's solid can, see `pas convert` and blend.solid()"})


@limited("writing a mesh", "a coarser tolerance")
def write_mesh(
    shape: Mesh | ParametricSurface | ParametricBlend | GeneratrixBlend | SphereBlend,
    path: str | Path,
    *,
    tolerance: Any = None,
    domain: Any = None,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Write a mesh with its normals (STL has those of its facets only); returns the path.

    `.stl` is binary; `.vtp` is VTK's XML format, with the parameters of vertices where there are any.  `tolerance`
    and `domain` are those of `ParametricSurface.mesh`, for surfaces and blends of two (of one by a generatrix, of its
    `surface`); a `SphereBlend` has a `mesh` of its own.

    Raises `ValueError` for another suffix and for these two beside a mesh, `TypeError` for another shape, and what
    `mesh` raises.
    """
    suffix = check_mesh_suffix(path)
    mesh = _mesh(shape, tolerance, domain)
    with replacing(path) as temporary:
        if suffix == ".stl":
            temporary.write_bytes(binary_stl(mesh.points, mesh.triangles))
        elif suffix == ".vtp":
            mesh.to_pyvista().save(temporary)
        else:
            _trimesh(mesh).export(temporary, file_type=suffix[1:], **_options(suffix))
    return Path(path)


def _mesh(shape: Any, tolerance: Any, domain: Any) -> Mesh:
    if isinstance(shape, ParametricSurface | ParametricBlend):
        return shape.mesh(tolerance, domain)
    if isinstance(shape, GeneratrixBlend):
        return shape.surface.mesh(tolerance, domain)
    shape = shape.mesh() if isinstance(shape, SphereBlend) else shape
    if not isinstance(shape, Mesh):
        raise TypeError(f"shape must be a Mesh, a parametric surface or a blend of such, not {shape!r}")
    if tolerance is not None or domain is not None:
        raise ValueError("tolerance and domain are for surfaces; a mesh has them behind it")
    return shape


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


def _trimesh(mesh: Mesh) -> Any:
    import trimesh

    return trimesh.Trimesh(mesh.points, mesh.triangles, vertex_normals=mesh.point_normals, process=False)
