"""Points projected onto the faces of a solid, their curves and corners, by Newton's method with the shortest steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pas.arrays import Floats, Integers
from pas.limits import checkpoint
from pas.mesh.field import FaceField, HasJets, OneFunction, extent_of
from pas.mesh.labelled import Labelled
from pas.mesh.rows import cross, dots, norms, off_zero
from pas.mesh.shading import normal_cosines, unit_rows
from pas.mesh.topology import numbered

NEWTON_STEPS = 16
NEARBY = 8
"""How many times the reach of one step a corner may move."""

PARALLEL, WELL_APART, PEAKED = 1e-6, 1e-6, 1e-4
"""Ratio of singular values below which gradients count as parallel; squared sine of the angle between two, and volume
that three of length 1 span, above which their inverse is written down, with the same bits on every machine."""


def distances(field: HasJets, points: Floats, labels: int | Integers) -> Floats:
    """Distances (N,) of points (N, 3) from the zeros of a function, or of their own ones (N,), given as labels, to
    first order."""
    jets = field.jets(points, labels)
    return off_zero(jets[:, 0], jets[:, 1:])


@dataclass(frozen=True, eq=False)
class CommonZeros:
    """Some functions by number, as Newton's method wants them."""

    functions: Sequence[OneFunction]

    def jets(self, points: Floats, labels: int | Integers) -> Floats:
        """Values and gradients (N, 4) at points (N, 3) of one function, whose number stands once or N times."""
        return self.functions[int(np.max(labels, initial=0))].jets(points)

    def placed(self, points: Floats, reach: float = 0.05, steps: int = NEWTON_STEPS) -> Floats:
        """Points (N, 3) moved to where all functions are zero, none further than `reach` a step: by default that of a
        box in local coordinates, which is of size 1."""
        return newton(points, self, range(len(self.functions)), np.full(len(points), reach), steps)


def second_derivatives(field: FaceField, points: Floats, labels: Integers) -> Floats:
    """Second derivatives (N, 3, 3) of functions given as labels (N,) at points (N, 3), by differences."""
    slope_step = 1e-5  # of the differences that give second derivatives, over the extent of the box
    apart = slope_step * extent_of(field)
    around = points[:, None] + apart * np.concatenate([np.eye(3), -np.eye(3)])
    slopes = field.jets(around.reshape(-1, 3), np.repeat(labels, 6))[:, 1:].reshape(-1, 2, 3, 3)
    result = (slopes[:, 0] - slopes[:, 1]) / (4 * apart)
    return np.asarray(result + result.transpose(0, 2, 1))


def grouped(rows: Integers, span: int) -> list[tuple[Integers, Integers]]:
    """The distinct rows of numbers from -1 to span - 2, and where each stands."""
    key = np.zeros(len(rows), dtype=np.intp)
    for column in rows.T:
        key = key * span + column + 1
    inverse = numbered(key)[1]
    parts = np.split(np.argsort(inverse, kind="stable"), np.cumsum(np.bincount(inverse))[:-1])
    return [(rows[part[0]], part) for part in parts if len(part)]


def placing(field: FaceField, labels: Integers) -> Iterator[tuple[Integers, Integers]]:
    """Rows (n,) of labels (N, k), filled up with -1, and the functions (n, m) that determine such vertices, by m."""
    found: dict[int, list[tuple[Integers, Integers]]] = {}
    for row, at in grouped(labels, int(labels.max(initial=0)) + 2):
        placed = field.functions(tuple(int(v) for v in row if v >= 0))
        found.setdefault(len(placed), []).append((at, np.tile(np.array(placed, dtype=np.intp), (len(at), 1))))
    for number, parts in sorted(found.items()):
        if number:
            rows, functions = zip(*parts, strict=True)
            yield np.concatenate(rows), np.concatenate(functions)


def pair_normals(mesh: Labelled, field: FaceField) -> Floats:
    """Unit outward normals (P, 3) of each vertex's faces; zero at singular points."""
    if mesh.normals is not None:
        return mesh.normals
    vertices, labels = mesh.topology.pairs.T
    return unit_rows(field.jets(mesh.points[vertices], labels)[:, 1:])


def project(mesh: Labelled, field: FaceField, reach: Floats, chosen: Integers | None = None) -> Labelled:
    """Vertices, or chosen ones, moved onto their faces, curves and corners; none further than `reach` (N,) a step."""
    points = mesh.points.copy()
    chosen = np.arange(len(points)) if chosen is None else chosen
    points[chosen] = onto_faces(points[chosen], mesh.topology.vertex_labels[chosen], field, reach[chosen])
    return Labelled(points, mesh.topology)


