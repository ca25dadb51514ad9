"""A mesh whose triangles carry labels, as half edges that are split, flipped and collapsed, and whose vertices move.

Open meshes of one surface have one label and boundary curves; closed ones of a solid have a label for each face, and
curves between labels.  Compiled code changes the arrays, which are numpy's (see `pas/kernels/halfedge.h`); what must be
measured on the surface is asked for in between (see `pas.mesh.remesher`).

Half edge 3 t + k leads from corner k of triangle t to the next.  Guaranteed: splits, flips and collapses keep the
topology, labels and curves.  Not guaranteed: that triangles do not cross one another.
"""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pas.arrays import AnyArray, Bools, Floats, Integers
from pas.kernels.library import address_of, compiled
from pas.mesh.labelled import Labelled
from pas.mesh.rows import norms
from pas.mesh.topology import numbered

TURNED = 0.5
"""Cosine between a triangle and the normals at its corners that flips keep, or do not make worse."""

PASSES = 12
"""Flips at most, over the number of triangles."""


class VertexKind:
    """Where a vertex is: inside a face, on a curve, or in a corner, where it stays as those do that are pinned.

    Plain numbers, as numpy compares arrays with members of an enumeration several times as slowly.
    """

    INSIDE, CURVE, CORNER, PINNED = range(4)


def following(halves: Integers) -> Integers:
    """The next half edges in the triangles of some (K,)."""
    return np.asarray(np.where(halves % 3 == 2, halves - 2, halves + 1))


class _Array:
    """An array attribute: so many columns for each vertex, triangle, half edge or wedge that there is."""

    def __init__(self, kind: type, of: str, columns: int = 1, times: int = 1) -> None:
        self.kind, self.of, self.columns, self.times, self.name = kind, of, columns, times, ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, mesh: HalfEdges, owner: type) -> AnyArray:
        return mesh.arrays[self.name][: getattr(mesh._struct, self.of) * self.times]  # not `count`: it is asked often


