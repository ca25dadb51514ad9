"""The contents of files of shapes: parts with names, colours and meshes, exact solids, or rational patches."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from pas.algebra.inputs import shown
from pas.arrays import Floats, Integers
from pas.exchange.formats import UNITS, Content, Request
from pas.mesh.mesh import Mesh
from pas.mesh.rows import counted_on
from pas.parametric.patches import RationalPatch
from pas.settings import MeshSettings, given
from pas.shape import Shape, kind_of
from pas.solid.assembly import COLORS, Part
from pas.solid.measures import PartList


@dataclass(frozen=True)
class Piece:
    """One part as files see it: its name, colour (red, green, blue up to 255), mesh, and shifts (M, 3) if it is in
    many places."""

    name: str
    color: tuple[int, int, int]
    mesh: Mesh
    places: Floats | None = None


def parts_of(thing: Any, request: Request) -> list[Piece]:
    """The parts of a shape, or of several in a list, meshed.

    A shape without parts is one part, named as the file, in the colour of an assembly's first part; of several each has
    a colour of its own, and a number.

    Raises `ValueError` for a domain of what has none, `TypeError` for what is no shape, and what `mesh` raises.
    """
    if not isinstance(thing, list | tuple):
        return _parts(thing, request)
    if not thing:
        raise ValueError("there must be at least one shape to write")
    pieces = []
    for number, item in enumerate(thing):
        found = parts_of(item, replace(request, name=f"{request.name} {number + 1}"))
        color = _rgb(COLORS[number % len(COLORS)])
        pieces += [replace(found[0], color=color)] if len(found) == 1 else found
    return pieces


def _checked_parts(thing: Any, request: Request) -> list[Piece]:
    """`parts_of`, but raises `ValueError` for a mesh with a tolerance, which would do nothing."""
    if given(request.mesh) and not isinstance(thing, list | tuple) and kind_of(thing, "shape").meshed:
        raise ValueError("tolerance and domain are for surfaces; a mesh has them behind it")
    return parts_of(thing, request)


def _is_of_shapes(thing: Any) -> bool:
    if isinstance(thing, list | tuple):
        return bool(thing) and all(map(_is_of_shapes, thing))
    return isinstance(thing, Shape)


def is_closed(thing: Any) -> bool:
    """Whether all meshes of a shape, or of several in a list, are closed; meshes it where its kind does not tell."""
    if isinstance(thing, list | tuple):
        return all(map(is_closed, thing))
    return not kind_of(thing, "shape").open and all(p.mesh.is_closed for p in parts_of(thing, Request("shape")))


def require_closed(thing: Any, parts: Sequence[Piece], file: str) -> None:
    """Raise `ValueError` for a part with edges, in a file that is taken for bodies."""
    edged = next((part for part in parts if not part.mesh.is_closed), None)
    if edged is None:
        return
    bounds = any(hasattr(item, "solid") for item in (thing if isinstance(thing, list | tuple) else [thing]))
    body = f"write the body that it bounds, as in shape.solid().write({file!r})" if bounds else "close it"
    raise ValueError(
        f"{file} would be taken for a closed body, and the surface of {edged.name!r} has edges; {body}, or write the "
        "bare surface with open=True (`--open` of a command)"
    )


TRIANGLES: Content[list[Piece]] = Content(
    "triangles", _checked_parts, tuple(f.name for f in fields(MeshSettings)), _is_of_shapes
)


def _placed_parts(thing: Any, request: Request) -> list[Piece]:
    """Closed bodies in many places, of what consists of such; of all else its parts."""
    placed = None if isinstance(thing, list | tuple) else kind_of(thing, "shape").placed
    if placed is None:
        return _checked_parts(thing, request)
    bodies = placed(thing, request.mesh)
    return [Piece(f"{request.name} {n + 1}", _rgb(COLORS[0]), *body) for n, body in enumerate(bodies)]


PLACED: Content[list[Piece]] = replace(TRIANGLES, of=_placed_parts)


def _parts(shape: Any, request: Request) -> list[Piece]:
    kind = kind_of(shape, "shape")
    if kind.parts is None:
        return [Piece(request.name, _rgb(COLORS[0]), kind.mesh(shape, request.mesh))]
    if request.mesh.domain is not None:
        raise ValueError(f"domain is that of a parametric surface, which {shape!r} is not")
    return [Piece(n, _rgb(p.color), p.meshed(request.mesh)) for n, p in kind.parts(shape).items()]


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def in_unit(parts: Sequence[Piece], request: Request, unit: str) -> Sequence[Piece]:
    """The parts with lengths in the unit that all files of a format are in, or as they are where the model has none."""
    factor = 1 if request.unit is None else UNITS[request.unit].meters / UNITS[unit].meters
    moved = [None if part.places is None else part.places * float(factor) for part in parts]
    scaled = zip(parts, moved, strict=True)
    return parts if factor == 1 else [replace(p, mesh=p.mesh.scale(factor), places=m) for p, m in scaled]


def joined(parts: Sequence[Piece]) -> tuple[Floats, Integers]:
    """Points and triangles of all parts, with no point shared between parts."""
    triangles = counted_on([p.mesh.triangles for p in parts], [len(p.mesh.points) for p in parts])
    return np.concatenate([p.mesh.points for p in parts]), triangles


def face_numbers(parts: Sequence[Piece]) -> tuple[Integers, list[str]]:
    """The number of each triangle's face among those of all parts, and their names, `part: face` for several."""
    return counted_on([p.mesh.faces for p in parts], [len(p.mesh.names) for p in parts]), face_names(parts)