def onto_faces(points: Floats, labels: Integers, field: FaceField, reach: Floats) -> Floats:
    """Points (N, 3) moved to where faces of labels (N, k), filled up with -1, meet; none further than `reach` a step.

    A corner of faces that have no point in common nearby stays: they come closer than the mesh shows.
    """
    points, corner = points.copy(), (labels >= 0).sum(axis=1) > 2
    for rows, functions in placing(field, labels):
        start, most = points[rows], reach[rows]
        end = newton(start, field, functions, most)
        at = np.flatnonzero(corner[rows])
        rest = norms(least_norm(field, functions[at], end[at]))
        lost = at[(rest > 1e-9 * most[at]) | (norms(end[at] - start[at]) > NEARBY * most[at])]
        end[lost] = start[lost]
        points[rows] = end
    return points


def newton(
    points: Floats, field: HasJets, functions: Integers | Sequence[int], reach: Floats, steps: int = NEWTON_STEPS
) -> Floats:
    """Points (N, 3) moved to the common zeros of functions, given as labels, (m,) for all or each one's own (N, m).

    None moves further than `reach` (N,) a step.
    """
    points, functions = points.copy(), np.broadcast_to(functions, (len(points), np.shape(functions)[-1]))
    active = np.arange(len(points))
    for _ in range(steps):
        checkpoint()
        step = -least_norm(field, functions[active], points[active])
        length = norms(step)[:, None]
        points[active] += step * np.minimum(1.0, reach[active, None] / np.maximum(length, 1e-300))
        active = active[length[:, 0] > 1e-14 * (1 + np.abs(points[active]).max(axis=1))]
        if not len(active):
            break
    return points


def least_norm(field: HasJets, functions: Integers | Sequence[int], points: Floats) -> Floats:
    """The shortest steps (N, 3), to first order, from the common zeros of functions to points.

    Functions are given as labels, (m,) for all points or (N, m).
    """
    each = np.broadcast_to(np.asarray(functions, dtype=np.intp), (len(points), np.shape(functions)[-1]))
    jets = [field.jets(points, column) for column in each.T]
    if len(jets) == 1:
        values, gradient = jets[0][:, :1], jets[0][:, 1:]
        return values * gradient / np.maximum(dots(gradient, gradient)[:, None], 1e-300)
    values = np.stack([j[:, 0] for j in jets], axis=1)
    matrix = np.stack([j[:, 1:] for j in jets], axis=1)
    size = np.maximum(np.stack([norms(m) for m in matrix.transpose(1, 0, 2)], axis=1), 1e-300)
    matrix, values = matrix / size[..., None], values / size
    if len(jets) > 3:
        return least_solutions(matrix, values)
    if len(jets) == 3:
        a, b, c = matrix.transpose(1, 0, 2)
        sides = cross(b, c), cross(c, a), cross(a, b)
        volume = dots(a, sides[0])
        total = sum(value[:, None] * side for value, side in zip(values.T, sides, strict=True))
        result, flat = total / np.where(volume != 0, volume, 1.0)[:, None], np.abs(volume) < PEAKED
    else:
        cosine = dots(matrix[:, 0], matrix[:, 1])[:, None]
        square = 1 - cosine * cosine
        u, v = values.T[..., None]
        result = ((u - cosine * v) * matrix[:, 0] + (v - cosine * u) * matrix[:, 1]) / np.maximum(square, 1e-300)
        flat = square[:, 0] < WELL_APART
    result[flat] = least_solutions(matrix[flat], values[flat])
    return np.asarray(result)


def least_solutions(matrices: Floats, right: Floats, parallel: float = PARALLEL) -> Floats:
    """The shortest solutions (N, k), in least squares, of systems (N, m, k) with right sides (N, m); not numbers where
    those are none.  Singular values below a share of the largest count as 0."""
    result = np.full((len(right), matrices.shape[2]), np.nan)
    rows = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(right).all(axis=1)
    result[rows] = np.einsum("nij,nj->ni", np.linalg.pinv(matrices[rows], rcond=parallel), right[rows])
    return result


def cosines(mesh: Labelled, field: FaceField) -> Floats:
    """The cosine between each triangle's normal and the sum of its face's at the corners (T,)."""
    return normal_cosines(mesh.points[mesh.triangles], pair_normals(mesh, field)[mesh.topology.corner_pairs])
