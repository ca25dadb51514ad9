"""Points of a piecewise surface's region at which something may be broken."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from random import Random

from adversarial.exact_checks import Point, exact
from adversarial.surface_bases import Known

from pas import Contact, Partition, Polynomial

VARIABLES = tuple(map(Polynomial, "xyz"))


def some_place(known: Known, random: Random) -> tuple[str, Point]:
    """A point of the region or outside, and in a word where."""
    region = known.surface.partition
    kinds = ["wall", "wall", "edge", "vertex", "cell", "cell", "cell", "outside", "centre"]
    clipped = [face for join in known.surface.joins for face in join.faces]
    kinds += ["clip face", "clip face", "curve"] if clipped else []
    kind = random.choice(kinds)
    if kind in ("wall", "edge"):
        vertices = random.choice(walls(known)).vertices
        return kind, in_hull(
            known.surface.partition, vertices if kind == "wall" else random.sample(vertices, 2), random
        )
    if kind == "clip face":
        return kind, in_hull(known.surface.partition, random.choice(clipped).vertices, random)
    if kind == "curve":
        join = random.choice([j for j in known.surface.joins if j.faces])
        curve = region.frame.global_points(join.curve())
        return kind, exact(curve[random.randrange(len(curve))].tolist())
    if kind == "centre":
        return "cell", exact(region.center)
    if kind == "vertex":
        return kind, exact(region.vertices[random.choice(outer_vertices(region))])
    p = in_hull(known.surface.partition, random.choice(region.cells), random)
    if kind == "cell":
        return kind, p
    far = max(outer_vertices(region), key=lambda i: region.vertices[i][0])
    apex, center = exact(region.vertices[far]), exact(region.center)
    return kind, tuple(c + 2 * (a - c) for a, c in zip(apex, center, strict=True))


def in_hull(region: Partition, vertices: Sequence[int], random: Random) -> Point:
    """A random point of the convex hull of some vertices, given by their numbers."""
    corners = [exact(region.vertices[i]) for i in vertices]
    return mean(corners, [random.randint(1, 16) for _ in corners])


def mean(points: list[Point], weights: list[int]) -> Point:
    """The weighted mean of points."""
    total = sum(weights)
    return tuple(sum((w * p[i] for w, p in zip(weights, points, strict=True)), Fraction(0)) / total for i in range(3))


def walls(known: Known) -> list:
    """The outer faces in no clip plane."""
    f = known.surface
    clips = [c.clip for c in f.contacts]
    corners = f.partition.corners
    return [
        o for o in f.partition.outer_faces if not any(all(h.at(p) == 0 for p in corners(o.vertices)) for h in clips)
    ]


def outer_vertices(region: Partition) -> list[int]:
    """The numbers of the vertices on the boundary, in the cells' order."""
    return sorted({v for face in region.outer_faces for v in face.vertices})


def distance2(p: Point) -> Polynomial:
    """The square of the distance from a point."""
    return sum(((v - c) ** 2 for v, c in zip(VARIABLES, p, strict=True)), Polynomial(0))


def size(known: Known) -> Fraction:
    """A power of two that the region's size is one to two times."""
    scale = known.surface.partition.frame.scale
    return Fraction(int(scale.p), int(scale.q))


def length(plane: Polynomial) -> float:
    """The length of a plane's normal."""
    return float(sum(plane.diff(i).at((0, 0, 0)) ** 2 for i in range(3))) ** 0.5


def circle_point(contact: Contact, random: Random) -> Point | None:
    """A rational point of the contact's curve, where it is a circle around a coordinate axis."""
    terms, clip = contact.surface.coefficients(), contact.clip.coefficients()
    axis = next((i for i in range(3) if contact.clip.diff(i).at((0, 0, 0)) != 0), 0)
    across = [i for i in range(3) if i != axis]
    squares = {tuple(2 if i == j else 0 for i in range(3)): Fraction(1) for j in across}
    radius2 = -terms.get((0, 0, 0), Fraction(0))
    radius = Fraction(isqrt(radius2.numerator), isqrt(radius2.denominator)) if radius2 > 0 else Fraction(0)
    if terms != squares | {(0, 0, 0): -radius2} or radius**2 != radius2:
        return None
    t = Fraction(random.randint(-20, 20), random.randint(1, 20))
    p = [Fraction(0)] * 3
    p[across[0]], p[across[1]] = radius * (1 - t * t) / (1 + t * t), radius * 2 * t / (1 + t * t)
    p[axis] = -clip.get((0, 0, 0), Fraction(0)) / contact.clip.diff(axis).at((0, 0, 0))
    return tuple(p)


def away(known: Known, p: Point, r: Fraction) -> bool:
    """Whether a plane separates a ball from the region."""
    region = known.surface.partition
    points = [exact(v) for v in region.vertices]
    return any(
        float(f.plane.at(p)) > 1.001 * float(r) * length(f.plane) and all(f.plane.at(v) <= 0 for v in points)
        for f in region.outer_faces
    )


def holds(region: Partition, cell: int, p: Point) -> bool:
    """Whether a closed cell holds a point."""
    return all(plane.at(p) <= 0 for plane in region.planes(cell))
