"""Surfaces of which everything is true: blends that are proved, and quadrics whose truth is plain.

A `Known` is a surface with what is true of each claim.  A quadric that holds the centre is convex,
so each ray meets it once; whether it stays off the walls is a question of quadratic functions on
triangles, answered exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache
from itertools import combinations
from math import floor, sqrt
from random import Random

import numpy as np
from adversarial.exact_checks import Point, exact
from conftest import AXES, EQUAL, UNEQUAL, solved
from scipy.spatial import ConvexHull

import pas
from pas import Contact, Partition, PiecewiseSurface, Polynomial


class Truth(Enum):
    """What is known of a claim by construction."""

    HOLDS = "holds"
    FAILS = "fails"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Known:
    """A surface, the truth of each claim, and in words how it came about."""

    surface: PiecewiseSurface
    contacts: tuple[Truth, ...]
    faces: tuple[Truth, ...]
    sheet: Truth
    enclosed: Truth
    story: str

    def but(self, surface: PiecewiseSurface, story: str, **truths: object) -> Known:
        """Another surface with other truths, and the story told on."""
        return replace(self, surface=surface, story="; ".join(filter(None, (self.story, story))), **truths)


def sound(surface: PiecewiseSurface, story: str) -> Known:
    """A surface of which every claim holds."""
    contacts = (Truth.HOLDS,) * len(surface.contacts)
    faces = (Truth.HOLDS,) * len(surface.partition.interior_faces)
    return Known(surface, contacts, faces, Truth.HOLDS, Truth.HOLDS, story)


SINGLE = {
    "tube": ([("y^2 + z^2 - 1/4", "x - 1"), ("y^2 + z^2 - 1/4", "-x - 1")], ((-1, -1, -1), (1, 1, 1)), 2),
    "coaxial": ([("y^2 + z^2 - 1", "x - 1"), ("y^2 + z^2 - 4", "-x - 1")], ((-1, -3, -3), (1, 3, 3)), 1),
    "elbow": ([("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")], ((-2, -2, -2), (2, 2, 2)), 1),
    "hemispheres": (
        [("(x + 2)^2 + y^2 + z^2 - 4", "-x - 2"), ("(x - 1)^2 + y^2 + z^2 - 1", "x - 1")],
        ((-2, -3, -3), (1, 3, 3)),
        2,
    ),
}


@cache
def corner(number: int) -> Known:
    """Corners of six tetrahedra: four of unit clips (0 to 3), then random radii and clips."""
    if number < 4:
        radii, order = [(EQUAL, 1), (EQUAL, 2), (UNEQUAL, 1), (UNEQUAL, 2)][number]
        return proved(solved(radii, order), f"corner of radii {radii}, GC^{order}")
    random = Random(f"corner {number}")
    heights = [Fraction(random.randint(10, 40), 20) for _ in AXES]
    pipes = []
    for i, axis in enumerate(AXES):
        a, b = sorted(float(h) for j, h in enumerate(heights) if j != i)
        largest = a * b / sqrt(a * a + 4 * b * b) / 1.1
        radius = Fraction(max(1, floor(100 * random.uniform(0.2, 1.0) * largest)), 100)
        pipes.append(pas.Pipe(axis=axis, radius=radius, clip=heights[i]))
    return proved(pas.blend(pipes, 1 + number % 2, energy=pas.ThinPlate()), "corner of " + "; ".join(map(str, pipes)))


@cache
def single(name: str) -> Known:
    """One polynomial in a box."""
    contacts, box, order = SINGLE[name]
    cell = pas.SingleCell(*box)
    if name == "tube":
        tube = Polynomial(contacts[0][0])
        pairs = [Contact(*pair) for pair in contacts]
        return proved_surface(PiecewiseSurface.from_polynomials(cell, pairs, order, [tube]), name)
    return proved(pas.blend(contacts, order, partition=cell, energy=pas.ThinPlate()), f"one {name}")


@cache
def sides(name: str, pieces: int) -> Known:
    """The same polynomial in a box of six pieces (one a side) or of twelve."""
    known = single(name)
    box = known.surface.partition
    groups = [(2 * i, 2 * i + 1) for i in range(6)] if pieces == 6 else [(i,) for i in range(12)]
    partition = Partition(box.vertices, box.cells, box.center, groups)
    surface = PiecewiseSurface(partition, known.surface.contacts, known.surface.order, known.surface.patches * pieces)
    return proved_surface(surface, f"{name} in {pieces} pieces")


def proved(blend: pas.Blend, story: str) -> Known:
    """A blend with its proof."""
    assert blend.certificate.proved, blend.certificate
    return sound(blend.surface, story)


def proved_surface(surface: PiecewiseSurface, story: str) -> Known:
    """A surface that is proved here."""
    certificate = surface.certify()
    assert certificate.proved, certificate
    return sound(surface, story)


def base(random: Random, highest_degree: int = 12) -> Known:
    """One of the surfaces above, or a quadric, drawn."""
    kinds = [lambda: corner(random.randrange(4)), lambda: corner(random.randrange(CORNERS))]
    kinds += [lambda: single(random.choice(list(SINGLE))), lambda: quadric(random, Fraction(1, 7))]
    kinds += [lambda: sides(random.choice(list(SINGLE)), random.choice((6, 12)))]
    while True:
        known = random.choice(kinds)()
        if known.surface.degree <= highest_degree and known.sheet is Truth.HOLDS:
            return known


CORNERS = 6
"""Corners that are solved at most: each takes half a second to three."""


def with_faces(random: Random, highest_degree: int = 12) -> Known:
    """A surface with several pieces."""
    while not (known := base(random, highest_degree)).faces:
        pass
    return known


def with_contacts(random: Random) -> Known:
    """A surface with contacts."""
    while not (known := base(random)).contacts:
        pass
    return known


def with_polynomials(surface: PiecewiseSurface, polynomials: list[Polynomial]) -> PiecewiseSurface:
    """Other patches, in the user's coordinates."""
    return PiecewiseSurface.from_polynomials(surface.partition, surface.contacts, surface.order, polynomials)