def face_names(parts: Sequence[Piece]) -> list[str]:
    """The names of all parts' faces, `part: face` where there are several parts."""
    single = len(parts) == 1
    return [name if single else f"{p.name}: {name}" for p in parts for name in p.mesh.names]


def all_different(names: Iterable[str], between: str) -> list[str]:
    """The names, those that have been before with a number, `between` before it; "unnamed" for empty ones."""
    result: list[str] = []
    for name in names:
        base = word = name or "unnamed"
        number = 1
        while word in result:
            number += 1
            word = f"{base}{between}{number}"
        result.append(word)
    return result


def repeated_colors(parts: Sequence[Piece], counts: Sequence[int]) -> Any:
    """The parts' colours, each as often as its count says (M, 3)."""
    return np.repeat(np.array([p.color for p in parts], dtype=np.uint8), counts, axis=0)


HIGHEST_DEGREE = 25
"""In each direction: what the common kernels take."""


@dataclass(frozen=True)
class ExactPart:
    """A part whose faces have equations: its name, its colour or None, and the solid."""

    name: str
    color: tuple[int, int, int] | None
    solid: Any


def faces_of(thing: Any, request: Request) -> list[RationalPatch] | list[ExactPart]:
    """The patches of patches, exact surfaces or blends, or the solids of solids, assemblies and teapots.

    Several in a list are all of one sort.  Raises what `patches_of` raises, `ValueError` for options that say nothing
    of solids, or of patches, and `TypeError` for a shape that is neither.
    """
    items = list(thing) if isinstance(thing, list | tuple) else [thing]
    found = [part for number, item in enumerate(items) for part in _exact_parts(item, number, len(items), request)]
    if not found:
        if request.mesh.tolerance is not None:
            raise ValueError("tolerance says nothing of patches, which are exact")
        return patches_of(thing, request)
    for name in (given(request.mesh).keys() - {"tolerance"}) | ({"sew"} if request.sew is not None else set()):
        raise ValueError(f"{name} says nothing of solids, of which all faces are joined")
    return found


def _exact_parts(item: Any, number: int, many: int, request: Request) -> list[ExactPart]:
    """The solids of an item of several; none of what has patches, or is no shape."""
    if not isinstance(item, Shape):
        return []
    kind, name = kind_of(item), request.name if many == 1 else f"{request.name} {number + 1}"
    if kind.solid is not None:
        return [ExactPart(name, None, kind.solid(item))]
    if kind.parts is None:
        return []
    parts = []
    for title, part in kind.parts(item).items():
        solid = kind_of(part.shape).solid
        if solid is None:
            raise TypeError(f"the part {title!r} is a mesh, whose faces have no equations; write triangles, as .3mf")
        parts.append(ExactPart(title, _rgb(part.color), solid(part.shape)))
    return parts


def patches_of(patches: Any, request: Request) -> list[RationalPatch]:
    """The patches of a patch, an exact surface or blend, or of several of these.

    A surface or a blend gives its `bezier_patches` over the request's domain.  Errors name the item by its number:
    `ValueError` for none, one that is not exact, an infinite domain, a degree above HIGHEST_DEGREE and a distance to
    sew that is not positive, `TypeError` for other things, `GeometryError` for a pole.
    """
    if request.sew is not None and not 0 < request.sew < float("inf"):
        raise ValueError(f"sew must be a positive number, not {request.sew}")
    items = list(patches) if isinstance(patches, Iterable) else [patches]
    if not items:
        raise ValueError("there must be at least one patch")
    found: list[RationalPatch] = []
    for number, item in enumerate(items):
        made = _patches(item, number, request.mesh.domain)
        highest = max((patch.degrees for patch in made), key=max)
        if max(highest) > HIGHEST_DEGREE:
            raise ValueError(
                f"patches[{number}] has the degrees {highest}, but STEP is read up to {HIGHEST_DEGREE}; "
                "write fit_patch(surface, tolerance) in its place"
            )
        found += made
    return found


def _patches(item: Any, number: int, domain: Any) -> Sequence[RationalPatch]:
    kind = kind_of(item, f"patches must be RationalPatch objects, parametric surfaces or blends; patches[{number}]")
    if kind.patches is None:
        hint = (
            "write the solid that it bounds, as in shape.solid().write('name.step') or by `pas convert`"
            if hasattr(item, "solid")
            else "write its triangles, as in shape.write('name.3mf')"
        )
        raise TypeError(f"STEP files hold solids, or rational patches, and {shown(item)} is neither; {hint}")
    try:
        return kind.patches(item, domain)
    except ValueError as error:
        raise ValueError(f"patches[{number}]: {error}") from None


FACES: Content[list[RationalPatch] | list[ExactPart]] = Content("faces", faces_of, ("domain", "sew", "tolerance"))


def part_list_of(thing: Any, request: Request) -> PartList:
    """The measures of a solid, a closed mesh or each part of an assembly; raises `TypeError` for what is no body."""
    if isinstance(thing, list | tuple):
        raise TypeError("measures are those of one shape; make an assembly of several, as in solid.assembly(a=a, b=b)")
    kind = kind_of(thing, "shape")
    parts = {request.name: thing} if kind.parts is None else kind.parts(thing)
    if not _is_body(thing):
        raise TypeError(f"measures are those of solids, closed meshes and assemblies, not of {thing!r}")
    bodies = {name: Part(one, COLORS[0]) if kind.meshed else one for name, one in parts.items()}
    return PartList({name: body.measures(request.mesh.tolerance) for name, body in bodies.items()})


def _is_body(thing: Any) -> bool:
    known = isinstance(thing, Shape) and kind_of(thing)
    return bool(known and (known.meshed or known.parts)) or hasattr(thing, "measures")


MEASURES: Content[PartList] = Content("measures", part_list_of, ("tolerance",), _is_body)
