"""Files of tetrahedra: VTK's .vtu by pyvista and Gmsh's .msh by meshio.

Guaranteed: whole files or none, double precision, tetrahedra and boundary triangles with the numbers
and names of their parts and faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pas.errors import MissingLibraryError
from pas.exchange.files import replacing, target

if TYPE_CHECKING:
    from pas.exchange.volume import VolumeMesh

SUFFIXES = (".vtu", ".msh")


def check_volume_suffix(path: str | Path) -> str:
    """The suffix of a file of tetrahedra to be written at `path`; raises what `pas.exchange.files.target` does."""
    return target(path, SUFFIXES, "tetrahedra")


def write_volume(mesh: VolumeMesh, path: str | Path) -> Path:
    """Write tetrahedra with their boundary; returns the path."""
    suffix = check_volume_suffix(path)
    with replacing(path) as temporary:
        if suffix == ".vtu":
            to_grid(mesh).save(temporary)
        else:
            _write_gmsh(mesh, temporary)
    return Path(path)


def to_grid(mesh: VolumeMesh) -> Any:
    """A `pyvista.UnstructuredGrid` of the tetrahedra and after them the boundary triangles.

    `region` is -1 for triangles, `face` is -1 for tetrahedra.  The names are bytes, a line each (UTF-8),
    in the field arrays `region names` and `face names`: readers such as meshio refuse files with strings.
    """
    import pyvista

    cells = {
        pyvista.CellType.TETRA: mesh.tetrahedra.astype(int),
        pyvista.CellType.TRIANGLE: mesh.boundary.astype(int),
    }
    grid = pyvista.UnstructuredGrid(cells, mesh.points)
    grid.cell_data["region"] = np.concatenate([mesh.regions, np.full(len(mesh.boundary), -1)])
    grid.cell_data["face"] = np.concatenate([np.full(len(mesh.tetrahedra), -1), mesh.faces])
    grid.field_data["region names"] = _lines(mesh.region_names)
    grid.field_data["face names"] = _lines(mesh.names)
    return grid


def _lines(names: Sequence[str]) -> Any:
    return np.frombuffer("\n".join(" ".join(n.split()) for n in names).encode("utf-8"), dtype=np.uint8)


def _write_gmsh(mesh: VolumeMesh, path: Path) -> None:
    """In version 2.2, which every reader knows; faces are groups 1 to F, parts F + 1 onwards."""
    try:
        import meshio
    except ImportError:
        raise MissingLibraryError("files of Gmsh need meshio: pip install meshio") from None
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


def _quotable(names: Sequence[str]) -> list[str]:
    """The names without quotes and line ends, all different (a part may be named as a face)."""
    result: list[str] = []
    for name in names:
        base = word = " ".join(name.replace('"', "'").split()) or "unnamed"
        number = 1
        while word in result:
            number += 1
            word = f"{base} {number}"
        result.append(word)
    return result
