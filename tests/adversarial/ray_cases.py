"""Rays on which doubles decide hardly or not at all, of surfaces of several kinds.

A family is a function of a surface and a generator that gives origins and directions: three doubles each.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property
from math import ldexp
from random import Random

import numpy as np
from adversarial.exact_rays import Ground
from conftest import UNEQUAL, solved

import pas

Ray = tuple[list[float], list[float]]

SPHERE = "x^2 + y^2 + z^2 - 1"
TORUS = "(x^2 + y^2 + z^2 + 15/16)^2 - 4*(x^2 + y^2)"  # radii 1 and 1/4


class Target:
    """A surface that rays are shot at, and what is needed to aim."""

    def __init__(self, surface: object) -> None:
        self.evaluator = pas.Evaluator(surface)
        self.ground = Ground(self.evaluator)
        self.partition = self.evaluator.partition

    @cached_property
    def corners(self) -> np.ndarray:
        """Of the region, or of a box where there is none."""
        points = self.partition.points
        return points if len(points) else 2.0 * np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) - 1

    @cached_property
    def size(self) -> float:
        return float(np.ptp(self.corners, axis=0).max())

    @cached_property
    def zeros(self) -> np.ndarray:
        """Points on the surface, to rounding."""
        random = np.random.default_rng(5)
        ways = random.normal(size=(400, 3))
        around = random.uniform(self.corners.min(axis=0), self.corners.max(axis=0), (400, 3))
        return self.evaluator.rays(around - 3 * self.size * ways, ways).points

    def place(self, random: Random) -> np.ndarray:
        """A point of the region's box."""
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        return np.array([random.uniform(a, b) for a, b in zip(low, high, strict=True)])

    def zero(self, random: Random) -> np.ndarray:
        """A point on the surface, to rounding."""
        return self.zeros[random.randrange(len(self.zeros))]

    def cell(self, random: Random, number: int) -> list[np.ndarray]:
        """Some of the corners of a cell."""
        if not self.partition.cells:
            return [self.corners[i] for i in random.sample(range(8), number)]
        return [self.corners[i] for i in random.sample(random.choice(self.partition.cells), number)]


def of_polynomial(text: str, half: float = 2) -> Target:
    """A polynomial in a box."""
    box = pas.SingleCell((-half,) * 3, (half,) * 3)
    return Target(pas.PiecewiseSurface.from_polynomials(box, (), 0, [text]))


