"""Tetrahedra that fill solids, by fTetWild (Hu, Schneider, Wang, Zorin, Panozzo 2020) through pytetwild.

Guaranteed, since it is checked, or a `GeometryError` is raised: what goes in is closed, finite and of
positive volume; what comes out are tetrahedra of positive volume whose boundary is a closed manifold and
whose volume is that of the triangle mesh up to `volume_tolerance`.  Not guaranteed: the same tetrahedra a
second time (fTetWild is not deterministic and has no seed), points exactly on the solid's edges (the
boundary is moved up to `tolerance`), and that neighbouring parts of an assembly share points: each is
meshed by itself.  fTetWild works in a process and a folder of its own: it crashes on some meshes (of parts thinner
than its envelope, say), and leaves files where it works.  Most of its time goes into finely meshed surfaces, so that a
generous tolerance is worth seconds.
"""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from pas.algebra.brief import brief
from pas.algebra.inputs import natural
from pas.algebra.rational import Exact, check_tolerance
from pas.arrays import Floats, Integers
from pas.elsewhere import elsewhere
from pas.errors import GeometryError, library, optional
from pas.exchange.files import target
from pas.exchange.formats import Content, Request
from pas.exchange.parts import Piece, face_names, parts_of
from pas.limits import WorkLimits, limited
from pas.mesh.mesh import Mesh
from pas.mesh.rows import counted_on
from pas.mesh.topology import is_closed_manifold
from pas.registry import loaded
from pas.settings import MeshSettings
from pas.solid.assembly import Assembly
from pas.solid.solid import Solid

if TYPE_CHECKING:
    import pyvista

VOLUME_TOLERANCE = 0.02
"""The largest relative error of the volume of the tetrahedra."""


@dataclass(frozen=True)
class VolumeSettings:
    """How fTetWild works; `stop_energy` is the AMIPS energy (3 is a regular tetrahedron) to stop at."""

    optimize: bool = True
    simplify: bool = True
    coarsen: bool = False
    stop_energy: float = 10.0
    iterations: int = 80
    threads: int = 0

    def __post_init__(self) -> None:
        if not self.stop_energy >= 3:
            raise ValueError(f"stop_energy must be at least 3, that of a regular tetrahedron, not {self.stop_energy}")
        for name in ("iterations", "threads"):
            natural(getattr(self, name), name)


@dataclass(frozen=True, eq=False)
class VolumeMesh:
    """Tetrahedra with the parts that they fill, and boundary triangles with the faces that they are on.

    `points` (N, 3); `tetrahedra` (M, 4), each of positive volume `(b - a) x (c - a) . (d - a) / 6`;
    `regions` (M,) the numbers of their parts in `region_names`; `boundary` (B, 3) counterclockwise seen
    from outside; `faces` (B,) the numbers of their faces in `names`.
    """

    points: Floats
    tetrahedra: Integers
    regions: Integers
    region_names: tuple[str, ...]
    boundary: Integers
    faces: Integers
    names: tuple[str, ...]

    __repr__ = brief

    @property
    def volumes(self) -> Floats:
        """The volume of each tetrahedron (M,)."""
        return signed_volumes(self.points, self.tetrahedra)

    @property
    def volume(self) -> float:
        """The volume of all tetrahedra."""
        return float(self.volumes.sum())

    @property
    def region_volumes(self) -> dict[str, float]:
        """The volume of each part."""
        sums = np.bincount(self.regions, self.volumes, minlength=len(self.region_names))
        return dict(zip(self.region_names, sums.tolist(), strict=True))

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """A `pyvista.UnstructuredGrid` of the tetrahedra and after them the boundary triangles.

        `region` is -1 for triangles, `face` is -1 for tetrahedra.  The names are bytes, a line each (UTF-8),
        in the field arrays `region names` and `face names`: readers such as meshio refuse files with strings.
        """
        pyvista = optional("pyvista")
        cells = {
            pyvista.CellType.TETRA: self.tetrahedra.astype(int),
            pyvista.CellType.TRIANGLE: self.boundary.astype(int),
        }
        grid = pyvista.UnstructuredGrid(cells, self.points)
        grid.cell_data["region"] = np.concatenate([self.regions, np.full(len(self.boundary), -1)])
        grid.cell_data["face"] = np.concatenate([np.full(len(self.tetrahedra), -1), self.faces])
        grid.field_data["region names"] = _lines(self.region_names)
        grid.field_data["face names"] = _lines(self.names)
        return grid

    def write(self, path: str | Path) -> Path:
        """Write the mesh as .vtu (VTK) or .msh (Gmsh 2.2), whole or not at all; returns the path.

        Gmsh's physical groups are the faces and the parts, by name; VTK's arrays are `face` and
        `region`, -1 where a cell has none.  Raises `ValueError` for another suffix.
        """
        target(path, (".vtu", ".msh"), "tetrahedra")
        return Path(loaded("pas.exchange.write:write")(self, path))


