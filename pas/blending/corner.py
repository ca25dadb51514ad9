"""From two or three pipes (or contacts) to the six-tetrahedra corner, or one sentence why not.

Served are contacts whose clip planes are mutually perpendicular and whose surfaces have a common centre (the
common point of the axes of pipes and cones; of others, where all gradients vanish), in any position, orientation
and scale.  Two of them make an elbow: the third leg, which carries nothing, is as long as the longer of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from math import sqrt

from flint import fmpq, fmpq_mat

from pas.algebra.affine import center_equations, slope_at
from pas.algebra.matrices import solved
from pas.algebra.rational import Vector, cross, dot, listed, minus, moved, plain, rational, three, to_float
from pas.contacts.contact import Contact
from pas.contacts.endless import Circular
from pas.contacts.joins import Join
from pas.errors import GeometryError
from pas.partition.boxes import SixTetrahedra

OTHERS = "for others give a partition, such as partition=pas.SingleCell(lower, upper), a box with the clips as sides"
"""The advice for contacts that make no corner."""


def six_tetrahedra(items: Sequence[Circular | Contact]) -> SixTetrahedra:
    """The six-tetrahedra corner whose clip planes are those of two or three contacts; of pipes and cones the axes are
    known."""
    if len(items) not in (2, 3):
        raise GeometryError(f"the six-tetrahedra corner joins two or three pipes, not {len(items)}; {OTHERS}")
    contacts = [item.contact for item in items]
    normals = [_normal(i + 1, c) for i, c in enumerate(contacts)]
    for (i, a), (j, b) in combinations(enumerate(normals, start=1), 2):
        if all(c == 0 for c in cross(a, b)):
            raise GeometryError(
                f"pipes {i} and {j} are parallel, and the six-tetrahedra corner needs perpendicular directions; "
                f"{OTHERS}"
            )
        if dot(a, b) != 0:
            cosine = to_float(dot(a, b)) / sqrt(to_float(dot(a, a) * dot(b, b)))
            raise GeometryError(
                f"the axes of pipes {i} and {j} are not perpendicular (cosine {cosine:.3g}), as the six-tetrahedra "
                f"corner needs; {OTHERS}"
            )
    center = _center(items)
    legs: list[Vector] = []
    for number, (contact, normal) in enumerate(zip(contacts, normals, strict=True), start=1):
        height = contact.clip.raw(*center)
        if height == 0:
            raise GeometryError(
                f"the clip plane of pipe {number} passes through the centre "
                f"({listed(center)}); it must leave room for the blend"
            )
        legs.append(three(-height / dot(normal, normal) * n for n in normal))
    if len(legs) == 2:
        legs.append(_third(legs[0], legs[1]))
    return SixTetrahedra(center, legs)


def _third(first: Vector, second: Vector) -> Vector:
    """A leg across two others, about as long as the longer one."""
    across = cross(first, second)
    length = sqrt(to_float(max(dot(first, first), dot(second, second))) / to_float(dot(across, across)))
    # Of the share by which the third leg of an elbow is made as long as the others, where that is no fraction.
    largest_denominator = 1000
    share = rational(Fraction(length).limit_denominator(largest_denominator))
    return three(share * c for c in across)


def _normal(number: int, contact: Contact) -> Vector:
    if contact.clip.degree != 1:
        raise GeometryError(
            f"the clip {contact.clip} of contact {number} is not a plane, as the six-tetrahedra corner needs; {OTHERS}"
        )
    return slope_at(contact.clip)


def _center(items: Sequence[Circular | Contact]) -> Vector:
    """The point on all axes, or for surfaces without one, at which the gradients vanish."""
    rows, zero = list[list[fmpq]](), fmpq(0)
    for number, item in enumerate(items, start=1):
        if isinstance(item, Circular):
            # on the axis, `axis x (p - point) = 0`
            (a, b, c), (u, v, w) = item.axis, cross(item.axis, item.point)
            rows += [[zero, -c, b, u], [c, zero, -a, v], [-b, a, zero, w]]
            continue
        if item.surface.degree != 2:
            raise GeometryError(
                f"surface {number} is of degree {item.surface.degree}, so the corner's centre is not "
                "known; give the partition, such as pas.SixTetrahedra(center, legs)"
            )
        rows += center_equations(item.surface)
    found = solved(fmpq_mat(rows))
    if found is None:
        raise GeometryError(_apart(items))
    if len(found[1]) < 3:
        raise GeometryError("the surfaces have more than one common centre; give the partition")
    return three(found[0])


def _apart(items: Sequence[Circular | Contact]) -> str:
    """Which two axes miss one another, and by how much, or that there is no common centre."""
    pipes = [(number, item) for number, item in enumerate(items, start=1) if isinstance(item, Circular)]
    for (i, a), (j, b) in combinations(pipes, 2):
        common = cross(a.axis, b.axis)
        gap = to_float(dot(common, minus(b.point, a.point))) / sqrt(to_float(dot(common, common)))
        if gap != 0:
            return (
                f"the axes of pipes {i} and {j} miss each other by {abs(gap):.6g}; "
                "all of them must pass through a common point"
            )
    if len(pipes) == 3:
        return "the axes of the three pipes do not pass through a common point"
    return "the surfaces have no common centre; give the partition, such as pas.SixTetrahedra(center, legs)"


def check_circle(number: int, pipe: Circular, join: Join) -> None:
    """Raise `GeometryError`, saying by how much, where a pipe's circle does not fit the clip face."""
    clip = join.contact.clip
    foot = moved(pipe.point, (-clip.raw(*pipe.point) / dot(slope_at(clip), pipe.axis), pipe.axis))
    largest = min(_distance(foot, a, b) for a, b in join.rim())
    radius = to_float(pipe.radius)
    if radius >= largest:
        raise GeometryError(
            f"pipe {number}: its circle of radius {plain(pipe.radius)} does not fit its face of the partition "
            f"(it sticks out by {radius - largest:.4g}); the radius must be below {largest:.6g}, "
            "or the clips must be further out"
        )


def _distance(point: Vector, a: Vector, b: Vector) -> float:
    along = minus(b, a)
    normal = cross(along, minus(point, a))
    return sqrt(to_float(dot(normal, normal) / dot(along, along)))