class HalfEdges:
    """The mesh; `faces` are the kinds of its labels, 0 for bent ones, 1 for ruled ones and 2 for planes."""

    points = _Array(np.float64, "vertices", 3)
    sizes = _Array(np.float64, "vertices")
    caps = _Array(np.float64, "vertices")
    normals = _Array(np.float64, "wedges", 3)
    bends = _Array(np.float64, "wedges")
    corners = _Array(np.intp, "triangles", times=3)
    twins = _Array(np.intp, "triangles", times=3)
    wedge_of = _Array(np.intp, "triangles", times=3)
    labels = _Array(np.intp, "triangles")
    vertex_of = _Array(np.intp, "wedges")
    face_of = _Array(np.intp, "wedges")
    outgoing = _Array(np.intp, "vertices")
    marks = _Array(np.intp, "vertices")
    kinds = _Array(np.int8, "vertices")
    fresh = _Array(np.bool_, "vertices")

    def __init__(self, first: Labelled, faces: NDArray[np.int8]) -> None:
        triangles, labels = first.triangles, first.labels
        if labels.min(initial=0) < 0 or labels.max(initial=-1) >= len(faces):
            raise ValueError("labels must be numbers of faces")
        self.faces = np.ascontiguousarray(faces, dtype=np.int8)
        self._struct = _Struct()
        self.arrays: dict[str, AnyArray] = {}
        twins = first.topology.twins
        if twins.min(initial=0) < -1:
            raise ArithmeticError("some edge does not have one or two triangles")
        self._struct.vertices, self._struct.triangles = len(first.points), len(triangles)
        self.reserve(0, 0, 0)
        self.points[:], self.corners[:], self.twins[:], self.labels[:] = first.points, triangles.ravel(), twins, labels
        if first.topology.rims is not None:
            open_ = np.flatnonzero(twins < 0)
            self.twins[open_] = -1 - np.maximum(first.topology.rims.ravel()[open_], 0)
        self.marks[:], self.fresh[:], self.caps[:], self.kinds[:] = 0, True, np.inf, VertexKind.INSIDE
        self.kinds[first.topology.pinned] = VertexKind.PINNED
        self._call("pas_mesh_classify")
        span = int(labels.max(initial=0)) + 1
        wedge_of, vertex_of = self.corners, np.arange(len(first.points))
        face_of = np.zeros_like(vertex_of)
        if span > 1 or self.outgoing.min(initial=0) < 0:  # some vertex is not one wedge
            pairs, wedge_of = numbered((triangles * span + labels[:, None]).ravel())
            vertex_of, face_of = pairs // span, pairs % span
        self._struct.wedges = len(vertex_of)
        self.reserve(0, 0, 0)
        self.wedge_of[:], self.vertex_of[:], self.face_of[:], self.normals[:] = wedge_of, vertex_of, face_of, 0.0

    def count(self, of: str) -> int:
        """How many vertices, triangles or wedges there are."""
        return int(getattr(self._struct, of))

    def reserve(self, vertices: int, triangles: int, wedges: int) -> None:
        """Reserve room for more vertices, triangles and wedges."""
        more = {"vertices": vertices, "triangles": triangles, "wedges": wedges}
        total = {of: self.count(of) + number for of, number in more.items()}
        for name, array in _ARRAYS.items():
            needed = total[array.of] * array.times
            old = self.arrays.get(name)
            if old is None or len(old) < needed:
                room = needed + needed // 2  # of which what is not needed costs nothing
                new: AnyArray = np.empty((room, 3) if array.columns == 3 else room, dtype=array.kind)
                if old is not None:
                    new[: len(old)] = old
                self.arrays[name] = new
                setattr(self._struct, name, address_of(new))
        self._struct.faces = address_of(self.faces)

    def _call(self, name: str, *arguments: AnyArray | float) -> None:
        compiled().call(name, ctypes.addressof(self._struct), *arguments)

    def _filled(self, name: str, *shape: int) -> Floats:
        result = np.empty(shape)
        self._call(name, result)
        return result

    @property
    def triangles(self) -> Integers:
        """The triangles as vertex numbers (T, 3)."""
        return self.corners.reshape(-1, 3)

    @property
    def ends(self) -> Integers:
        """Where half edges end (3 T,)."""
        return self.triangles[:, [1, 2, 0]].ravel()

    @property
    def on_curves(self) -> Bools:
        """Which half edges (3 T,) are on the boundary or between two labels."""
        own = np.repeat(self.labels, 3)
        return np.asarray((self.twins < 0) | (own != self.labels[self.twins // 3]))

    @property
    def boundary(self) -> tuple[Integers, Integers]:
        """The half edges (B,) without a twin, and the numbers of their curves (B,)."""
        rows = np.flatnonzero(self.twins < 0)
        return rows, -1 - self.twins[rows]

    def rims_of(self, halves: Integers) -> Integers:
        """The numbers of the boundary curves (K,) on which half edges are, -1 inside."""
        return np.maximum(-1 - self.twins[halves], -1)

    def labels_at(self, vertices: Integers) -> Integers:
        """The labels (K,) about vertices inside faces."""
        return self.labels[self.outgoing[vertices] // 3]

    def labels_about(self, vertices: Integers) -> Integers:
        """The labels about vertices (K, k), ascending, then -1."""
        times = np.bincount(self.vertex_of, minlength=len(self.points))[vertices]
        width = max(int(times.max(initial=1)), 2)
        result = np.empty((len(vertices), width), dtype=np.intp)
        self._call("pas_mesh_labels_about", len(vertices), vertices, width, result)
        return result

    @property
    def cosines(self) -> Floats:
        """The cosines (T,) between triangles and the normals at their corners."""
        return self._filled("pas_mesh_cosines", len(self.labels))

    @property
    def fresh_sines(self) -> Floats:
        """The sines (T,) of the smallest angles of triangles with a fresh corner; infinite of others."""
        return self._filled("pas_mesh_sines", len(self.labels))

    def lengths(self, halves: Integers) -> Floats:
        """The lengths (K,) of half edges."""
        return norms(self.points[self.corners[following(halves)]] - self.points[self.corners[halves]])

    @property
    def ratios(self) -> Floats:
        """The ratios (3 T,) of half edges to their target lengths."""
        return self._filled("pas_mesh_ratios", len(self.corners))

    def bend(self) -> None:
        """Estimate the curvatures of wedges from the turn of normals along edges."""
        self._call("pas_mesh_bends")

    def size(self, parts: float, fine: float, longest: float, bent: float, grade: float) -> None:
        """Set the target lengths of edges for a tolerance `fine` after a cut into parts, by curvature and limits."""
        self._call("pas_mesh_sizes", parts, fine, longest, bent, grade)

    def size_plainly(self) -> None:
        """Set the target lengths to the mean lengths of edges at vertices, on all faces."""
        self._call("pas_mesh_mean_sizes")

    @property
    def plain(self) -> bool:
        """Whether ruled faces are treated as others for now."""
        return bool(self._struct.plain)

    @plain.setter
    def plain(self, value: bool) -> None:
        self._struct.plain = value

    def split(self, halves: Integers) -> None:
        """Split half edges (K,) in this order, each edge given once; the new vertices are the last."""
        ends = np.stack([self.corners[halves], self.corners[following(halves)]], axis=1)
        self.reserve(len(halves), 2 * len(halves), 2 * len(halves))
        self._call("pas_mesh_split", len(halves), halves, ends)

    def flip(self, limit: float = np.inf, only_fresh: bool = False) -> None:
        """Flip edges, of all or at fresh vertices, towards Delaunay's criterion, on ruled faces towards the face."""
        self._call("pas_mesh_flip", TURNED, float(limit), int(only_fresh), PASSES)

    def collapse(
        self, halves: Integers, longer: float, kept: float, flat: tuple[float, float, float], off: float = 1.0
    ) -> int:
        """Collapse half edges (K,) in this order, or their twins, where the mesh stays good; returns their number.

        See `Limits` in `pas/kernels/edits.c`.
        """
        done = np.empty(1, dtype=np.intp)
        held = 0.8  # cosine between triangles on ruled faces, which may be long, and the normals, which collapses keep
        self._call("pas_mesh_collapse", len(halves), halves, np.array([longer, kept, held, off, *flat]), done)
        if done[0]:
            self._call("pas_mesh_pack")
        return int(done[0])

    @property
    def targets(self) -> Floats:
        """Positions (V, 3) of vertices smoothed in tangent planes and along curves."""
        return self._filled("pas_mesh_targets", len(self.points), 3)

    def settle(self, points: Floats, normals: Floats, bends: Floats | None) -> None:
        """Take new positions, normals and curvatures, except at vertices of triangles that would be turned over."""
        given = np.empty(0) if bends is None else bends
        self._call("pas_mesh_settle", points, normals, given, int(bends is not None), TURNED)

    def middles(self, rows: Integers, halves: Integers) -> Floats:
        """The centres of triangles and the middles of half edges, (K + H, 3)."""
        result = np.empty((len(rows) + len(halves), 3))
        self._call("pas_mesh_middles", len(rows), rows, len(halves), halves, result)
        return result

    def better(self, aim: float, vertices: Integers) -> tuple[Integers, Floats]:
        """Some of the given vertices that are fresh, and positions (K, 3) where their triangles are less slender."""
        chosen, places = np.empty(len(vertices), dtype=np.intp), np.empty((len(vertices), 3))
        number = np.empty(1, dtype=np.intp)
        self._call("pas_mesh_better", aim, len(vertices), vertices, chosen, places, number)
        return chosen[: number[0]], places[: number[0]]

    def stars(self, vertices: Integers) -> tuple[Integers, Integers]:
        """The triangles (K,) about vertices, and the number of the vertex that each is about (K,)."""
        room, number = 8 * len(vertices), np.empty(1, dtype=np.intp)
        while True:
            rows, owners = np.empty((2, room), dtype=np.intp)
            self._call("pas_mesh_stars", len(vertices), vertices, room, rows, owners, number)
            if number[0] <= room:
                return rows[: number[0]], owners[: number[0]]
            room = int(number[0])

    def move(self, vertices: Integers, places: Floats, normals: Floats, good: Bools, aim: float) -> int:
        """Put vertices inside faces, if they are good, at places, where triangles get less slender; how many."""
        moved = np.empty(1, dtype=np.intp)
        self._call("pas_mesh_move", len(vertices), vertices, places, normals, good, aim, TURNED, moved)
        return int(moved[0])

    def cut(self, parts: int) -> HalfEdges:
        """The mesh with each edge of faces that are not ruled cut into `parts`, the new points near the surface."""
        base, counts = np.empty(len(self.corners), dtype=np.intp), np.empty(2, dtype=np.intp)
        self._call("pas_mesh_cut_counts", parts, base, counts)
        points, labels = np.empty((counts[0], 3)), np.empty(counts[1], dtype=np.intp)
        triangles, codes = np.empty((2, counts[1], 3), dtype=np.intp)
        self._call("pas_mesh_cut", parts, base, points, triangles, codes, labels)
        pinned = np.flatnonzero(self.kinds >= VertexKind.CORNER)
        rims = None if codes.max(initial=-1) == codes.min(initial=-1) == -1 else -1 - codes
        return HalfEdges(Labelled.of(points, triangles, labels, pinned, rims), self.faces)

    @property
    def value(self) -> Labelled:
        """The mesh as it is now, with the normals at its vertices."""
        rims = np.maximum(-1 - self.twins, -1).reshape(-1, 3) if self.twins.min(initial=0) < 0 else None
        pinned = np.flatnonzero(self.kinds >= VertexKind.CORNER)
        mesh = Labelled.of(self.points.copy(), self.triangles.copy(), self.labels.copy(), pinned, rims)
        span = int(self.labels.max(initial=0)) + 1
        order = np.argsort(self.vertex_of * span + self.face_of, kind="stable")  # that of the rows of `pairs`
        return Labelled(mesh.points, mesh.topology, self.normals.take(order, axis=0))


def halved(mesh: Labelled, rows: Integers) -> Labelled:
    """A mesh with the edges of given rows of its table halved, the longest first; the new vertices are the last."""
    halves = HalfEdges(mesh, np.zeros(int(mesh.labels.max()) + 1, dtype=np.int8))
    halves.split(mesh.topology.halves[rows[np.argsort(-mesh.lengths[rows], kind="stable")]])
    points, topology = halves.value.points, halves.value.topology
    return Labelled(points, replace(topology, pinned=mesh.topology.pinned))


_ARRAYS = {name: array for name, array in vars(HalfEdges).items() if isinstance(array, _Array)}


class _Struct(ctypes.Structure):
    """The C structure of a mesh in `pas/kernels/halfedge.h`: the same names in the same order."""

    _fields_ = [
        *((name, ctypes.c_ssize_t) for name in ("vertices", "triangles", "wedges", "stamp")),
        ("fine", ctypes.c_double),
        ("coarse", ctypes.c_double),
        ("plain", ctypes.c_ssize_t),
        *((name, ctypes.c_void_p) for name in (*_ARRAYS, "faces")),
    ]
