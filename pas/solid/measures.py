"""Measures of solids: volume, area, centre and moments, of second order in the tolerance of their meshes.

All are sums over the boundary by the divergence theorem: of a homogeneous f of degree d, the integral over the solid is
that of f (x . n) over its boundary, over d + 3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pas.arrays import Floats, Integers
from pas.limits import checkpoint
from pas.mesh.field import FaceField
from pas.mesh.grading import LARGEST
from pas.mesh.halfedges import halved
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.projection import newton, pair_normals, placing, project
from pas.mesh.refusals import FaceMesh

_GAUSS = [
    (u, v, weight)
    for a, weight in ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))
    for u, v in ((a, a), (a, 1 - 2 * a), (1 - 2 * a, a))
]
"""Points and weights of the rule of degree 4 on the triangle (Dunavant 1985)."""

THIRD = 0.5
"""Third-order parts of long edges that stay, over those of edges as long as the tolerance makes them on other faces:
the errors of even triangles cancel, these do not."""


@dataclass(frozen=True, eq=False)
class Measures:
    """The measures of a body of density 1, in the model's units.

    `volume`, `area` of the boundary, `center` of mass (3,), and the `inertia` (3, 3) about that: moments of inertia
    about axes along x, y and z on the diagonal, products with their sign beside it.  `within` is the largest part by
    which one of them is off that of the flat triangles of the mesh, over its size: where faces are curved, these are of
    first order in the tolerance and the measures of second, so that their errors are far below it; where all are flat,
    both are exact up to rounding.
    """

    volume: float
    area: float
    center: Floats
    inertia: Floats
    within: float = 0.0

    @property
    def principal(self) -> tuple[Floats, Floats]:
        """The principal moments of inertia (3,), rising, and their axes (3, 3), unit vectors in the columns."""
        moments, axes = np.linalg.eigh(self.inertia)
        return moments, axes

    def scaled(self, scale: float, origin: Floats) -> Measures:
        """The measures of the image under x -> origin + scale x."""
        volume, area, inertia = self.volume * scale**3, self.area * scale**2, self.inertia * scale**5
        return Measures(volume, area, origin + scale * self.center, inertia, self.within)


def together(parts: Sequence[Measures]) -> Measures:
    """The measures of several bodies as one, each counted by itself where they overlap (Steiner's theorem)."""
    volume, area = (sum(getattr(part, name) for part in parts) for name in ("volume", "area"))
    center = sum((part.volume * part.center for part in parts), np.zeros(3)) / volume
    inertia = np.zeros((3, 3))
    for part in parts:
        away = part.center - center
        inertia += part.inertia + part.volume * (away @ away * np.eye(3) - np.outer(away, away))
    return Measures(volume, area, center, inertia, max(part.within for part in parts))


def flat_measures(mesh: Mesh) -> Measures:
    """The measures of a closed mesh's inside, up to rounding; raises `GeometryError` for one with edges."""
    corners, center = _centered(mesh.require_closed().points, mesh.triangles)
    return _integrated(corners, _middles(corners)).scaled(1.0, center)


class PartList(Mapping[str, Measures]):
    """The measures of parts by name; as a text a table with a row for each, and their sum."""

    def __init__(self, parts: Mapping[str, Measures]) -> None:
        self._parts = dict(parts)

    def __getitem__(self, name: str) -> Measures:
        return self._parts[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    @property
    def whole(self) -> Measures:
        """The measures of all parts as one."""
        return together([*self.values()])

    HEADS = ("part", "volume", "area", "center x", "y", "z", "inertia xx", "yy", "zz", "xy", "xz", "yz", "within")

    @property
    def rows(self) -> list[tuple[str | float, ...]]:
        """A row for each part, with the entries that `HEADS` names."""
        above = np.triu_indices(3, 1)
        return [
            (name, m.volume, m.area, *m.center.tolist(), *np.diag(m.inertia).tolist(), *m.inertia[above].tolist(),
             m.within)
            for name, m in self.items()
        ]  # fmt: skip

    def __str__(self) -> str:
        whole = {} if len(self) == 1 else {"all": self.whole}
        rows: list[tuple[str, ...]] = [self.HEADS[:9] + self.HEADS[-1:]]
        for row, m in zip(PartList({**self, **whole}).rows, [*self.values(), *whole.values()], strict=True):
            least = 1e-6 * m.area**0.5  # below the digits that are shown of the part's size
            center = (0.0 if abs(c) < least else c for c in m.center)
            rows.append((str(row[0]), *(f"{v:.6g}" for v in (*row[1:3], *center, *row[6:9])), f"{row[-1]:.1g}"))
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return "\n".join("  ".join(f"{v:<{w}}" for v, w in zip(row, widths, strict=True)).rstrip() for row in rows)


def curved_measures(found: FaceMesh, field: FaceField) -> Measures:
    """Measures of the mesh with its edges' midpoints moved onto the faces and curves.

    Each triangle becomes the quadratic patch through its corners and midpoints, so the errors fall
    with the fourth power of the edges: second order in the tolerance.  Long triangles of cones are cut until their
    edges are nearly as good as parabolas, which leaves errors of order 3/2.
    """
    mesh = _cut(found, field)
    edges = mesh.topology.edges
    middles = mesh.points[edges].mean(axis=1)
    for rows, functions in placing(field, mesh.topology.edge_labels):
        middles[rows] = newton(middles[rows], field, functions, mesh.lengths[rows])
    size = mesh.topology.size
    keys = edges @ np.array([size, 1])
    corners, center = _centered(mesh.points, mesh.triangles)
    sides = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = mesh.triangles[:, i], mesh.triangles[:, j]
        sides.append(middles[np.searchsorted(keys, np.minimum(a, b) * size + np.maximum(a, b))] - center)
    curved, flat = _integrated(corners, sides), _integrated(corners, _middles(corners))
    sizes = (curved.volume, curved.area, float(np.ptp(mesh.points, axis=0).max()), float(np.trace(curved.inertia)))
    off = (np.abs(getattr(curved, n) - getattr(flat, n)).max() for n in ("volume", "area", "center", "inertia"))
    within = max(float(some) / size for some, size in zip(off, sizes, strict=True))
    return replace(curved.scaled(1.0, center), within=within)


def _centered(points: Floats, triangles: Integers) -> tuple[list[Floats], Floats]:
    """The corners of triangles relative to the middle of all points, and that."""
    center = points.mean(axis=0)
    return [points[triangles[:, i]] - center for i in range(3)], center


def _middles(corners: Sequence[Floats]) -> list[Floats]:
    return [(corners[i] + corners[j]) / 2 for i, j in ((0, 1), (1, 2), (2, 0))]


def _integrated(corners: Sequence[Floats], sides: Sequence[Floats]) -> Measures:
    """Measures of what quadratic patches enclose, by their corners and the middles of their sides, (T, 3) each."""
    volume = area = 0.0
    first, second = np.zeros(3), np.zeros((3, 3))
    for u, v, weight in _GAUSS:
        w = 1 - u - v
        shape = (w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * u * w, 4 * u * v, 4 * v * w)
        by_u = (1 - 4 * w, 4 * u - 1, 0.0, 4 * (w - u), 4 * v, -4 * v)
        by_v = (1 - 4 * w, 0.0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v))
        nodes = (*corners, *sides)
        x, du, dv = (sum(c * n for c, n in zip(f, nodes, strict=True)) for f in (shape, by_u, by_v))
        normal = np.cross(du, dv)
        flux = weight / 2 * np.einsum("ni,ni->n", x, normal)
        volume += float(flux.sum()) / 3
        area += weight / 2 * float(np.linalg.norm(normal, axis=1).sum())
        first += flux @ x / 4
        second += np.einsum("n,ni,nj->ij", flux, x, x) / 5
    center = first / volume
    about = second - volume * np.outer(center, center)
    return Measures(volume, area, center, np.trace(about) * np.eye(3) - about)


def _cut(found: FaceMesh, field: FaceField) -> Labelled:
    """The mesh with edges along curved faces with straight lines halved whose third-order parts are not small.

    A parabola's chord makes the same angles with the curve at both ends, so by the normals there these parts are known.
    They may be `THIRD` times as large as those of edges as long as the tolerance makes them on other faces; edges are
    halved 12 times at most.  In apexes, where there is no normal, patches of a size are off by the deviation in as much
    of the volume as their size cubed.
    """
    mesh, extent = found.mesh, float(np.ptp(field.box, axis=0).max())
    most, apex = THIRD * found.deviation**1.5 / extent**0.5, (found.deviation * extent**2) ** (1 / 3)
    for _ in range(12):
        edges, labels = mesh.topology.edge_table
        normals, off = pair_normals(mesh, field), np.zeros(len(edges))
        along = mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
        for column in labels.T:
            rows = mesh.topology.rows(edges, column[:, None])
            third = np.abs((along * (normals[rows[:, 0]] + normals[rows[:, 1]])).sum(axis=1)) / 8
            singular = (np.abs(normals[rows]).max(axis=2).min(axis=1) == 0) & (mesh.lengths > apex)
            third[singular] = np.inf
            off = np.maximum(off, np.where(field.ruled(column) == 1, third, 0.0))
        off[mesh.topology.seam_mask] = 0.0
        if not (off > most).any() or len(mesh.triangles) > LARGEST / 4:
            break
        checkpoint(f"cutting long triangles ({len(mesh.triangles)} triangles)")
        finer = halved(mesh, np.flatnonzero(off > most))
        mesh = project(finer, field, finer.sizes, np.arange(len(mesh.points), len(finer.points)))
    return mesh
