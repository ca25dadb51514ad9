"""GLB and VTP of all triangles, 3MF of closed bodies, VTU and MSH of cells, STEP of exact faces, each by a library.

What they hold is said by `pas.exchange.write`.  GLB (binary glTF), by trimesh: what stands in many places is one mesh,
of which the node of its part has a child for each.  Lengths are meters (glTF 2.0, 3.4); the unit of the numbers is
written as the scene's extras.  VTP (VTK's XML of polygons), by pyvista: points have `parameters` where all parts are
meshes of parametric surfaces.

3MF, by lib3mf, which takes single precision.  Guaranteed: each part is an object of its own in the file's build, of the
type "surface" where it is open (3MF core 1.3, 4.1); what stands in many places is written once, as components of one
object.

VTU (VTK's XML of cells), by pyvista: the tetrahedra of a volume, or a piecewise surface's cells with polynomials; and
Gmsh's .msh of tetrahedra, version 2.2, by meshio, with parts and faces as physical groups.  A polynomial of degree n is
given on its tetrahedron by its values at the nodes `(i a + j b + k c + l d) / n`, `i + j + k + l = n`, which is
VTK_LAGRANGE_TETRAHEDRON of degree n.  Bezier cells would be shorter, but VTK contours their coefficients as if they
were values.  Guaranteed: points and values are the exact ones, rounded once; the nodes stand in VTK's order; the
B-coefficients go with them.  Not guaranteed: that a contour by another program is on the surface (programs cut the
cells into flat ones first); `PiecewiseSurface.mesh` is.  Cells share no points, since each has its own polynomial.
"""

from __future__ import annotations

import ctypes
import json
import re
import struct
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from pas.algebra.monomials import homogeneous_exponents
from pas.arrays import Floats
from pas.errors import library, optional
from pas.exchange.formats import Content, Format, Request
from pas.exchange.parts import (
    FACES,
    PLACED,
    TRIANGLES,
    Piece,
    all_different,
    face_numbers,
    in_unit,
    is_closed,
    repeated_colors,
)
from pas.exchange.volume import TETRAHEDRA, VolumeMesh, is_filled, tetrahedra_of
from pas.limits import checkpoint
from pas.mesh.rows import counted_on
from pas.piecewise import PiecewiseSurface
from pas.registry import loaded
from pas.shape import Shape, kind_of
from pas.surface.function import Cell


def write_glb(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts as a scene, in meters if the model has a unit."""
    import trimesh

    parts, told = in_unit(parts, request, "meter"), "meter" if request.unit else request.told_unit
    names = [p.name for p in parts]
    scene: Any = trimesh.Scene(metadata={"unit": told}, base_frame=all_different([*names, "root"], "_")[-1])
    for part in parts:
        checkpoint()
        scene.add_geometry(part.mesh.to_trimesh(), node_name=part.name, geom_name=part.name)

    def paint(tree: dict[str, Any]) -> None:
        tree["materials"] = [_material(p) for p in parts]
        for mesh in tree["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["material"] = names.index(mesh["name"])

    checkpoint()
    data = scene.export(file_type="glb", include_normals=True, tree_postprocessor=paint)
    places = {part.name: part.places for part in parts if part.places is not None}
    with path.open("wb") as stream:
        stream.writelines(_placed(data, places) if places else [data])


def _placed(data: bytes, places: dict[str, Floats]) -> list[bytes]:
    """A binary scene (glTF 2.0, 4.4) whose nodes of some names have a child for each place: one text, as objects of
    Python would take ten times the memory."""
    size = int.from_bytes(data[12:16], "little")
    tree = json.loads(data[20 : 20 + size])
    nodes = tree.pop("nodes")
    text, children, count = [json.dumps(tree)[:-1].encode() + b', "nodes": ['], list[bytes](), len(nodes)
    for node in nodes:
        shifts = places.get(node["name"], np.zeros((0, 3)))
        if not len(shifts):
            text.append(json.dumps(node).encode() + b",")
            continue
        mesh, numbers = node.pop("mesh"), ",".join(map(str, range(count, count + len(shifts))))
        text.append(f'{json.dumps(node)[:-1]},"children":[{numbers}]}},'.encode())
        count += len(shifts)
        children += _each(f'{{"mesh":{mesh},"translation":[%.9g,%.9g,%.9g]}},', shifts)
    text += children
    text[-1] = text[-1].rstrip(b",") + b"]}"
    text.append(b" " * (-sum(map(len, text)) % 4))
    length, rest = sum(map(len, text)), data[20 + size :]
    return [struct.pack("<4sIII4s", b"glTF", 2, 20 + length + len(rest), length, b"JSON"), *text, rest]


def _each(line: str, places: Floats) -> Iterator[bytes]:
    """A line with the numbers of each place (M, 3), many at a time."""
    for some in np.array_split(places, 1 + len(places) // 4096):
        yield (line * len(some) % tuple(some.ravel().tolist())).encode()


def _material(part: Piece) -> dict[str, Any]:
    """A material of glTF, in which colours are linear, not those of screens (sRGB, IEC 61966-2-1)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (c / 255 for c in part.color)]
    surface = {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6}
    return {"name": part.name, "pbrMetallicRoughness": surface}


