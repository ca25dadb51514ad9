"""The data of the page's picture of a shape, exact polynomials to cast rays at or triangles, and the facts beside it.

Piecewise surfaces go as the coefficients of their pieces in local coordinates, in doubles, with the tetrahedra of their
region, and with the contacts' own polynomials in boxes beyond their clips.  Clips that pass through the region, curved
ones above all, end what is seen of both.  Every other kind of shape goes as the meshes of its parts.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from itertools import cycle
from typing import Any, cast

import numpy as np

from pas.algebra.affine import ORIGIN
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import to_float, to_floats
from pas.arrays import Floats
from pas.blending.place import place
from pas.contacts.joins import Join
from pas.exchange.picture_options import Picture
from pas.parametric.generatrix.blend import GeneratrixBlend
from pas.piecewise import PiecewiseSurface, SurfaceMesh
from pas.render.piecewise import sharpest_neighbour
from pas.render.plotting import hair_length
from pas.render.scene import BLEND_COLOR, COLORS, Layer, scene_of
from pas.settings import MeshSettings
from pas.shape import Shape, kind_of
from pas.studio import Message
from pas.studio.controls import SHAPE
from pas.surface.fairness_limits import LOOSE, NODE_SHARPNESS, neighbour
from pas.surface.placed import PlacedContacts


def legs(shape: Shape) -> tuple[dict[str, Any], dict[str, Any]]:
    """An entry for the head and an array; empty for other kinds of shapes and where shape values are functions of s.

    The array has, in rows of 120 points, for both curves C, C', W, W', E, E', then the middle curve and
    its derivative where there is one.
    """
    if kind_of(shape).name != "generatrix blend":
        return {}, {}
    blend = cast("GeneratrixBlend", shape)
    functions = {name: getattr(blend.shape, name) for name in SHAPE}
    values = {name: function.value for name, function in functions.items() if function is not None}
    if len(values) < len(SHAPE) or None in values.values():
        return {}, {}
    here = blend.frames.grid(120)
    rows = [part for e in here.edges for part in (e.point, e.velocity, *e.across, *e.along)] + list(here.middle or ())
    head = {
        "size": (120, 40),
        "closed": blend.closed,
        "inward": blend.frames.inward,
        "values": {name: float(value) for name, value in values.items()},
    }
    return {"legs": head}, {"legs": np.stack(rows).astype(np.float64)}


def picture(shape: Shape) -> Message:
    """Everything that is needed to draw a shape."""
    kind = kind_of(shape)
    surface = None if kind.piecewise is None else kind.piecewise(shape)
    if surface is not None and surface.partition.cells:
        return _cast(surface)
    return _meshes(shape)


def name_of_scene(message: Message) -> str:
    """What makes two pictures differ in coefficients alone."""
    if message.head["how"] != "cast":
        return ""
    digest = hashlib.sha256(json.dumps(message.head["beyond"]).encode())
    for name in ("vertices", "cells", "pieces", "neighbours"):
        digest.update(message.arrays[name].tobytes())
    return f"{message.head['degree']} {digest.hexdigest()[:16]}"


def coefficients(surface: PiecewiseSurface) -> Floats:
    """The scaled coefficients (pieces, C(n + 3, 3)) in local coordinates, in the order of `pas.algebra.monomials`."""
    return np.array([patch.dense(surface.degree) for patch in surface.scaled.polynomials])


def outline(contacts: Sequence[Any], order: int, partition: Any) -> Message:
    """The neighbours of a blend that is not solved yet; raises what placing them raises."""
    placed = place(contacts, order, partition)
    frame, beyond = placed.partition.frame, _neighbours(placed)
    head = {
        "kind": "outline",
        "origin": to_floats(frame.origin),
        "scale": to_float(frame.scale),
        "beyond": [box for box, _ in beyond],
    }
    return Message(head, {"neighbours": np.concatenate([np.empty(0), *(values for _, values in beyond)])})


def _neighbours(placed: PlacedContacts) -> list[tuple[dict[str, Any], Floats]]:
    extent = float(np.ptp(placed.local.points, axis=0).max())
    return [_beyond(join, 0.22 * extent) for join in placed.joins]


def _cast(surface: PiecewiseSurface) -> Message:
    local, frame = surface.local, surface.partition.frame
    shared = {triangle for triangle, _, _ in local.inner_triangles}
    inner = [[tuple(sorted(set(cell) - {v})) in shared for v in cell] for cell in local.cells]
    beyond = _neighbours(surface.placed)
    clips = _clips(surface.placed)
    head = {
        "kind": "picture",
        "how": "cast",
        "clips": [clip.degree for clip in clips],
        "degree": surface.degree,
        "exponent": surface.scaled.exponent,
        "order": surface.placed.order,
        "origin": to_floats(frame.origin),
        "scale": to_float(frame.scale),
        "unit": sharpest_neighbour(surface),
        "title": surface.partition.title,
        "beyond": [box for box, _ in beyond],
    }
    arrays: dict[str, Any] = {
        "coefficients": coefficients(surface),
        "vertices": local.points,
        "cells": np.array(local.cells, dtype=np.uint32),
        "pieces": np.asarray(local.piece_of, dtype=np.uint32),
        "inner": np.array(inner, dtype=np.uint8),
        "neighbours": np.concatenate([np.empty(0), *(values for _, values in beyond)]),
        "clips": np.concatenate([np.empty(0), *(clip.dense(clip.degree) for clip in clips)]),
    }
    return Message(head, arrays)


def _beyond(join: Join, length: float) -> tuple[dict[str, Any], Floats]:
    """The box in which a contact's surface is shown beyond its clip, and the coefficients of the surface.

    A clip that ends the region is a side of the box.  For others the box is the region's, larger by `length`, and the
    clip's coefficients come after the surface's, positive where nothing is shown; its degree is in "clips".
    """
    surface = join.contact.surface
    values = surface.dense(surface.degree)
    if not _ends_region(join):
        low, high = join.partition.points.min(axis=0) - length, join.partition.points.max(axis=0) + length
        halves = np.diag(high - low) / 2
        box = {"degree": surface.degree, "middle": ((low + high) / 2).tolist(), "halves": halves.tolist()}
        end = _end(join)
        return box | {"clips": [end.degree]}, np.concatenate([values, (-end).dense(end.degree)])
    rim = neighbour(join, 1.0)
    along = unit(join.contact.clip.dense(1)[1:])
    across = np.linalg.svd(along[None])[2][1:]
    straight = np.abs(_change(surface, along)).max() < 1e-12 * np.abs(values).max()
    radius = rim.radius * 1.05 + (0.0 if straight else length)
    start, stop = -0.01 * length, length  # the clip itself ends the neighbour
    middle = rim.mean + (start + stop) / 2 * along
    halves = np.stack([along * (stop - start) / 2, *(radius * across)])
    box = {"degree": surface.degree, "middle": middle.tolist(), "halves": halves.tolist(), "clips": []}
    return box | {"clip": [*along.tolist(), -float(along @ rim.mean)]}, values


def _ends_region(join: Join) -> bool:
    """Whether the region ends where the contact does: at a plane, in which the contact's curve is."""
    return join.contact.clip.degree == 1 and bool(np.isfinite(join.radius))