def with_patches(surface: PiecewiseSurface, patches: list[Polynomial]) -> PiecewiseSurface:
    """Other patches, in local coordinates."""
    return PiecewiseSurface(surface.partition, surface.contacts, surface.order, patches)


def polytope(random: Random) -> Partition:
    """Cells from a centre to the triangles of a convex hull, or of one pushed in and out: a star."""
    while True:
        points = [[random.randint(-9, 9) for _ in range(3)] for _ in range(random.randint(5, 9))]
        try:
            hull = ConvexHull(np.array(points))
        except Exception:  # flat
            continue
        if hull.equations[:, 3].max() > -1:  # the origin is to be well inside
            continue
        shares = [Fraction(random.randint(4, 8), 8) if random.random() < 0.5 else 1 for _ in points]
        vertices = [tuple(s * c for c in p) for s, p in zip(shares, points, strict=True)]
        cells = [(0, *(int(i) + 1 for i in triangle)) for triangle in hull.simplices]
        numbers = list(range(len(cells)))
        random.shuffle(numbers)
        cut = random.randint(1, len(numbers))
        pieces = random.choice([None, [numbers], [numbers[:cut], numbers[cut:]] if cut < len(numbers) else None])
        try:
            return Partition([(0, 0, 0), *vertices], cells, (0, 0, 0), pieces)
        except pas.GeometryError:  # four points in a plane, a flat cell
            continue


def quadric(random: Random, gap: Fraction, partition: Partition | None = None) -> Known:
    """An ellipsoid in a polytope, at a given smallest value `gap` on the walls: 0 touches them.

    The centre of the region is inside it or the one sheet fails.
    """
    region = polytope(random) if partition is None else partition
    rows = [[Fraction(random.randint(-4, 4), 2) for _ in range(3)] for _ in range(3)]
    for i in range(3):
        rows[i][i] += 4
    middle = [Fraction(random.randint(-3, 3), 12) for _ in range(3)]
    forms = [
        sum((c * (v - m) for c, v, m in zip(r, map(Polynomial, "xyz"), middle, strict=True)), Polynomial(0))
        for r in rows
    ]
    square = sum((f * f for f in forms), Polynomial(0))
    triangles = [[exact(p) for p in region.corners(f.vertices)] for f in region.outer_faces]
    least = min(least_on_triangle(square, t) for t in triangles)
    f = square - least + gap
    surface = PiecewiseSurface.from_polynomials(region, (), 1, [f] * len(region.pieces))
    known = sound(surface, f"ellipsoid with the value {gap} next to the walls of a polytope")
    inside = f.at((0, 0, 0)) < 0
    return replace(
        known,
        sheet=Truth.HOLDS if inside else Truth.FAILS,
        enclosed=Truth.HOLDS if gap > 0 else Truth.FAILS,
    )


def least_on_triangle(convex: Polynomial, corners: Sequence[Point]) -> Fraction:
    """The smallest value of a convex quadratic on a triangle, exact."""
    candidates = [convex.at(p) for p in corners]
    for p, q in combinations(corners, 2):
        candidates += _stationary(convex, p, [_minus(q, p)])
    a, b, c = corners
    return min(candidates + _stationary(convex, a, [_minus(b, a), _minus(c, a)]))


def _stationary(f: Polynomial, start: Point, ways: list[Point]) -> list[Fraction]:
    """The value where f is stationary on a segment or a triangle, if it is so within."""
    slopes = [[f.diff(i).at(p) for i in range(3)] for p in (start, *(_plus(start, w) for w in ways))]
    # the gradient is linear: along the ways it changes by these
    first = [_dot(slopes[0], w) for w in ways]
    matrix = [[_dot(_minus(s, slopes[0]), w) for s in slopes[1:]] for w in ways]
    if len(ways) == 1:
        shares = [-first[0] / matrix[0][0]]
    else:
        (p, q), (r, s) = matrix
        shares = [(-first[0] * s + first[1] * q) / (p * s - q * r), (-first[1] * p + first[0] * r) / (p * s - q * r)]
    if min(shares) < 0 or sum(shares) > 1:
        return []
    return [f.at(tuple(c + sum(t * w[i] for t, w in zip(shares, ways, strict=True)) for i, c in enumerate(start)))]


def _minus(a: Sequence[Fraction], b: Sequence[Fraction]) -> Point:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def _plus(a: Sequence[Fraction], b: Sequence[Fraction]) -> Point:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))
