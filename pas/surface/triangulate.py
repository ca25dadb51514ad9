"""From polynomials on cells to a triangle mesh within a tolerance.

The cells are cut, where the surface passes, until its function rises all along one direction in nearly all parts, then
contoured; the triangles of that are coarsened and graded by curvature (see `pas.mesh.remesher`).

Looked at on the result, not proved: that it is a manifold without folds, within the tolerance, that ends on the walls
and shows all curves on which it must end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from pas.algebra.inputs import shown_point
from pas.arrays import Floats, Integers
from pas.errors import GeometryError, MeshError
from pas.limits import checkpoint
from pas.mesh.contour import crossings, knotted, oriented, snapped
from pas.mesh.field import VISIBLE
from pas.mesh.grading import Settings
from pas.mesh.labelled import Labelled
from pas.mesh.mesh import Mesh
from pas.mesh.shading import normal_cosines, unit_rows
from pas.mesh.topology import Edges, euler_characteristic, is_manifold, piece_count
from pas.surface.fairness import fairness
from pas.surface.function import PiecewisePolynomial
from pas.surface.lattice import Subdivision
from pas.surface.local_field import LocalField
from pas.surface.sheet import BadMeshError, open_mesh, remeshed

LEAST, FINEST = 2, 8
"""Halvings of the cells, at least and at most."""

BENT = 0.02
"""Share of the tetrahedra in which the function may turn for a lattice that is tried."""

MANY = 150_000
"""Tetrahedra beyond which a lattice is not refined further."""

SNAPS = 0.42, 0.2, 0.0
"""Shares of an edge within which crossings merge, tried in turn on each lattice, but for those whose merging would
change the topology; where there are some all on walls stay apart as well."""

MORE = 0.4
"""Added to the number of parts into which edges of the first triangles are cut, before that is rounded down: these may
be a little coarser than those of a star, which rays have to see all of."""


def triangulate(beginnings: Beginnings, tolerance: float, settings: Settings) -> Mesh:
    """A mesh in the user's coordinates whose distance from the surface is at most `tolerance`, measured.

    Raises `MeshError` where there is no surface, where no good mesh of it is found, or where the tolerance needs more
    triangles than the settings allow.
    """
    why, settings, field = "", replace(settings, more=MORE), beginnings.field
    for first, singular in beginnings:
        try:
            if isinstance(first, ArithmeticError):
                raise first
            return remeshed(field, first, tolerance, settings)
        except ArithmeticError as error:
            why = f"no good mesh was found: {error}{_trouble(field, error, singular)}"
    if not why:
        raise MeshError("there is no surface in the region: the function does not change sign")
    raise MeshError(f"{why}{_sharpest(field.surface)}")


Beginning = tuple[Labelled | ArithmeticError, Floats]
"""The first mesh on a lattice, or why there is none; and where the surface may be singular, a point or none (K, 3)."""


class Beginnings:
    """The first meshes of a surface on lattices, each finer than the one before: found when asked for, and kept."""

    def __init__(self, field: LocalField) -> None:
        self.field = field
        self._found: list[Beginning] = []
        self._parts, self._ended = 1, False  # of the next lattice at least; whether there is none

    def __iter__(self) -> Iterator[Beginning]:
        attempts = 3  # lattices, each twice as fine as the one before, that are tried in vain
        for number in range(attempts):
            if number == len(self._found):
                self._look()
            if number == len(self._found):
                return
            yield self._found[number]

    def _look(self) -> None:
        """Look for the next; the lattices are not kept, which are large."""
        cells = Subdivision(self.field)
        while len(cells.forms) and not self._ended:
            self._ended = cells.parts >= 1 << FINEST or 8 * len(cells.forms) > MANY
            if cells.parts >= max(self._parts, 1 << LEAST):
                bent, hidden = cells.bent()
                # Tetrahedra among which each that may hide a component is cut further; with more, some may be missed.
                searched = 20_000
                plain = len(bent) <= BENT * len(cells.forms) and (not hidden or len(cells.forms) > searched)
                grid = cells.lattice if plain or self._ended else None
                if grid is not None and len(grid[2]):
                    try:
                        first: Labelled | ArithmeticError = _first(self.field, *grid)
                    except ArithmeticError as error:
                        first = error.with_traceback(None)
                    self._found.append((first, bent[:1]))
                    self._parts = 2 * cells.parts
                    return
            if not self._ended:
                cells.halve()
        self._ended = True


def _trouble(field: LocalField, error: ArithmeticError, singular: Floats) -> str:
    """Where a mesh was bad, and what may help."""
    if len(singular):
        return f"; the surface may be singular, or very thin, near {_place(field, singular[0])}"
    if not isinstance(error, BadMeshError):
        return ""
    return f" near {_place(field, error.place)}; walls of the region that the surface does not graze there may help"


def _sharpest(surface: PiecewisePolynomial) -> str:
    """Where a surface bends much more than its neighbours, and what makes room, in words."""
    sharp = 10.0  # times the neighbours' curvature beyond which a surface's own is named where it cannot be meshed
    try:
        fair = fairness(surface)
    except GeometryError:
        return ""
    if not fair.sharpness > sharp:
        return ""
    return (
        f"; near {shown_point(fair.sharpest)} it is {fair.sharpness:.3g} times as sharp as its neighbours, and clips "
        'that are farther out, as clip="auto" finds them, leave more room'
    )


def _place(field: LocalField, point: Floats) -> str:
    """A point as the user reads it, without the digits of zeros."""
    return shown_point(0.0 if abs(v) < VISIBLE * field.scale else v for v in field.world(point))


def _first(field: LocalField, nodes: Floats, values: Floats, tetrahedra: Integers) -> Labelled:
    negative = values < 0
    ends, triangles = crossings(negative, tetrahedra)
    a, b = ends.T
    share = values[a] / (values[a] - values[b])
    crossed = nodes[a] + share[:, None] * (nodes[b] - nodes[a])
    plain = oriented(nodes, negative, ends, crossed, triangles)
    wanted = _topology(plain)
    for snap in SNAPS:
        checkpoint("contouring")
        free = knotted(plain, ends, share, snap, len(negative))
        if free.any():
            free[ends[Edges(plain, len(ends)).rim]] = True  # near walls merged crossings may leave the region
        points, triangles, _ = snapped(crossed, plain, ends, share, snap, free)
        if not len(triangles) or not is_manifold(triangles) or _topology(triangles) != wanted:
            continue
        rim = wall_numbers(field, points, triangles)
        inner = rim < 0
        points[~inner] = field.on_rims(points[~inner], rim[~inner])
        points[inner] = field.near(points[inner])
        if not field.within(points):
            continue
        upright = normal_cosines(points[triangles], unit_rows(field.gradients(points))[triangles])
        # Share of folded triangles, and of those without area, that coarsening and smoothing may have to mend.
        folds = 0.03
        if np.mean(~(upright >= Settings.folded)) <= folds and _shows_curves(field, points[~inner]):
            return open_mesh(field, points, triangles, rim)
    upright = normal_cosines(crossed[plain], unit_rows(field.gradients(crossed))[plain])
    place = crossed[plain[np.argmin(upright)]].mean(axis=0)
    raise BadMeshError("triangles are folded, or where the surface ends is not seen", place)


def _topology(triangles: Integers) -> tuple[int, int]:
    """The number of components, and Euler's characteristic."""
    return piece_count(triangles), euler_characteristic(triangles)


def wall_numbers(field: LocalField, points: Floats, triangles: Integers) -> Integers:
    """The walls (N,), or the ends of curves between two of them, on which points are; -1 inside."""
    edges = Edges(triangles, len(points))
    result = np.full(len(points), -1)
    walls = field.nearest_walls(points[edges.rim].mean(axis=1))
    before, after = np.full((2, len(points)), -1)
    after[edges.rim[:, 0]], before[edges.rim[:, 1]] = walls, walls
    result[edges.rim[:, 0]] = walls
    numbers = {pair: field.walls + i for i, pair in enumerate(field.edges)}
    for v in np.flatnonzero(before != after).tolist():
        pair = (int(min(before[v], after[v])), int(max(before[v], after[v])))
        if pair not in numbers:
            raise BadMeshError("a curve on which the surface ends leaves its wall where there is no edge", points[v])
        result[v] = numbers[pair]
    return result


def _shows_curves(field: LocalField, ends: Floats) -> bool:
    """Whether each curve on which the surface must end is near the mesh's boundary (K, 3) all along."""
    if not len(ends):
        return not field.curves
    tree = cKDTree(ends)
    return all(tree.query(curve)[0].max(initial=0.0) < 2 * field.feature_size for curve in field.curves)