def _clips(placed: PlacedContacts) -> list[Polynomial]:
    """The clips at which the surface ends before its region does, each once."""
    return list(dict.fromkeys(_end(join) for join in placed.joins if not _ends_region(join)))


def _end(join: Join) -> Polynomial:
    """The clip of a contact, negative on the side of the centre, where the blend is."""
    clip = join.contact.clip
    return -clip if clip.at(ORIGIN) > 0 else clip


def _change(surface: Any, along: Floats) -> Floats:
    """The coefficients of the derivative along a direction."""
    degree = max(surface.degree - 1, 0)
    rows = [step * np.asarray(surface.diff(axis).dense(degree)) for axis, step in enumerate(along.tolist())]
    return np.asarray(np.sum(rows, axis=0))


def _meshes(shape: Shape) -> Message:
    """The layers of the shape's picture, with curvatures where its kind knows them; of what stands in many places, each
    body once, with its places."""
    kind = kind_of(shape)
    curved = kind.curved
    placed = [] if kind.placed is None else kind.placed(shape, MeshSettings())
    layers = [Layer(mesh, COLORS[0]) for mesh, _ in placed] or scene_of(shape, Picture()).layers
    shifts = [places for _, places in placed] or [np.zeros((1, 3))] * len(layers)
    boxes = [(layer.mesh.points, places) for layer, places in zip(layers, shifts, strict=True)]
    low = np.min([points.min(axis=0) + places.min(axis=0) for points, places in boxes], axis=0)
    high = np.max([points.max(axis=0) + places.max(axis=0) for points, places in boxes], axis=0)
    middle, scale = (low + high) / 2, float((high - low).max()) / 2 or 1.0
    origin = middle if not placed else np.zeros(3)
    arrays: dict[str, Any] = {}
    for number, layer in enumerate(layers):
        points, triangles, normals = layer.mesh.shading
        arrays[f"points {number}"] = ((points - origin) / scale).astype(np.float32)
        arrays[f"normals {number}"] = normals.astype(np.float32)
        arrays[f"triangles {number}"] = np.asarray(triangles, dtype=np.uint32)
        if placed:
            arrays[f"places {number}"] = ((shifts[number] - middle) / scale).astype(np.float32)
        if layer.principal is not None:
            bent = layer.principal()[layer.mesh.shading_points]
            both = np.stack([bent.mean(axis=1), bent.prod(axis=1)], axis=1)
            arrays[f"bent {number}"] = np.nan_to_num(both, nan=0.0, posinf=0.0, neginf=0.0).astype(np.float32)
    names = list(dict.fromkeys(name for mesh, _ in placed for name in mesh.names))
    palette = (BLEND_COLOR, *COLORS)
    colors = dict(zip(names, cycle(palette), strict=False))
    more, parts = legs(shape)
    units = [layer.unit for layer in layers if layer.unit is not None]
    head = {
        "kind": "picture",
        "how": "mesh",
        "colors": [colors[mesh.names[0]] for mesh, _ in placed] or [layer.color for layer in layers],
        "parts": [[name, colors[name]] for name in names],
        "origin": middle.tolist(),
        "scale": scale,
        "unit": units[0] if units else _usual(arrays),
        "main": [layer.aside for layer in layers].index(False) if not all(layer.aside for layer in layers) else 0,
        "curved": curved,
        "triangles": sum(
            len(mesh.triangles) * len(places)
            for (mesh, places) in zip((layer.mesh for layer in layers), shifts, strict=True)
        ),
        **more,
    }
    return Message(head, arrays | parts)


