"""Full planes through the centre, for nodes whose contacts lie along the axes of a cube: those of lattices.

Where a few whole planes keep all contacts apart, the pieces are the regions of their arrangement.  Planes that follow
the cube's symmetry, an orbit of one of them under cyclic permutations and changes of sign of the cube's axes, serve
whole nodes of lattices and those at their boundary alike, where a fan must go between all contacts round one axis.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import combinations, product
from math import atan2, isqrt, radians, sin

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.lengths import across, unit
from pas.algebra.rational import Vector, cross, determinant, dot, three, vector
from pas.errors import GeometryError
from pas.layouts.discs import Disc
from pas.partition.layout import Layout, Ray, primitive, reduced

ORBITS: tuple[Ray, ...] = ((1, 0, 0), (1, 1, 1), (2, 1, 0), (3, 1, 0), (4, 1, 0))
"""A normal of each orbit, in the cube's axes: 3, 4, 6, 6 and 6 planes, tried in this order.  The first serves contacts
along the diagonals, the second those along the axes (and, thinner ones, both), the others those along the diagonals of
faces, alone and with the diagonals."""

CLEAR = radians(1.5)
"""How far all curves are seen off the planes, at least."""

FEW = 3
"""So many contacts, all in one plane, and all more than a right angle apart have fans that are as symmetric, with more
members: planes serve others."""

AXES: tuple[Ray, ...] = ((1, 0, 0), (1, 1, 0), (1, 1, 1))
"""An axis of a cube of each kind, by its squared length."""


def planes(discs: Sequence[Disc], center: Vector, orbit: Ray) -> Layout:
    """The planes of an orbit, one of whose normals is given in the cube's axes, between contacts along a cube's axes.

    Raises `GeometryError` for other nodes, and where a curve is not clear of the planes.
    """
    normals = _orbit(discs, orbit)
    if normals is None:
        raise GeometryError(
            f"full planes serve {FEW + 1} contacts or more along axes, diagonals and face diagonals of a cube, not all "
            "in one plane nor all more than a right angle apart, with room for planes between their curves; for others "
            "take a fan or strips"
        )
    return arrangement(normals, center)


def have_room(discs: Sequence[Disc]) -> bool:
    """Whether the planes of an orbit have room between contacts."""
    return any(_orbit(discs, orbit) is not None for orbit in ORBITS)


def axes_of_cube(directions: Sequence[Ray]) -> fmpq_mat | None:
    """Three perpendicular unit vectors, as rows, such that all directions lie along axes, diagonals and face diagonals
    of their cube; None where there are none.

    In a rational frame such directions have the squared length of 1, 2 or 3 times a square, by their kind, so the
    kinds are known; two that are not parallel then fit the cube in few ways, of which one must fit all.
    """
    scaled = [_scaled(direction) for direction in directions]
    if any(s is None for s in scaled):
        return None
    vectors = fmpq_mat([s for s in scaled if s is not None])
    first, *others = vectors.tolist()
    second = next((v for v in others if any(cross(first, v))), None)
    if second is None:
        return None
    given = fmpq_mat([first, second, cross(first, second)])
    start = AXES[int(dot(first, first)) - 1]
    for towards in product((1, 0, -1), repeat=3):
        if dot(towards, towards) == dot(second, second) and dot(start, towards) == dot(first, second):
            axes = fmpq_mat([list(start), list(towards), list(cross(start, towards))]).solve(given)
            if all(c.q == 1 and abs(c) <= 1 for c in (vectors * axes.transpose()).entries()):
                return axes
    return None


def has_whole_planes(layout: Layout) -> bool:
    """Whether all arcs of a layout go straight on at both ends, along three planes at least that meet in the centre
    only."""
    normals = [max(arc.normal, (-arc.normal[0], -arc.normal[1], -arc.normal[2])) for arc in layout.arcs]
    ends = Counter((ray, n) for arc, n in zip(layout.arcs, normals, strict=True) for ray in (arc.start, arc.end))
    return set(ends.values()) == {2} and bool(np.linalg.matrix_rank(np.array(normals, dtype=float)) == 3)


def _orbit(discs: Sequence[Disc], orbit: Ray) -> list[Ray] | None:
    """The normals of the planes of an orbit, whole; None where they have no room, and for contacts that fans serve."""
    square = 1e-9  # one minus the cosine up to which a contact counts as perpendicular to its clip
    directions = [primitive(disc.normal) for disc in discs]
    flat = not any(determinant(*three) for three in combinations(directions, 3))
    if len(discs) <= FEW or flat or all(dot(*two) < 0 for two in combinations(directions, 2)):
        return None
    axes = axes_of_cube(directions)
    if axes is None or min(float(disc.unit @ disc.direction) for disc in discs) < 1 - square:
        return None
    signed = [tuple(s * c for s, c in zip(signs, orbit, strict=True)) for signs in product((1, -1), repeat=3)]
    turned = [(n[i], n[(i + 1) % 3], n[(i + 2) % 3]) for n in signed for i in range(3)]
    each = dict.fromkeys(max(n, (-n[0], -n[1], -n[2])) for n in turned)
    normals = [primitive(vector((fmpq_mat([n]) * axes).entries())) for n in each]
    heights = [unit(disc.points) @ unit(np.array(normals)).T for disc in discs]
    clear = all((np.abs(h).min() > sin(CLEAR)) and ((h > 0) == (h[0] > 0)).all() for h in heights)
    apart = len({tuple(h[0] > 0) for h in heights}) == len(discs)
    return normals if clear and apart else None


def _scaled(direction: Ray) -> list[fmpq] | None:
    """The direction with the squared length 1, 2 or 3, exact; None where it has no such."""
    squared = dot(direction, direction)
    for kind in (1, 2, 3):
        root = isqrt(squared // kind)
        if kind * root**2 == squared:
            return [fmpq(c, root) for c in direction]
    return None


def arrangement(normals: Sequence[Ray], center: Vector) -> Layout:
    """The layout of the regions into which planes through the centre (their normals) cut all directions.

    Raises `GeometryError` for fewer than three planes, or all through one line: a fan serves these.
    """
    lines = (reduced(c) for a, b in combinations(normals, 2) if any(c := cross(a, b)))
    rays = list(dict.fromkeys(ray for line in lines for ray in (line, three(-x for x in line))))
    if len(rays) < 6:
        raise GeometryError("an arrangement needs three planes at least that have only the centre in common")
    signs = {ray: tuple(int(np.sign(dot(n, ray))) for n in normals) for ray in rays}
    pieces: dict[tuple[int, ...], list[int]] = {}
    for number, ray in enumerate(rays):
        free = [i for i, s in enumerate(signs[ray]) if s == 0]
        for choice in product((1, -1), repeat=len(free)):
            key = list(signs[ray])
            for i, s in zip(free, choice, strict=True):
                key[i] = s
            pieces.setdefault(tuple(key), []).append(number)
    cells = [_round(numbers, rays) for key, numbers in sorted(pieces.items()) if len(numbers) > 2]
    return Layout(rays, cells, center, f"{len(normals)} planes")


def _round(numbers: Sequence[int], rays: Sequence[Ray]) -> list[int]:
    """The rays of a convex piece, counterclockwise seen from outside."""
    middle = unit(np.sum([unit(np.array(rays[i])) for i in numbers], axis=0))
    first, second = across(middle)
    place = {i: atan2(float(unit(np.array(rays[i])) @ second), float(unit(np.array(rays[i])) @ first)) for i in numbers}
    return sorted(numbers, key=lambda i: place[i])
