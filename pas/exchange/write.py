"""Files for other programs: one verb for everything, the format by the suffix.

| suffix | holds     | parts          | faces            | colours          | normals          | numbers |
|--------|-----------|----------------|------------------|------------------|------------------|---------|
| .stl   | triangles | put together   | no               | no               | of the facets    | single  |
| .obj   | triangles | objects        | groups           | of the vertices  | of the corners   | double  |
| .ply   | triangles | `part`         | `face`           | of both          | of smooth meshes | double  |
| .3mf   | triangles | named objects  | no               | of the objects   | no               | single  |
| .glb   | triangles | named nodes    | no               | materials        | of the points    | single  |
| .vtp   | triangles | `part`, names  | `face`, names    | `color`          | of the points    | double  |
| .step  | patches   | faces          | no               | no               | exact            | double  |
| .vtu   | cells     | `region`       | `face`           | no               | no               | double  |
| .msh   | cells     | groups         | groups           | no               | no               | double  |

Guaranteed: a file is written whole or not at all; triangles, their order within a part and their orientation are
those of the shape's `mesh`; .obj, .ply and .3mf keep closed meshes closed (.glb and .vtp double the points of sharp
edges, .stl has no points to share).  Not guaranteed: that single precision tells apart points of a small solid far
from the origin, and that parts put together in one .stl are apart: no boolean is taken.  The unit is said where the
format can say it; no number is changed for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from pas.exchange.files import replacing, target
from pas.exchange.formats import FORMATS, Request, suffixes_of
from pas.limits import Report, checkpoint, limited
from pas.parametric.domain import DomainLike
from pas.shape import Shape

if TYPE_CHECKING:
    from pas.exchange.volume import VolumeMesh

Writable: TypeAlias = "Shape | VolumeMesh | Sequence[Shape]"
"""What can be written, each in the formats that hold such."""

CLOSED = {".3mf": "; a blend's solid can, see `pas convert` and blend.solid()"}
"""Formats for closed bodies only, and what to do for a surface."""


@limited("writing a file", "a coarser tolerance")
def write(
    thing: Writable,
    path: str | Path,
    *,
    tolerance: float | None = None,
    domain: DomainLike = None,
    unit: str = "millimeter",
    sew: float | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """Write a shape, a mesh, an assembly or a list of such for other programs; returns the path.

    The suffix says how (see `pas.exchange.formats.FORMATS`): triangles are those of the shape's `mesh(tolerance)`, a
    parametric surface's over `domain`; .step has the exact patches of surfaces and blends that have them, joined
    where they are within the distance `sew` (the model's units, as of `tolerance`); .vtu the cells of a piecewise
    surface, .vtu and .msh the tetrahedra of a volume mesh, or such as fill a solid.
    `unit` is micrometer, millimeter, centimeter, meter, inch or foot.

    Raises `ValueError` for another suffix or unit, a folder that does not exist and options that say nothing of such
    files, `TypeError` for what no such file holds, `MissingLibraryError` where a package for the format is absent,
    and what meshing raises.
    """
    check_suffix(path)
    return _written(thing, path, tolerance=tolerance, domain=domain, unit=unit, sew=sew)


def check_suffix(path: str | Path) -> str:
    """The suffix of a file that `write` can write; raises what `pas.exchange.files.target` raises."""
    return target(path, tuple(FORMATS), "a shape")


def _written(thing: Writable, path: str | Path, **options: Any) -> Path:
    place = Path(path)
    format_ = FORMATS[place.suffix.lower()]
    request = Request(place.stem, **options)
    format_.check(request)
    content = format_.content.of(thing, request)
    with replacing(place) as temporary:
        checkpoint(f"writing {place.name}")
        format_.write(content, temporary, request)
    return place


@limited("writing a mesh", "a coarser tolerance")
def write_mesh(
    shape: Shape | Sequence[Shape],
    path: str | Path,
    *,
    tolerance: float | None = None,
    domain: DomainLike = None,
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """`write` for triangles of surfaces and meshes within `tolerance` (the model's units); returns the path.

    Raises what that raises.
    """
    check_mesh_suffix(path)
    return _written(shape, path, tolerance=tolerance, domain=domain)


def check_mesh_suffix(path: str | Path) -> str:
    """The suffix of a file of a surface's triangles; raises what `pas.exchange.files.target` raises."""
    return target(path, tuple(s for s in suffixes_of("triangles") if s not in CLOSED), "a mesh", CLOSED)


@limited("writing a solid", "a coarser tolerance")
def write_solid(
    shape: Shape | Sequence[Shape],
    path: str | Path,
    *,
    tolerance: float | None = None,
    unit: str = "millimeter",
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """`write` for triangles of solids, assemblies and their meshes within `tolerance` (the model's units).

    Returns the path, and raises what that raises.
    """
    target(path, suffixes_of("triangles"), "a solid")
    return _written(shape, path, tolerance=tolerance, unit=unit)


@limited("writing a STEP file", "fewer patches")
def write_step(
    patches: Shape | Sequence[Shape],
    path: str | Path,
    *,
    domain: DomainLike = None,
    sew: float | None = None,
    unit: str = "millimeter",
    seconds: float | None = None,
    progress: Report | None = None,
) -> Path:
    """`write` for patches, exact surfaces and exact blends as the faces of a STEP file; returns the path.

    A surface or a blend is one face for each of its `bezier_patches` over `domain` (by default its own; see
    `ParametricSurface.mesh`); `fit_patch` makes patches of what is not exact.  With `sew`, faces whose sides are
    within that distance (the model's units) are joined to shells, and a shell that is closed becomes a solid.

    Raises `ValueError` for another suffix or unit, no patches, a degree above HIGHEST_DEGREE or a surface that is not
    exact or has an infinite domain, `TypeError` for what is no patch, surface or blend, `GeometryError` for a patch
    that Open Cascade refuses or a surface with a pole, `MissingLibraryError` without Open Cascade.
    """
    target(path, suffixes_of("patches"), "STEP")
    return _written(patches, path, domain=domain, sew=sew, unit=unit)


def write_cells(surface: Shape, path: str | Path) -> Path:
    """`write` for the cells of a piecewise surface, with their polynomials, as a .vtu file; returns the path.

    The arrays are those of `pas.exchange.formats.vtu.cell_grid`.  Raises what `write` raises.
    """
    target(path, (".vtu",), "cells")
    return _written(surface, path)


def write_volume(mesh: VolumeMesh, path: str | Path) -> Path:
    """`write` for tetrahedra with their boundary; returns the path."""
    target(path, (".vtu", ".msh"), "tetrahedra")
    return _written(mesh, path)