def node() -> Target:
    contacts = [((1, 0, 0), 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")]
    return Target(pas.node(contacts, order=1).surface)


def torn() -> Target:
    """Pieces that do not meet in the faces between them."""
    texts = [f"{SPHERE} + {i}/8*(x + y*z) + {i}/16" for i in range(6)]
    return Target(pas.PiecewiseSurface.from_polynomials(pas.SixTetrahedra(), (), 0, texts))


def far() -> Target:
    text = "(x - 1000000)^2 + (y + 7)^2 + (z - 1/3)^2 - 1/9"
    box = pas.SingleCell((999999, -8, -1), (1000001, -6, 1))
    return Target(pas.PiecewiseSurface.from_polynomials(box, (), 0, [text]))


def opened() -> Target:
    parts = [pas.Plate((0, 0, 1), radius=2), pas.Pipe((0, 0, 1), 1, clip="auto")]
    return Target(pas.blend(parts, 1).surface)


TARGETS: dict[str, Callable[[], Target]] = {
    "corner": lambda: Target(solved(UNEQUAL, 2).surface),
    "node": node,
    "open region": opened,
    "torus in a box": lambda: of_polynomial(TORUS),
    "torus": lambda: Target(TORUS),
    "doubled sphere in a box": lambda: of_polynomial(f"({SPHERE})^2*(x - 1/3)"),
    "doubled cylinder": lambda: Target("(x^2 + y^2 - 1)^2*(z - 1/4)"),
    "planes of the box": lambda: of_polynomial("(x - 1)*(y + 1/2)*z", 1),
    "torn": torn,
    "far away": far,
    "tiny": lambda: of_polynomial(f"({SPHERE})/1{'0' * 312}"),
}


@cache
def target(name: str) -> Target:
    return TARGETS[name]()


def some_way(random: Random) -> np.ndarray:
    return np.array([random.gauss(0, 1) for _ in range(3)])


def short_way(random: Random) -> np.ndarray:
    """A direction of small whole numbers: sums of it with short numbers are exact."""
    while True:
        way = np.array([float(random.randint(-4, 4)) for _ in range(3)])
        if way.any():
            return way


def nudged(point: np.ndarray, random: Random) -> np.ndarray:
    """A point, or one a few doubles beside it."""
    steps = random.choice((0, 0, 1, 10, 1000))
    spacings = np.spacing(np.abs(point).max())
    return point + np.array([random.randint(-steps, steps) for _ in range(3)]) * spacings


def ordinary(aim: Target, random: Random) -> Ray:
    place = aim.place(random)
    origin = place + random.choice((0.1, 1, 3)) * aim.size * some_way(random)
    return origin.tolist(), (place - origin).tolist()


def tangent(aim: Target, random: Random) -> Ray:
    """At a point of the surface, along it."""
    point = aim.zero(random)
    way = np.cross(aim.evaluator.gradients(point), some_way(random))
    if not np.isfinite(way).all() or not way.any():
        way = some_way(random)
    way /= np.abs(way).max()
    origin = nudged(point - random.choice((0.0, 0.5, 2.0, 8.0)) * aim.size * way, random)
    return origin.tolist(), way.tolist()


def through_edges(aim: Target, random: Random) -> Ray:
    """Through a corner, or a point of an edge or face of a cell, in many cases exactly."""
    corners = aim.cell(random, random.choice((1, 2, 3)))
    weights = {1: (1.0,), 2: (0.5, 0.5), 3: (0.5, 0.25, 0.25)}[len(corners)]
    point = sum(w * c for w, c in zip(weights, corners, strict=True))
    way = random.choice((short_way, some_way))(random)
    return nudged(point - random.choice((0, 1, 2, 4)) * way, random).tolist(), way.tolist()


def along_faces(aim: Target, random: Random) -> Ray:
    """In a face or an edge of a cell, exactly where corners are short numbers."""
    a, b, c = aim.cell(random, 3)
    way = b - a if random.random() < 0.4 else b - a + random.choice((0.5, -0.5, 1)) * (c - a)
    start = a + random.choice((0, 0.25)) * (c - a)
    return nudged(start - random.choice((0, 1, 2, -0.25)) * way, random).tolist(), way.tolist()


def from_the_surface(aim: Target, random: Random) -> Ray:
    exact = ([1.0, 0, 0], [0, -1.25, 0], [0.75, 0, 0], [0.25, 1, 0], [0, 0, 0])
    if random.random() < 0.3:
        return random.choice(exact), short_way(random).tolist()
    return nudged(aim.zero(random), random).tolist(), some_way(random).tolist()


def from_far(aim: Target, random: Random) -> Ray:
    """From as far as doubles know their place, at the surface, a corner or anything."""
    aims = (aim.zero(random), aim.place(random), aim.cell(random, 1)[0])
    point, way = random.choice(aims), random.choice((some_way, short_way))(random)
    way /= random.choice((1.0, np.abs(way).max()))
    far = 10.0 ** random.uniform(3, 15) if random.random() < 0.9 else ldexp(1, random.randint(50, 300))
    return (point - far * aim.size * way).tolist(), way.tolist()


def long_and_short(aim: Target, random: Random) -> Ray:
    """With directions of any size that doubles have, or that have coordinates of very different sizes."""
    origin, way = random.choice((ordinary, tangent, through_edges, from_the_surface))(aim, random)
    if random.random() < 0.3:
        way[random.randrange(3)] *= 10.0 ** random.uniform(random.choice((-30, -20, -20)), 0)
    if random.random() < 0.05:
        way = [random.choice((1.0, 1e-30, 1e-320)) * v for v in way]
    size = max(map(abs, way))
    if random.random() < 0.5:
        return origin, [v / size * 10.0 ** random.uniform(-300, 300) for v in way]
    power = random.randint(-1000, 1000)
    return origin, [ldexp(v / size, power) for v in way]


def at_the_boundary(aim: Target, random: Random) -> Ray:
    """Along the region's box, within rounding, or to the surface's points that are near it."""
    low, high = aim.corners.min(axis=0), aim.corners.max(axis=0)
    origin, way, axis = aim.place(random), some_way(random), random.randrange(3)
    origin[axis], way[axis] = random.choice((low, high))[axis], random.choice((0.0, 0.0, 2.0**-50, -(2.0**-40)))
    return nudged(origin - random.choice((0, 2)) * way, random).tolist(), way.tolist()


def from_the_centre(aim: Target, random: Random) -> Ray:
    center = aim.partition.center
    start = np.array([float(v.p) / float(v.q) for v in center]) if center is not None else np.zeros(3)
    if random.random() < 0.5:
        start += 10.0 ** random.uniform(-320, -10) * some_way(random)
    way = random.choice((some_way, short_way))(random)
    return start.tolist(), way.tolist()


def through_double_roots(aim: Target, random: Random) -> Ray:
    """Nearly touching: two roots so close to one another that doubles tell them apart hardly or not."""
    origin, way = tangent(aim, random)
    gap = 10.0 ** random.uniform(-17, -2) * aim.size
    return (np.array(origin) + gap * some_way(random)).tolist(), way


FAMILIES: dict[str, Callable[[Target, Random], Ray]] = {
    "ordinary": ordinary,
    "tangent": tangent,
    "through edges": through_edges,
    "along faces": along_faces,
    "from the surface": from_the_surface,
    "from far": from_far,
    "long and short": long_and_short,
    "at the boundary": at_the_boundary,
    "from the centre": from_the_centre,
    "double roots": through_double_roots,
}
