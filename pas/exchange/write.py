"""Files for other programs: one verb for everything, the format by the suffix.

| suffix | holds     | parts          | faces            | colours          | normals          | numbers |
|--------|-----------|----------------|------------------|------------------|------------------|---------|
| .stl   | triangles | put together   | no               | no               | of the facets    | single  |
| .obj   | triangles | objects        | groups           | of the vertices  | of the corners   | double  |
| .ply   | triangles | `part`         | `face`           | of both          | of smooth meshes | double  |
| .3mf   | triangles | named objects  | no               | of the objects   | no               | single  |
| .glb   | triangles | named nodes    | no               | materials        | of the points    | single  |
| .vtp   | triangles | `part`, names  | `face`, names    | `color`          | of the points    | double  |
| .step  | faces     | named solids   | unnamed          | of the parts     | exact            | double  |
| .vtu   | cells     | `region`       | `face`           | no               | no               | double  |
| .msh   | cells     | groups         | groups           | no               | no               | double  |
| .csv   | measures  | rows           | no               | no               | no               | double  |

Guaranteed: a file is written whole or not at all; triangles, their order within a part and their orientation are
those of the shape's `mesh`; .obj, .ply and .3mf keep closed meshes closed (.glb and .vtp double the points of sharp
edges, .stl has no points to share).  Not guaranteed: that single precision tells apart points of a small solid far
from the origin, and that parts put together in one .stl are apart: no boolean is taken.

`unit` says which unit the model's lengths are in.  Files that can tell a unit tell it, and keep the numbers (.obj,
.ply, .3mf, .vtp, .step; without `unit` they tell millimeters; .csv); in .stl files, whose numbers are taken for
millimeters, and in .glb files, whose numbers are meters, the numbers become those, and without `unit` they stay; .vtu
and .msh files have no unit and refuse one.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias, Unpack

from pas.algebra.inputs import check_flag
from pas.algebra.rational import Exact
from pas.exchange.files import replacing, target
from pas.exchange.formats import FORMATS, Request, suffixes_of
from pas.exchange.parts import require_closed
from pas.exchange.volume import VolumeMesh
from pas.limits import WorkLimits, checkpoint, limited, note
from pas.parametric.maps import DomainLike
from pas.settings import MeshSettings
from pas.shape import Shape

Writable: TypeAlias = "Shape | VolumeMesh | Sequence[Shape]"
"""What can be written, each in the formats that hold such."""


@limited("writing a file", "a coarser tolerance")
def write(
    thing: Writable,
    path: str | Path,
    *,
    tolerance: Exact | None = None,
    domain: DomainLike = None,
    unit: str | None = None,
    sew: float | None = None,
    open: bool = False,
    **limits: Unpack[WorkLimits],
) -> Path:
    """Write a shape, a mesh, an assembly or a list of such for other programs; returns the path.

    The suffix says how (see `pas.exchange.formats.FORMATS`): triangles are those of the shape's `mesh(tolerance)`, a
    parametric surface's over `domain`; .step has the faces of solids, exact where they are planes, quadrics or tori
    and else splines within `tolerance` (by default a tenth of that of meshes), and the exact patches of surfaces and
    blends that have them, joined where they are within the distance `sew` (the model's units, as of `tolerance`);
    .vtu the cells of a piecewise surface, .vtu and .msh the tetrahedra of a volume mesh, or such as fill a solid.
    `unit`, that of the model, is micrometer, millimeter, centimeter, meter, inch, foot, or um, mm, cm, m, in, ft: files
    record it, the numbers of .stl files become millimeters, those of .glb files meters.
    Files of .stl, .obj and .3mf are taken for closed bodies: surfaces with edges are written there if `open` says so.

    Raises `ValueError` for another suffix or unit, a folder that does not exist, options that say nothing of such files
    and a surface with edges where a body is meant, `TypeError` for what no such file holds, `MissingLibraryError` where
    a package for the format is absent, and what meshing raises.
    """
    mesh = MeshSettings(tolerance, domain=domain)  # type: ignore[arg-type]  # which reads it
    write_as(thing, path, mesh, unit=unit, sew=sew, open=check_flag(open, "open"))
    return Path(path)


def write_as(thing: Writable, path: str | Path, mesh: MeshSettings, **options: Any) -> list[Any]:
    """`write` by settings of the mesh; `options` are the others of a `Request`.

    Returns what the format tells of the parts (of STEP a `StepReport` each), one line of text each, as told to
    `progress`.
    """
    others = {".json": "; `save` writes project files (.pas.json)", ".png": "; `draw` makes pictures"}
    target(path, tuple(FORMATS), "a shape", others)
    place = Path(path)
    format_ = FORMATS[place.suffix.lower()]
    request = Request(place.stem, mesh, **options)
    format_.check(request)
    content = format_.content.of(thing, request)
    if format_.bodies and not request.open:
        require_closed(thing, content, place.name)
    with replacing(place) as temporary:
        checkpoint(f"writing {place.name}")
        reports = list(format_.write(content, temporary, request) or ())
    for report in reports:
        note(str(report))
    return reports


def check_open(path: str | Path) -> str:
    """The suffix of a file that holds surfaces with edges as triangles; raises what `target` raises."""
    hint = "; a blend's solid can, see `pas convert` and blend.solid()"
    triangles = suffixes_of("triangles")
    closed = {suffix: hint for suffix in triangles if FORMATS[suffix].closed}
    return target(path, tuple(s for s in triangles if s not in closed), "a mesh", closed)


def write_mesh(shape: Writable, path: str | Path, **options: Any) -> Path:
    """`write` with `open=True`, its name of the first versions for surfaces with edges; raises what `write` raises."""
    return write(shape, path, open=True, **options)


write_solid = write_step = write_cells = write
"""Names of the first versions, when there was a verb for each sort of files."""
