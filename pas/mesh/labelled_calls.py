"""Compiled functions for meshes whose triangles carry labels: those of `pas.mesh.labelled`, `remesh` and `collapse`."""

from __future__ import annotations

import threading

import numpy as np
from numpy.typing import NDArray

from pas.kernels.library import Functions
from pas.mesh.field import Floats, Integers


class LabelledCalls:
    """Those of a compiled library; arrays are contiguous, numbers as large as pointers."""

    def __init__(self, functions: Functions) -> None:
        self._call = functions.call

    def labelled_edges(self, triangles: Integers, labels: Integers, size: int) -> tuple[Integers, Integers]:
        """See `pas.mesh.labelled.Topology.edge_table`."""
        count = len(triangles)
        edges, both = np.empty((2, 3 * count // 2, 2), dtype=np.intp)
        self._call("pas_labelled_edges", count, triangles, labels, size, room_for(6 * count + size + 1), edges, both)
        return edges, both

    def labelled_pairs(self, triangles: Integers, labels: Integers, size: int, span: int) -> tuple[Integers, Integers]:
        """The distinct `vertex * span + label`, sorted, and which of them each corner has (3 T,)."""
        count, number = len(triangles), np.empty(1, dtype=np.intp)
        keys, rows = np.empty((2, 3 * count), dtype=np.intp)
        room = room_for(3 * count + size + 1)
        self._call("pas_labelled_pairs", count, triangles, labels, size, span, room, keys, rows, number)
        return keys[: number[0]].copy(), rows

    def flipped_faces(
        self,
        points: Floats,
        triangles: tuple[Integers, Integers, Integers],
        normals: Floats,
        lines: tuple[NDArray[np.bool_], float] | None,
        near: NDArray[np.bool_] | None,
        passes: int,
    ) -> Integers | None:
        """The triangles, given with the rows of normals at their corners and their labels, after flips; None as before.

        See `pas.mesh.remesh.flip`.
        """
        result, rows, labels = (t.copy() for t in triangles)
        straight, limit = (None, 0.0) if lines is None else lines
        marked = np.zeros(len(points), dtype=bool) if near is None else near.copy()
        number = np.empty(1, dtype=np.intp)
        mesh = (len(result), result, rows, labels, len(points), room_for(6 * len(result) + len(points) + 1), points)
        limits = (straight, lines is not None, limit, marked, near is not None, passes)
        self._call("pas_flipped_faces", *mesh, normals, np.empty((len(result), 3)), *limits, number)
        return result if number[0] else None

    def cosines(self, points: Floats, triangles: Integers, rows: Integers, normals: Floats, chosen: Integers) -> Floats:
        """Those of chosen triangles, with the rows of normals at their corners; see `pas.mesh.remesh.cosines`."""
        result = np.empty(len(chosen))
        self._call("pas_cosines", len(chosen), chosen, triangles, rows, points, normals, result)
        return result

    def sizes(self, edges: Integers, lengths: Floats, seams: NDArray[np.bool_], size: int) -> Floats:
        """See `pas.mesh.labelled.Labelled.sizes`."""
        result, total = np.empty((2, size))
        self._call("pas_sizes", len(edges), edges, lengths, seams, size, room_for(size), total, result)
        return result

    def merged_faces(
        self,
        points: Floats,
        triangles: tuple[Integers, Integers, Integers],
        normals: Floats,
        edges: tuple[Integers, Integers],
        collapses: tuple[Integers, Integers],
        limits: tuple[Floats | None, Floats | None],
        least: tuple[float, float, float, int],
    ) -> NDArray[np.bool_]:
        """Which collapses, of vertices removed (K,) into those kept (K,), are done together (K,).

        The `triangles` are given with the rows of normals at their corners and their labels, the `edges` with the
        number of labels of each vertex.  See `pas.mesh.collapse`.
        """
        (most, slenderest), (every, labels), (removed, kept) = limits, edges, collapses
        mesh = (len(triangles[0]), *triangles, len(points), points, normals, len(every), every, labels)
        span = 0 if slenderest is None else slenderest.shape[1]
        chosen = np.empty(len(removed), dtype=bool)
        given = (len(removed), removed, kept, most, most is not None, slenderest, span)
        self._call("pas_merged_faces", *mesh, *given, *least, chosen)
        return chosen


class _Workspace(threading.local):
    """Room for numbers that is used again: fresh memory takes longer than what is done with it."""

    numbers: Integers = np.empty(0, dtype=np.intp)


_WORKSPACE = _Workspace()


def room_for(count: int) -> Integers:
    """Room for so many numbers, until it is asked for again by the same thread."""
    if len(_WORKSPACE.numbers) < count:
        _WORKSPACE.numbers = np.empty(count, dtype=np.intp)
    return _WORKSPACE.numbers