@limited("filling a solid with tetrahedra", "a coarser tolerance or a larger edge_length")
def volume_mesh(
    shape: Solid | Mesh | Assembly,
    *,
    edge_length: Exact | None = None,
    tolerance: Exact | None = None,
    volume_tolerance: float = VOLUME_TOLERANCE,
    settings: VolumeSettings | None = None,
    **limits: Unpack[WorkLimits],
) -> VolumeMesh:
    """Fill a solid, a closed mesh or each part of an assembly with tetrahedra (fTetWild: Hu et al. 2020).

    `edge_length` (the model's units) is aimed at where the surface does not ask for less, by default a
    twentieth of the diagonal of the part's box; `VolumeSettings(coarsen=True)` gives larger tetrahedra.
    `tolerance` is that of `Solid.mesh`, and again how far the boundary may be from that mesh; the default
    is the solid's own, and a thousandth of the diagonal.

    Raises `ValueError` for numbers that cannot be, `GeometryError` for a mesh that is open, not finite or inside out
    and for a result that fails a check, `MissingLibraryError` without pytetwild, and what `Solid.mesh` raises.
    """
    length = None if edge_length is None else check_tolerance(edge_length, name="edge_length")
    within = None if tolerance is None else check_tolerance(tolerance)
    if not 0 < volume_tolerance < 1:
        raise ValueError(f"volume_tolerance must be between 0 and 1, not {volume_tolerance}")
    library(
        "pytetwild",
        "tetrahedra need pytetwild: pip install pytetwild (on a Mac there are ready packages for macOS 15 on Apple "
        "silicon; elsewhere it is built, with a compiler and CMake)",
    )
    parts = parts_of(shape, Request("solid", MeshSettings(within)))
    for part in parts:
        _require_fillable(part, length)
    filled = [_filled(p, length, within, volume_tolerance, settings or VolumeSettings()) for p in parts]
    return _together(parts, filled)


def tetrahedra_of(thing: Any, request: Request) -> VolumeMesh:
    """A volume mesh itself, else what fills a solid, a closed mesh or an assembly within the request's tolerance."""
    if not isinstance(thing, VolumeMesh):
        return volume_mesh(thing, tolerance=request.mesh.tolerance)
    if request.mesh.tolerance is not None:
        raise ValueError("tolerance is for solids; a mesh has it behind it")
    return thing


def is_filled(thing: Any) -> bool:
    """Whether it has tetrahedra already; to fill a body may take minutes, and may fail."""
    return isinstance(thing, VolumeMesh)


TETRAHEDRA: Content[VolumeMesh] = Content("tetrahedra", tetrahedra_of, ("tolerance",), is_filled)


def _together(parts: Sequence[Piece], filled: Sequence[VolumeMesh]) -> VolumeMesh:
    """The tetrahedra of all parts, with no point shared between parts."""
    points = [len(f.points) for f in filled]
    return VolumeMesh(
        np.concatenate([f.points for f in filled]),
        counted_on([f.tetrahedra for f in filled], points),
        np.repeat(np.arange(len(filled)), [len(f.tetrahedra) for f in filled]),
        tuple(p.name for p in parts),
        counted_on([f.boundary for f in filled], points),
        counted_on([f.faces for f in filled], [len(f.names) for f in filled]),
        tuple(face_names(parts)),
    )


def _require_fillable(part: Piece, edge_length: float | None) -> None:
    """Raise `GeometryError` for what fTetWild would take in silence, or crash on."""
    mesh, name = part.mesh, f"the mesh of {part.name!r}"
    if not len(mesh.triangles):
        raise GeometryError(f"{name} has no triangles")
    if not np.isfinite(mesh.points[mesh.triangles]).all():
        raise GeometryError(f"{name} has points that are not finite")
    if not mesh.is_closed:
        raise GeometryError(f"{name} is open or no manifold: each edge must have two triangles")
    if not mesh.volume > 0:
        raise GeometryError(f"{name} is inside out or flat: its volume is {mesh.volume:g}")
    number = 0 if edge_length is None else mesh.volume / (edge_length**3 * 2**0.5 / 12)
    if number > 2e7:  # which is a slip: they would not fit into memory
        raise ValueError(f"edge_length {edge_length:g} would give about {number:.0e} tetrahedra in {part.name!r}")


