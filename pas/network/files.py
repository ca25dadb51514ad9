"""Graphs of struts in files.

| suffix | what is in it                                                          | read | written |
|--------|------------------------------------------------------------------------|------|---------|
| .npz   | arrays `points` (N, 3), `edges` (E, 2), and `radii` (E,), (E, 2) or one | yes  | yes     |
| .csv   | a strut a line: x, y, z of its ends, and its radius or the radii of both; titles may be on top | yes | yes |
| .obj   | `v` and `l` lines, without radii                                       | yes  | no      |
| .3mf   | a beam lattice (3MF beam lattice extension 1.2), radii of its beams    | yes  | yes     |

Numbers of files are rounded to the grid as points of a network are; radii are taken as the decimals that they are.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from pas.algebra.rational import Exact
from pas.arrays import Floats
from pas.errors import ProblemFileError
from pas.exchange.files import read_text, replacing, source, target
from pas.exchange.formats import Request
from pas.exchange.formats.libraries import records, require_lib3mf, save_3mf, three_mf_unit
from pas.network.graph import StrutGraph

MOST_BYTES = 1 << 30
"""The most bytes of a file of text."""


GraphArrays = tuple[Any, Any, Any]
"""Points (N, 3), edges (E, 2), and one radius or one for each strut, or None."""


def read(path: str | Path, radius: Exact | None = None) -> GraphArrays:
    """The graph of a file; the `radius`, where given, is that of all struts, whatever the file says.

    Raises `ValueError` for another suffix, `ProblemFileError` for a file that holds no such graph, naming the line, or
    one without radii where none is given, `FileNotFoundError`.
    """
    file = source(path)
    reader = READERS.get(file.suffix.lower())
    if reader is None:
        raise ValueError(f"a network is read from one of {', '.join(READERS)}, not from {file.name}")
    if not file.exists():
        raise FileNotFoundError(f"No such file or directory: {file}")
    points, edges, radii = reader(file)
    if radius is None and radii is None:
        raise ProblemFileError(f"{file.name} has no radii; give radius=")
    return points, edges, radii if radius is None else radius


def _read_npz(file: Path) -> GraphArrays:
    try:
        with np.load(file) as arrays:
            radii = arrays["radii"].tolist() if "radii" in arrays else None
            return arrays["points"], arrays["edges"], radii
    except (KeyError, ValueError, OSError) as error:
        raise ProblemFileError(f"{file.name} has not the arrays points and edges: {error}") from None


def _read_csv(file: Path) -> GraphArrays:
    rows: list[tuple[float, ...]] = []
    radii: list[list[str]] = []
    for number, line in enumerate(csv.reader(read_text(file, MOST_BYTES, ProblemFileError).splitlines()), start=1):
        if not line:
            continue
        try:
            x, y, z, u, v, w = map(float, line[:6])
        except ValueError:
            if number == 1:
                continue
            said = f"{file.name}, line {number}: a strut is x, y, z of both ends and its radius, not {','.join(line)!r}"
            raise ProblemFileError(said, number) from None
        rows.append((x, y, z, u, v, w))
        given = [value.strip() for value in line[6:8]]
        radii += [given * (2 // len(given))] if given else []
    if len(radii) not in (0, len(rows)):
        raise ProblemFileError(f"{file.name}: {len(radii)} of {len(rows)} struts have a radius; give all of them one")
    points, edges = np.unique(np.array(rows).reshape(-1, 3), axis=0, return_inverse=True)
    return points, edges.reshape(-1, 2), radii or None


def _read_obj(file: Path) -> GraphArrays:
    points, edges = [], []
    for number, line in enumerate(read_text(file, MOST_BYTES, ProblemFileError).splitlines(), start=1):
        word, *rest = line.split() or [""]
        try:
            if word == "v":
                points.append([float(c) for c in rest[:3]])
            elif word == "l":
                ends = [int(c.partition("/")[0]) for c in rest]
                ends = [end - 1 if end > 0 else len(points) + end for end in ends]
                edges += list(pairwise(ends))
        except ValueError:
            said = f"{file.name}, line {number}: {line.strip()!r} is no point or line"
            raise ProblemFileError(said, number) from None
    return np.array(points).reshape(-1, 3), np.array(edges, dtype=np.int64).reshape(-1, 2), None


def _read_3mf(file: Path) -> GraphArrays:
    wrapper = require_lib3mf().get_wrapper()
    model = wrapper.CreateModel()
    try:
        model.QueryReader("3mf").ReadFromFile(str(file))
    except Exception as error:
        raise ProblemFileError(f"{file.name} is no 3MF file: {error}") from None
    objects = model.GetMeshObjects()
    while objects.MoveNext():
        found = objects.GetCurrentMeshObject()
        beams = found.BeamLattice().GetBeams()
        if beams:
            points = np.array([tuple(vertex.Coordinates) for vertex in found.GetVertices()])
            edges = np.array([tuple(beam.Indices) for beam in beams], dtype=np.int64)
            return points, edges, [[str(np.float32(r)) for r in beam.Radii] for beam in beams]
    raise ProblemFileError(f"{file.name} has no beam lattice")


READERS: dict[str, Callable[[Path], GraphArrays]] = {
    ".npz": _read_npz, ".csv": _read_csv, ".obj": _read_obj, ".3mf": _read_3mf,
}  # fmt: skip


def write(network: StrutGraph, path: str | Path, unit: str | None = None) -> Path:
    """Write a graph; returns the path.  `unit` is the model's, which only .3mf files tell.

    Raises `ValueError` for another suffix, unit or folder, `MissingLibraryError` without lib3mf.
    """
    suffix = target(path, tuple(WRITERS), "a network", {".stl": "; its body is written by network.blend().write"})
    request = Request(Path(path).stem, unit=unit)
    with replacing(path) as temporary:
        WRITERS[suffix](network, temporary, request)
    return Path(path)


def _write_npz(network: StrutGraph, path: Path, request: Request) -> None:
    with path.open("wb") as stream:
        np.savez_compressed(stream, points=network.points, edges=network.edges, radii=_written_radii(network))


def _written_radii(network: StrutGraph) -> Floats:
    """The radii of struts (E,), or (E, 2) where some have others at their two ends."""
    return network.thickness if network.even else network.widths


def _write_csv(network: StrutGraph, path: Path, request: Request) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        rows = np.column_stack([network.points[network.edges].reshape(-1, 6), _written_radii(network)])
        radii = ["radius"] if network.even else ["radius1", "radius2"]
        writer.writerow(["x1", "y1", "z1", "x2", "y2", "z2", *radii])
        writer.writerows(rows.tolist())


def _write_3mf(network: StrutGraph, path: Path, request: Request) -> None:
    lib3mf = require_lib3mf()
    model = lib3mf.get_wrapper().CreateModel()
    model.SetUnit(three_mf_unit(request.told_unit))
    item = model.AddMeshObject()
    item.SetName(request.name)
    item.SetGeometry(records(lib3mf.Position, network.points, "<f4"), [])
    beams = np.zeros(len(network.edges), dtype=[("ends", "<u4", 2), ("radii", "<f8", 2), ("caps", "<i4", 2)])
    beams["ends"], beams["radii"] = network.edges, network.widths
    item.BeamLattice().SetBeams(records(lib3mf.Beam, beams, beams.dtype))
    model.AddBuildItem(item, lib3mf.get_wrapper().GetIdentityTransform())
    save_3mf(model.QueryWriter("3mf"), path)


WRITERS: dict[str, Callable[[StrutGraph, Path, Request], None]] = {
    ".npz": _write_npz, ".csv": _write_csv, ".3mf": _write_3mf,
}  # fmt: skip
