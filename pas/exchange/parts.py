"""Shapes as parts with names, colours and meshes: what files of triangles hold."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any

import numpy as np

from pas.exchange.formats.format import Content, Request
from pas.generatrix.blend import GeneratrixBlend
from pas.mesh.field import Floats, Integers
from pas.mesh.mesh import Mesh
from pas.parametric.blends import ParametricBlend
from pas.parametric.framed import extent
from pas.parametric.meshing import RELATIVE
from pas.parametric.surface import ParametricSurface
from pas.solid.assembly import COLORS, Assembly


@dataclass(frozen=True)
class Piece:
    """One part as files see it: its name, colour (red, green, blue up to 255) and mesh."""

    name: str
    color: tuple[int, int, int]
    mesh: Mesh


def parts_of(thing: Any, request: Request) -> list[Piece]:
    """The parts of a shape, or of several in a list, meshed.

    A shape that is no assembly is one part, named as the file, in the colour of an assembly's first part.

    Raises `ValueError` for a domain of what has none, `TypeError` for what has no mesh, and what `mesh` raises.
    """
    return _parts(thing, request)


def _checked_parts(thing: Any, request: Request) -> list[Piece]:
    """The same; raises `ValueError` for a mesh with a tolerance, which would do nothing."""
    if isinstance(thing, Mesh) and (request.tolerance is not None or request.domain is not None):
        raise ValueError("tolerance and domain are for surfaces; a mesh has them behind it")
    return _parts(thing, request)


TRIANGLES: Content[list[Piece]] = Content("triangles", _checked_parts, ("tolerance", "domain"))


@singledispatch
def _parts(thing: Any, request: Request) -> list[Piece]:
    """Of what has a mesh, or a surface that has one."""
    if not callable(getattr(thing, "mesh", None)):
        if not hasattr(thing, "surface"):
            raise TypeError(f"shape must be a mesh, a solid, an assembly, a surface or a blend, not {thing!r}")
        return _parts(thing.surface, request)
    if request.domain is not None:
        raise ValueError(f"domain is that of a parametric surface, which {thing!r} is not")
    return _single(thing.mesh(request.tolerance), request)


@_parts.register(ParametricSurface)
@_parts.register(ParametricBlend)
def _(surface: ParametricSurface | ParametricBlend, request: Request) -> list[Piece]:
    return _single(surface.mesh(request.tolerance, request.domain), request)


@_parts.register
def _(blend: GeneratrixBlend, request: Request) -> list[Piece]:
    """Within a tolerance, too, where none is given: its own mesh would be a grid of which none is known."""
    if request.domain is not None:
        return _parts(blend.surface, request)
    tolerance = RELATIVE * extent(blend.surface) if request.tolerance is None else request.tolerance
    return _single(blend.mesh(tolerance), request)


@_parts.register
def _(assembly: Assembly, request: Request) -> list[Piece]:
    if request.domain is not None:
        raise ValueError("domain is that of a parametric surface, which an assembly is not")
    return [Piece(name, _rgb(p.color), p.mesh(request.tolerance)) for name, p in assembly.parts.items()]


@_parts.register(list)
@_parts.register(tuple)
def _(things: Sequence[Any], request: Request) -> list[Piece]:
    """Each thing in a colour of its own, numbered."""
    if not things:
        raise ValueError("there must be at least one shape to write")
    pieces = []
    for number, thing in enumerate(things):
        found = _parts(thing, replace(request, name=f"{request.name} {number + 1}"))
        color = _rgb(COLORS[number % len(COLORS)])
        pieces += [replace(found[0], color=color)] if len(found) == 1 else found
    return pieces


def _single(mesh: Mesh, request: Request) -> list[Piece]:
    return [Piece(request.name, _rgb(COLORS[0]), mesh)]


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def joined(parts: Sequence[Piece]) -> tuple[Floats, Integers]:
    """Points and triangles of all parts, with no point shared between parts."""
    starts = np.cumsum([0, *(len(p.mesh.points) for p in parts)])
    triangles = [p.mesh.triangles + start for p, start in zip(parts, starts, strict=False)]
    return np.concatenate([p.mesh.points for p in parts]), np.concatenate(triangles)


def face_numbers(parts: Sequence[Piece]) -> tuple[Integers, list[str]]:
    """The number of each triangle's face among those of all parts, and their names, `part: face` for several."""
    starts = np.cumsum([0, *(len(p.mesh.names) for p in parts)])
    numbers = np.concatenate([p.mesh.faces + start for p, start in zip(parts, starts, strict=False)])
    return numbers, face_names(parts)


def face_names(parts: Sequence[Piece]) -> list[str]:
    """The names of all parts' faces, `part: face` where there are several parts."""
    single = len(parts) == 1
    return [name if single else f"{p.name}: {name}" for p in parts for name in p.mesh.names]


def repeated_colors(parts: Sequence[Piece], count: Callable[[Mesh], int]) -> Any:
    """The parts' colours, each as often as its mesh has what is counted (M, 3)."""
    colors = np.array([p.color for p in parts], dtype=np.uint8)
    return np.repeat(colors, [count(p.mesh) for p in parts], axis=0)


def points_of(mesh: Mesh) -> int:
    """The number of its points."""
    return len(mesh.points)


def triangles_of(mesh: Mesh) -> int:
    """The number of its triangles."""
    return len(mesh.triangles)
