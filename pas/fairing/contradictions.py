"""Wishes that no member of any degree can meet: found exactly, before anything is solved.

A point has one sign.  A surface that is proved has its partition's centre inside, is crossed once by
each ray from there, and leaves the region through its contacts only: so along a ray points inside
come first, then at most one on the surface, then points outside; points of a wall are outside; on a
clip face the contact says what is inside, and a ray that leaves there through the inside is inside all the way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product

from flint import fmpq, fmpq_mat

from pas.algebra.monomials import count
from pas.algebra.rational import Vector, cross, dot, listed, minus, plain
from pas.contacts.joins import Join
from pas.errors import InfeasibleError
from pas.fairing.functionals import b_coefficient, value_at
from pas.fairing.wishes import ValueAt, Wishes
from pas.partition.cells import Partition
from pas.partition.complex import OuterFace
from pas.piecewise import PiecewiseSurface
from pas.surface.placed import PlacedContacts

INSIDE, ON, OUTSIDE = -1, 0, 1
"""The signs of f."""


@dataclass(frozen=True)
class Wish:
    """A wish for a point: the signs of f that meet it."""

    name: str
    point: Vector
    signs: frozenset[int]


def check_wishes(wishes: Wishes, placed: PlacedContacts) -> None:
    """Raises `InfeasibleError`, which names the wishes, where some contradict by themselves.

    A surface that need not pass its proofs only needs to have one sign at a point.
    """
    points = list(_wishes(wishes))
    center = placed.partition.center if wishes.prove else None
    if wishes.prove:
        for wish in points:
            for sign, reason in _known(wish.point, placed):
                if sign not in wish.signs:
                    raise InfeasibleError(f"the constraint {wish.name} cannot be met: {reason}", [wish.name])
    for pair in combinations(points, 2):
        clash = _contradiction(*pair, center)
        if clash:
            names = [wish.name for wish in pair]
            raise InfeasibleError(f"the constraints {', '.join(names)} contradict one another: {clash}", names)


def check_kept(wishes: Wishes, surface: PiecewiseSurface) -> None:
    """Raises `ValueError`, which names the wish, where a surface has not the signs at points or the handles wished for.

    Points that it may pass through by a margin of 0 are met to rounding, and are not looked at.
    """
    rows = [fmpq_mat(1, count(surface.degree), patch.row(surface.degree)) for patch in surface.patches]
    for wish in _wishes(wishes):
        (value,) = value_at(surface.partition, wish.point, surface.degree, wish.name).on(rows)
        if _sign(value) not in wish.signs and len(wish.signs) == 1:
            raise ValueError(f"the constraint {wish.name} is not met by the surface")
    for number, (handle, wanted) in enumerate(wishes.handles):
        if b_coefficient(surface.partition, handle, surface.degree).on(rows) != [wanted]:
            name = wishes.describe(("handles", number))
            raise ValueError(f"the constraint {name} is not met by the surface")


def _wishes(wishes: Wishes) -> Iterator[Wish]:
    edge = {ON} if wishes.margin == 0 else set()
    signs = {"inside": {INSIDE} | edge, "through": {ON}, "outside": {OUTSIDE} | edge}
    for kind, index in wishes.hard():
        if kind in signs:
            point = getattr(wishes, kind)[index]
            yield Wish(wishes.describe((kind, index)), point, frozenset(signs[kind]))
    normalize = wishes.normalize
    if isinstance(normalize, ValueAt):
        name = f"value {plain(normalize.value)} at ({listed(normalize.point)})"
        yield Wish(name, normalize.point, frozenset({_sign(normalize.value)}))


def _known(point: Vector, placed: PlacedContacts) -> Iterator[tuple[int, str]]:
    """Signs that a proved surface has at a point, with the reason."""
    partition = placed.partition
    if partition.center is not None and point == partition.center:
        yield INSIDE, f"the centre ({listed(point)}) of the partition, from which one sheet is proved, must be inside"
    local = partition.frame.local_point(point)
    for number, join in enumerate(placed.joins, start=1):
        if any(_holds(face, placed.local, local) for face in join.faces):
            yield _sign(join.contact.surface.raw(*local)), f"on that clip face contact {number} says what is inside"
        if partition.center is not None and any(_leaves_inside(join, face, placed.local, local) for face in join.faces):
            yield INSIDE, f"the ray from the centre through it leaves the region through the inside of contact {number}"
    if any(_holds(face, placed.local, local) for face in placed.walls):
        yield OUTSIDE, "on the walls of the region all points are outside, since the surface leaves it by its contacts"


def _contradiction(first: Wish, second: Wish, center: Vector | None) -> str | None:
    """Why two wishes cannot both hold, or None."""
    if first.point == second.point:
        return None if first.signs & second.signs else "a point has one sign"
    if center is None:
        return None
    a, b = minus(first.point, center), minus(second.point, center)
    if any(c != 0 for c in cross(a, b)) or dot(a, b) <= 0:
        return None
    nearer, farther = (first, second) if dot(a, a) < dot(b, b) else (second, first)
    if any(low == INSIDE or high == OUTSIDE for low, high in product(nearer.signs, farther.signs)):
        return None
    return f"a ray from the centre ({listed(center)}) of the partition goes from inside to outside once"


def _leaves_inside(join: Join, face: OuterFace, partition: Partition, point: Vector) -> bool:
    """Whether the ray from 0 to a point goes on to points of a face that are inside of the contact, or on it."""
    start, there = face.plane.raw(0, 0, 0), face.plane.raw(*point)
    if there <= start:
        return False
    x, y, z = (-start / (there - start) * c for c in point)
    beyond = -start > there - start
    return beyond and _holds(face, partition, (x, y, z)) and join.contact.surface.raw(x, y, z) <= 0


def _holds(face: OuterFace, partition: Partition, point: Vector) -> bool:
    if face.plane.raw(*point) != 0:
        return False
    arms = [minus(corner, point) for corner in partition.corners(face.vertices)]
    turns = [cross(arms[i], arms[(i + 1) % 3]) for i in range(3)]
    return all(dot(one, other) >= 0 for one, other in combinations(turns, 2))


def _sign(value: fmpq) -> int:
    return int(value > 0) - int(value < 0)