GLB = Format(".glb", PLACED, write_glb)


def write_vtp(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts put together."""
    pyvista = optional("pyvista")
    checkpoint()  # that library takes long to load
    shading = [p.mesh.shading for p in parts]
    checkpoint()
    triangles = counted_on([s[1] for s in shading], [len(s[0]) for s in shading]).astype(int)
    data = pyvista.PolyData.from_regular_faces(np.concatenate([s[0] for s in shading]), triangles)
    data.point_data.active_normals = np.concatenate([s[2] for s in shading])
    parameters = [p.mesh.parameters[p.mesh.shading_points] for p in parts if p.mesh.parameters is not None]
    if len(parameters) == len(parts):
        data.point_data["parameters"] = np.concatenate(parameters)
    numbers, names = face_numbers(parts)
    counts = [len(s[1]) for s in shading]
    data.cell_data["face"], data.cell_data["part"] = numbers, np.repeat(np.arange(len(parts)), counts)
    data.cell_data["color"] = repeated_colors(parts, counts)
    data.field_data["face names"] = np.array(names)
    data.field_data["part names"] = np.array([p.name for p in parts])
    data.field_data["unit"] = np.array([request.told_unit])
    checkpoint()
    data.save(path)


VTP = Format(".vtp", TRIANGLES, write_vtp)


def write_step(content: Sequence[Any], path: Path, request: Request) -> Sequence[Any] | None:
    """See `pas.exchange.step.writing`; raises `MissingLibraryError` here, for what a shape lacks is said before."""
    library("OCP.STEPControl", "STEP files need Open Cascade: pip install 'pas[step]'")
    return loaded("pas.exchange.step.writing:write_faces")(content, path, request)


STEP: Format[Any] = Format(".step", FACES, write_step, limits=lambda _: find_spec("OCP") is not None)


def require_lib3mf() -> Any:
    """The module lib3mf; raises `MissingLibraryError` without it."""
    return library(
        "lib3mf",
        "3MF files need lib3mf: pip install lib3mf (Linux on Arm has no ready packages; .stl, .obj, .ply, .glb and "
        ".vtp need nothing more)",
    )


def three_mf_unit(name: str) -> Any:
    """The unit of lib3mf that has this name in `UNITS`."""
    return {unit.name.lower(): unit for unit in require_lib3mf().ModelUnit}[name]


def write_3mf(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts."""
    lib3mf = require_lib3mf()
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(three_mf_unit(request.told_unit))
    together, identity = None, wrapper.GetIdentityTransform()
    for part in parts:
        checkpoint()
        item = model.AddMeshObject()
        item.SetType(lib3mf.ObjectType.Model if part.mesh.is_closed else lib3mf.ObjectType.Surface)
        item.SetName(part.name)
        points, triangles = part.mesh.points, part.mesh.triangles
        item.SetGeometry(records(lib3mf.Position, points, "<f4"), records(lib3mf.Triangle, triangles, "<u4"))
        group = model.AddColorGroup()
        item.SetObjectLevelProperty(group.GetResourceID(), group.AddColor(wrapper.RGBAToColor(*part.color, 255)))
        if part.places is None:
            model.AddBuildItem(item, identity)
            continue
        if together is None:
            together = model.AddComponentsObject()
            together.SetName(request.name)
            model.AddBuildItem(together, identity)
        together.AddComponent(item, identity)
    checkpoint()
    writer = model.QueryWriter("3mf")
    writer.SetDecimalPrecision(9)  # its usual six would round a part of a few units visibly
    save_3mf(writer, path)
    if together is not None:
        _put_components(path, [part.places for part in parts if part.places is not None])


def _put_components(path: Path, places: Sequence[Floats]) -> None:
    """Write a component for each place instead of the one of each part, as text: objects take four times as long; and
    without the random names of the production extension, which would be most of the file."""
    with ZipFile(BytesIO(path.read_bytes())) as before, ZipFile(path, "w", ZIP_DEFLATED) as after:
        for entry in before.infolist():
            unnamed = re.sub(rb' (p:UUID|xmlns:p)="[^"]*"', b"", before.read(entry))
            text, *others = re.split(rb'<component objectid="(\d+)"[^>]*/>', unnamed)
            entry.extra = b""  # where the time is
            with after.open(entry, "w") as stream:
                stream.write(text)
                for number, rest, shifts in zip(others[::2], others[1::2], places if others else (), strict=True):
                    line = f'<component objectid="{int(number)}" transform="1 0 0 0 1 0 0 0 1 %.9g %.9g %.9g"/>\n'
                    stream.writelines(_each(line, shifts))
                    stream.write(rest)


def save_3mf(writer: Any, path: Path) -> None:
    """Write what a writer of lib3mf has by a stream of Python: on a full disk its own one ends the process."""
    lib3mf, failed = require_lib3mf(), list[OSError]()
    with path.open("wb") as stream:

        def attempt(write: Callable[[], Any]) -> None:
            try:
                write()
            except OSError as error:
                failed.append(error)

        writer.WriteToCallback(
            lib3mf.WriteCallback(lambda data, count, _: attempt(lambda: stream.write(ctypes.string_at(data, count)))),
            lib3mf.SeekCallback(lambda place, _: attempt(lambda: stream.seek(place))),
            None,
        )
    if failed:
        raise failed[0]


def records(kind: Any, rows: Any, number: Any) -> Any:
    """Rows of numbers of some type as an array of structures."""
    return (kind * len(rows)).from_buffer_copy(np.ascontiguousarray(rows, dtype=number))


THREE_MF = Format(".3mf", PLACED, write_3mf, require_lib3mf, is_closed, bodies=True, closed=True)


def _piecewise(thing: Any) -> PiecewiseSurface | None:
    find = kind_of(thing).piecewise if isinstance(thing, Shape) else None
    return None if find is None else find(thing)


def grid_of(thing: Any, request: Request) -> Any:
    """The `pyvista.UnstructuredGrid` of a thing: its cells where it is piecewise, else tetrahedra that fill it."""
    surface = _piecewise(thing)
    return tetrahedra_of(thing, request).to_pyvista() if surface is None else cell_grid(surface)


def has_cells(thing: Any) -> bool:
    """Whether a thing has cells already."""
    surface = _piecewise(thing)
    return is_filled(thing) if surface is None else bool(surface.partition.cells)


def cell_grid(surface: PiecewiseSurface) -> Any:
    """The cells of a surface as a `pyvista.UnstructuredGrid`.

    Point data `f` (N,) has the values, negative inside.  Cell data `piece` has the numbers of the
    polynomials and `b_coefficients` (C, (n+1)(n+2)(n+3)/6) the B-coefficients, whose multi-indices, one a
    row, are the field data `b_indices`.  Raises `ValueError` for a surface without cells.
    """
    pyvista = optional("pyvista")
    if not surface.cells:
        raise ValueError("the surface has no cells: give its region a box, as in pas.SingleCell(lower, upper)")
    degree = max(surface.degree, 1)
    nodes = node_indices(degree)
    points = [_node(cell, index) for cell in surface.cells for index in nodes]
    polynomials = [cell.polynomial for cell in surface.cells for _ in nodes]
    size, number = len(nodes), len(surface.cells)
    connectivity = np.concatenate(
        [np.full((number, 1), size), np.arange(number * size).reshape(number, size)], axis=1, dtype=int
    )
    types = np.full(number, pyvista.CellType.LAGRANGE_TETRAHEDRON, dtype=np.uint8)
    grid = pyvista.UnstructuredGrid(connectivity.ravel(), types, np.array(points, dtype=float))
    grid.point_data["f"] = np.array([float(p.at(x)) for p, x in zip(polynomials, points, strict=True)])
    grid.cell_data["piece"] = np.asarray(surface.partition.piece_of, dtype=int)
    indices = homogeneous_exponents(surface.degree, 4)
    coefficients = [[float(cell.b_coefficients[i]) for i in indices] for cell in surface.cells]  # type: ignore[index]
    grid.cell_data["b_coefficients"] = np.array(coefficients).reshape(number, -1)
    grid.field_data["b_indices"] = np.array(indices)
    return grid


def node_indices(degree: int) -> list[tuple[int, int, int, int]]:
    """The multi-indices of the nodes of VTK's Lagrange tetrahedron, in its order.

    They refer to the corners of the cell as they are numbered; VTK itself puts the first corner last.
    """
    from vtkmodules.vtkCommonDataModel import vtkHigherOrderTetra

    result = []
    for node in range((degree + 1) * (degree + 2) * (degree + 3) // 6):
        index = [0, 0, 0, 0]
        vtkHigherOrderTetra.BarycentricIndex(node, index, degree)
        result.append((index[3], index[0], index[1], index[2]))
    return result


def _node(cell: Cell, index: tuple[int, int, int, int]) -> tuple[Fraction, ...]:
    """The exact point of a multi-index."""
    weights = [Fraction(i, sum(index)) for i in index]
    return tuple(
        sum((w * v[axis] for w, v in zip(weights, cell.vertices, strict=True)), Fraction(0)) for axis in range(3)
    )


def write_vtu(grid: Any, path: Path, request: Request) -> None:
    """The grid with its arrays."""
    grid.save(path)


VTU: Format[Any] = Format(".vtu", Content("cells", grid_of, ("tolerance",), has_cells), write_vtu, unitless=True)


def write_msh(mesh: VolumeMesh, path: Path, request: Request) -> None:
    """In version 2.2, which every reader knows; faces are groups 1 to F, parts F + 1 onwards."""
    import meshio

    faces = len(mesh.names)
    tags = [(mesh.faces + 1).astype(np.int32), (mesh.regions + 1 + faces).astype(np.int32)]
    plain = (" ".join(name.replace('"', "'").split()) for name in (*mesh.names, *mesh.region_names))
    names = all_different(plain, " ")  # a part may be named as a face
    groups = {name: np.array([i + 1, 2 if i < faces else 3]) for i, name in enumerate(names)}
    meshio.Mesh(
        mesh.points,
        [("triangle", mesh.boundary), ("tetra", mesh.tetrahedra)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=groups,
    ).write(path, file_format="gmsh22", binary=False)


MSH = Format(
    ".msh", TETRAHEDRA, write_msh, lambda: library("meshio", "files of Gmsh need meshio: pip install meshio"),
    unitless=True,
)  # fmt: skip
