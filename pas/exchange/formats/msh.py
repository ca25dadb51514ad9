"""Gmsh's .msh, version 2.2, by meshio: tetrahedra and boundary triangles, their parts and faces as physical groups."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pas.errors import MissingLibraryError
from pas.exchange.formats import Format, Request
from pas.exchange.parts import all_different
from pas.exchange.volume import TETRAHEDRA, VolumeMesh


def write_msh(mesh: VolumeMesh, path: Path, request: Request) -> None:
    """In version 2.2, which every reader knows; faces are groups 1 to F, parts F + 1 onwards."""
    meshio = _require_library()
    faces = len(mesh.names)
    tags = [(mesh.faces + 1).astype(np.int32), (mesh.regions + 1 + faces).astype(np.int32)]
    names = _quotable([*mesh.names, *mesh.region_names])
    groups = {name: np.array([i + 1, 2 if i < faces else 3]) for i, name in enumerate(names)}
    meshio.Mesh(
        mesh.points,
        [("triangle", mesh.boundary), ("tetra", mesh.tetrahedra)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=groups,
    ).write(path, file_format="gmsh22", binary=False)


def _require_library() -> Any:
    try:
        import meshio
    except ImportError:
        raise MissingLibraryError("files of Gmsh need meshio: pip install meshio") from None
    return meshio


def _quotable(names: Sequence[str]) -> list[str]:
    """The names without quotes and line ends, all different (a part may be named as a face)."""
    return all_different((" ".join(name.replace('"', "'").split()) for name in names), " ")


MSH = Format(".msh", TETRAHEDRA, write_msh, _require_library)