def triangles(mesh: SurfaceMesh, surface: PiecewiseSurface) -> dict[str, Any]:
    """The arrays of a mesh of a surface, all in local coordinates: for machines that cast rays too slowly."""
    points, corners, normals = mesh.shading
    frame = surface.partition.frame
    scale = to_float(frame.scale)
    local = (points - to_floats(frame.origin)) / scale
    for clip in _clips(surface.placed):
        corners = corners[(clip(local) < 0)[corners].any(axis=1)]
    bent = np.nan_to_num(surface.curvatures(points) * [scale, scale**2], nan=0.0, posinf=0.0, neginf=0.0)
    return {
        "points 0": local.astype(np.float32),
        "normals 0": normals.astype(np.float32),
        "triangles 0": corners.astype(np.uint32),
        "bent 0": bent.astype(np.float32),
    }


def quick(shape: Shape) -> Message:
    """The triangles of a shape alone, as fast as it can be meshed, in its own coordinates."""
    points, triangles, normals = shape.mesh().shading
    arrays = {"points 0": points, "normals 0": normals.astype(np.float32), "triangles 0": triangles.astype(np.uint32)}
    return Message({"kind": "moved", "scene": ""}, arrays)


def _usual(arrays: dict[str, Any]) -> float | None:
    """A curvature that 95 of 100 points stay below, for the range of colours; None where none is known."""
    known = [np.abs(values.reshape(-1, 2)[:, 0]) for name, values in arrays.items() if name.startswith("bent")]
    return float(np.percentile(np.concatenate(known), 95)) or 1.0 if known else None


def measures(shape: Shape | None) -> Message:
    """The measures of a shape, and what is not fair of it; of other kinds than blends, and of none, there are none."""
    told = {} if shape is None else kind_of(shape).facts(shape)
    limits = getattr(shape, "limits", None)
    facts = {"fairness": told.get("fairness"), "limits": {} if limits is None else vars(limits)}
    return Message({"kind": "measures", "facts": facts, "unfair": list(_unfair(shape))})


def _unfair(shape: Any) -> Iterator[str]:
    """The measures that are not fair, each in some words.

    Where the neighbours leave no room for a fair surface there is no limit of sharpness: the usual one is looked at.
    """
    if getattr(shape, "kind", "") != "blend" or shape.fairness is None:
        return
    fairness = shape.fairness
    yield from fairness.beyond(shape.limits)
    if shape.limits.sharpness >= LOOSE and fairness.sharpness > NODE_SHARPNESS:
        times = f"{fairness.sharpness:.3g} times as sharp as its sharpest neighbour"
        yield f"{times}, for the neighbours leave no room for a fair surface"


def hairs(shape: Shape) -> Message:
    """The combs of a shape: points and tips of hairs, and curvatures, of one curve after the other.

    Raises `ValueError` for a kind of shape of which no curvature is known.
    """
    layers = scene_of(shape, Picture(combs=True)).layers
    length = hair_length(layers)
    combs = [comb for layer in layers for comb in layer.combs]
    points = np.concatenate([np.empty((0, 3)), *(comb.points for comb in combs)])
    normals = np.concatenate([np.empty((0, 3)), *(comb.normals for comb in combs)])
    curvatures = np.concatenate([np.empty(0), *(comb.curvatures for comb in combs)])
    tips = points + length * np.abs(curvatures)[:, None] * normals
    head = {"kind": "combs", "counts": [len(comb.points) for comb in combs]}
    return Message(head, {"points": points, "tips": tips, "curvatures": curvatures})