def _filled(
    part: Piece, edge_length: float | None, tolerance: float | None, volume_tolerance: float, settings: VolumeSettings
) -> VolumeMesh:
    """The tetrahedra of one part; raises `GeometryError` where they are not what they should be."""
    mesh = part.mesh
    used, triangles = np.unique(mesh.triangles, return_inverse=True)
    points, triangles = mesh.points[used], triangles.reshape(-1, 3)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    length = 1 / 20 if edge_length is None else edge_length / diagonal
    envelope = 1e-3 if tolerance is None else tolerance / diagonal
    found, tetrahedra = _tetrahedra((points - middle) / diagonal, triangles, length, envelope, settings)
    found = found * diagonal
    name = f"the tetrahedra of {part.name!r}"
    tetrahedra = _turned(found, tetrahedra, name)
    volume = float(signed_volumes(found, tetrahedra).sum())
    if abs(volume - mesh.volume) > volume_tolerance * mesh.volume:
        raise GeometryError(
            f"{name} have the volume {volume:.6g}, but their mesh encloses {mesh.volume:.6g}: it cuts itself, or is "
            "thin or finely curved for the tolerance; set a smaller tolerance, or a larger volume_tolerance"
        )
    boundary = _boundary(tetrahedra, name)
    regions = np.zeros(len(tetrahedra), dtype=int)
    surface = optional("pyvista").PolyData.from_regular_faces(mesh.points, mesh.triangles.astype(int))
    faces = mesh.faces[surface.find_closest_cell(found[boundary].mean(axis=1) + middle)]
    return VolumeMesh(found + middle, tetrahedra, regions, (part.name,), boundary, faces, mesh.names)


def _tetrahedra(
    points: Floats, triangles: Integers, length: float, envelope: float, settings: VolumeSettings
) -> tuple[Floats, Integers]:
    """The tetrahedra of fTetWild in a mesh of diagonal 1 (it crashes on very small ones), without unused points."""
    kept = {name: getattr(settings, name) for name in ("optimize", "simplify", "coarsen", "stop_energy")}
    others = {"num_opt_iter": settings.iterations, "num_threads": settings.threads, "quiet": True}
    found, tetrahedra = tetrahedralize(
        points, triangles, {**kept, **others, "edge_length_abs": length, "epsilon": envelope}
    )
    used, numbers = np.unique(np.asarray(tetrahedra, dtype=np.intp), return_inverse=True)
    return np.asarray(found, dtype=float).reshape(-1, 3)[used], numbers.reshape(-1, 4)


def tetrahedralize(points: Any, triangles: Any, options: Mapping[str, Any]) -> tuple[Any, Any]:
    """Points (N, 3) and tetrahedra (M, 4), of any orientation, in a closed mesh of about unit size.

    `options` are those of `pytetwild.tetrahedralize`.  Raises `GeometryError` where fTetWild fails or crashes.
    """
    given = np.asarray(points, dtype=float), np.asarray(triangles, np.int32)
    try:
        return elsewhere("fTetWild makes tetrahedra", "pytetwild:tetrahedralize", *given, **options)
    except subprocess.CalledProcessError as error:
        if error.returncode < 0:
            raise GeometryError(
                f"fTetWild crashed ({signal.Signals(-error.returncode).name}): the part is thinner than the "
                "tolerance, or its mesh cuts itself; set a smaller tolerance"
            ) from None
        lines = error.stderr.strip().splitlines() or ["no reason given"]
        raise GeometryError(f"fTetWild failed: {lines[-1]}") from None


def _turned(points: Floats, tetrahedra: Integers, name: str) -> Integers:
    """The tetrahedra with positive volumes; `GeometryError` where some are and some are not, or are flat."""
    if not len(tetrahedra):
        raise GeometryError(f"{name}: fTetWild found none; set a smaller tolerance")
    if not np.isfinite(points).all():
        raise GeometryError(f"{name} have points that are not finite")
    volumes = signed_volumes(points, tetrahedra)
    corners = points[tetrahedra]
    longest = np.max([((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i in range(4) for j in range(i)], axis=0)
    # good tetrahedra have 0.1 of the cube of the longest edge, poor ones 1e-4, and rounding leaves 1e-16
    flat = int((np.abs(volumes) <= 1e-10 * longest**1.5).sum())
    if flat:
        raise GeometryError(f"{name}: {flat} of {len(tetrahedra)} are flat; set another edge_length")
    negative = int((volumes < 0).sum())
    if negative == len(tetrahedra):
        return tetrahedra[:, [0, 2, 1, 3]]
    if negative:
        raise GeometryError(f"{name}: {negative} of {len(tetrahedra)} are inverted; set another edge_length")
    return tetrahedra


def _lines(names: Sequence[str]) -> Any:
    return np.frombuffer("\n".join(" ".join(n.split()) for n in names).encode("utf-8"), dtype=np.uint8)


def signed_volumes(points: Floats, tetrahedra: Integers) -> Floats:
    """The volumes (M,), negative for tetrahedra that are inverted."""
    return np.linalg.det(points[tetrahedra[:, 1:]] - points[tetrahedra[:, :1]]) / 6


def _boundary(tetrahedra: Integers, name: str) -> Integers:
    """The triangles of one tetrahedron only, turned outwards; `GeometryError` where they are no closed manifold."""
    outward = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))  # counterclockwise seen from outside
    triangles = np.concatenate([tetrahedra[:, corners] for corners in outward])
    _, first, times = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True, return_counts=True)
    boundary = triangles[first[times == 1]]
    if times.max() > 2 or not is_closed_manifold(boundary):
        raise GeometryError(
            f"{name} do not end in a closed manifold: parts of the boundary touch; "
            "set a smaller tolerance or edge_length"
        )
    return boundary
