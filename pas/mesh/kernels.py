"""What makes triangles good ones in compiled code, where there is some: the same meshes, bit for bit, sooner.

The functions here are those of `pas.mesh.radial`, `graded` and `coarsen`, which do the same with numpy.
"""

from __future__ import annotations

import threading
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pas.algebra.compiled import Functions, is_made, library
from pas.algebra.kernels import compiling
from pas.mesh.field import Floats, Integers

SOURCES = (Path(__file__).with_name("triangles.c"), Path(__file__).with_name("collapses.c"))

EACH = 100
"""Products for a triangle in one of the functions, about."""


class CompiledTriangles:
    """The functions of the compiled library; arrays are contiguous, numbers as large as pointers."""

    def __init__(self, functions: Functions) -> None:
        self._call = functions.call

    def upright(self, points: Floats, triangles: Integers, normals: Floats) -> Floats:
        """See `pas.mesh.radial.upright`."""
        result = np.empty(len(triangles))
        self._call("pas_uprights", len(triangles), triangles, points, normals, result)
        return result

    def edges(self, triangles: Integers, size: int) -> tuple[Integers, Integers, bool]:
        """All edges (E, 2), the inner ones first, whose owners (I, 2), and whether it is a manifold."""
        room, sizes = _room(6 * len(triangles) + size + 2), np.empty(3, dtype=np.intp)
        self._call("pas_edges", len(triangles), triangles, size, room, sizes)
        inner, rim, manifold = sizes.tolist()
        every, owners = np.empty((inner + rim, 2), dtype=np.intp), np.empty((inner, 2), dtype=np.intp)
        self._call("pas_listed", len(triangles), triangles, size, room, inner, every, owners)
        return every, owners, bool(manifold)

    def flipped(
        self, points: Floats, triangles: Integers, normals: Floats, passes: int, gain: float, turned: float
    ) -> Integers:
        """See `pas.mesh.radial.flipped`."""
        result, room = triangles.copy(), _room(6 * len(triangles) + len(points) + 2)
        self._call("pas_flipped", len(result), result, len(points), room, points, normals, passes, gain, turned)
        return result

    def grown(self, points: Floats, edges: Integers, sizes: Floats, grade: float) -> Floats:
        """See `pas.mesh.graded.grown`."""
        result = sizes.copy()
        self._call("pas_grown", len(edges), edges, len(points), points, grade, result)
        return result

    def centred(self, points: Floats, triangles: Integers, sizes: Floats) -> Floats:
        """See `pas.mesh.radial.centred`."""
        result = np.empty_like(points)
        self._call("pas_centred", len(triangles), triangles, len(points), points, sizes, result)
        return result

    def settled(self, before: Floats, after: Floats, triangles: Integers, normals: Floats, turned: float) -> Floats:
        """See `pas.mesh.radial.settled`."""
        result = after.copy()
        self._call("pas_settled", len(triangles), triangles, len(before), before, result, normals, turned)
        return result

    def collapsed(
        self,
        points: Floats,
        triangles: Integers,
        normals: Floats,
        sizes: Floats,
        edges: tuple[Integers, int],
        rim: Integers,
        fixed: NDArray[np.bool_],
        limits: tuple[float, float, float, int],
    ) -> Integers:
        """Into which vertex each goes (N,); see `pas.mesh.coarsen.collapsed`."""
        result = np.empty(len(points), dtype=np.intp)
        every, inner = edges
        arguments = (len(triangles), triangles, len(points), points, normals, sizes, len(every), inner, every, rim)
        self._call("pas_collapsed", *arguments, fixed, *limits, result)
        return result


class _Workspace(threading.local):
    """Room for numbers that is used again: fresh memory takes longer than what is done with it."""

    numbers: Integers = np.empty(0, dtype=np.intp)


_WORKSPACE = _Workspace()


def _room(count: int) -> Integers:
    if len(_WORKSPACE.numbers) < count:
        _WORKSPACE.numbers = np.empty(count, dtype=np.intp)
    return _WORKSPACE.numbers


def compiled(work: int) -> CompiledTriangles | None:
    """The compiled functions for so many more triangles, None where there are none or numpy is wanted."""
    return _best() if compiling(EACH * work, _made) else None


@cache
def _made() -> bool:
    return is_made(*SOURCES)


@cache
def _best() -> CompiledTriangles | None:
    found = library(*SOURCES)
    return None if found is None else CompiledTriangles(Functions(found[0]))
