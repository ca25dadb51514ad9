"""Continuations of a surface from the loops in which it ends: strips of other surfaces, row by row, and their ends.

Sections of a quadric by parallel planes, where they are ellipses, are homothetic: their centres are on a line, a
diameter, and their sizes over one another are roots of a polynomial of degree 2 in the height (Salmon 1882).  So a loop
in the first plane gives one in each other plane, with all its vertices on the quadric.  Of a cylinder or a cone one
strip of long triangles does; what is bowed has as many rows as the tolerance needs.

Around an opening there are rays from the centre, and straight lines up to edges, walls and flat backs.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.affine import Frame, quadratic_form, slope_at
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, dot, to_float, to_floats
from pas.algebra.scaling import scaled
from pas.arrays import Floats, Integers
from pas.contacts.cones import first_met
from pas.contacts.contact import Contact
from pas.errors import GeometryError
from pas.solid.faces import End, Faces, off_surface

Rows = Callable[[Floats, float], Floats]
"""From the points (N, 3) of a loop to those of the loop a share of the way along a strip: the strip's end with 1."""


@dataclass(frozen=True, eq=False)
class Sections:
    """Rows of a quadric between two parallel planes: centres are `start + share step`, and sizes over the first the
    root of `1 + share b + share^2 c`, with `growth = (b, c)`."""

    start: Floats
    step: Floats
    growth: tuple[float, float]

    @classmethod
    def of(
        cls, surface: Polynomial, plane: Polynomial, cap: Polynomial, center: Vector | None = None
    ) -> Sections | None:
        """Those of a surface from `plane` on, positive on the strip's side, to `cap`, its parallel, whose sections are
        ellipses.

        None where the surface is no quadric, ends before the cap, is not convex there, as a hyperboloid of one sheet,
        or has `center` not inside on the same sheet.  With squared sizes a + b t + c t^2 at a height t, a sheet is
        convex where b^2 >= 4 a c, and there are two of them where c > 0, on both sides of where the sizes are least.
        """
        if surface.degree != 2:
            return None
        matrix, high = quadratic_form(surface), (plane - cap).raw.leading_coefficient()
        normal = slope_at(plane)
        system = fmpq_mat([[*(matrix[i, j] for j in range(3)), -normal[i]] for i in range(3)] + [[*normal, fmpq(0)]])
        along = dot(normal, tuple(dot(matrix.tolist()[i][:3], normal) for i in range(3)))
        across = dot(normal, normal) * sum(matrix[i, i] for i in range(3)) - along
        if system.det() <= 0 or across <= 0:  # determinant and trace of the form in the plane
            return None
        heights = [t * high - plane.raw(0, 0, 0) for t in (fmpq(0), fmpq(1, 2), fmpq(1))]
        known = [fmpq_mat(4, 1, [*(-matrix[i, 3] for i in range(3)), h]) for h in heights]
        places = [system.solve(side).entries()[:3] for side in known]
        first, middle, last = (-surface.raw(*place) for place in places)
        c = 2 * (first + last - 2 * middle)
        b = last - first - c
        if first <= 0 or last <= 0 or b * b < 4 * first * c:
            return None
        levels = [fmpq(0), fmpq(1)] if center is None else [fmpq(0), fmpq(1), plane.raw(*center) / high]
        outside = center is not None and surface.raw(*center) > 0
        if outside or (c > 0 and min(levels) <= -b / (2 * c) <= max(levels)):
            return None
        start, end = (np.array(to_floats(places[i])) for i in (0, 2))
        return cls(start, end - start, (to_float(b / first), to_float(c / first)))

    def __call__(self, points: Floats, share: float) -> Floats:
        b, c = self.growth
        size = np.sqrt(max(1 + share * (b + share * c), 0.0))
        return np.asarray(self.start + share * self.step + size * (points - self.start))


@dataclass(frozen=True, eq=False)
class Straight:
    """Rows on straight lines up to a `target` of degree 1 or 2, negative before it and positive beyond.

    Lines go away from a `pole`, or towards it; in homogeneous coordinates (4,), so that it may be at infinity.
    """

    target: Polynomial
    pole: Floats
    towards: bool = True

    def __call__(self, points: Floats, share: float) -> Floats:
        ways = self.pole[:3] - self.pole[3] * points
        ways = ways if self.towards else -ways
        at, slope = self.target(points), (self.target.gradient(points) * ways).sum(axis=-1)
        bend = self.target(points + ways) - at - slope
        steps = -2 * at / (slope + np.sqrt(np.maximum(slope * slope - 4 * bend * at, 0.0)))
        return np.asarray(points + share * steps[:, None] * ways)


@dataclass(frozen=True, eq=False)
class Outwards:
    """Rows of a surface where rays from the centre first meet it, straight away from `axis` up to a cone `edge`.

    The surface, the axis (3,) and the edge are in the local coordinates of a frame, whose centre is 0.
    """

    surface: Polynomial
    frame: Frame
    axis: Floats
    edge: Polynomial

    def __call__(self, points: Floats, share: float) -> Floats:
        local = self.frame.local_points(points)
        pole = np.array([*self.axis / (self.axis @ self.axis), 1.0])
        rays = Straight(self.edge, pole, towards=False)(local / (local @ self.axis)[:, None], share)
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        return self.frame.global_points(rays * first_met(self.surface, rays)[:, None])


@dataclass(frozen=True, eq=False)
class SolidStrip:
    """A face from one loop to another; the `surface` is negative inside."""

    name: str
    surface: Polynomial
    rows: Rows


@dataclass(frozen=True, eq=False)
class Chain:
    """The continuation of a contact: strips one after the other from its `curve`, points (N, 3) in order, up to an end.

    `clip` is where the blend ends, seen along its axis from the strips.  `end` is a plane, or seen from its apex a
    cone, with the face `name`.  All of it is where `floor` is negative.
    """

    contact: Contact
    clip: End
    curve: Floats
    strips: tuple[SolidStrip, ...]
    end: End
    name: str
    floor: Polynomial | None = None

    def off(self, points: Floats) -> float:
        """The largest first-order distance of points (N, 3) from the curve in which it begins."""
        return max(self.clip.off(points), float(off_surface(self.contact.surface, points).max()))

    @cached_property
    def loops(self) -> tuple[Floats, ...]:
        """The curve, and the loop in which each strip ends."""
        found = [self.curve]
        for strip in self.strips:
            found.append(strip.rows(found[-1], 1.0))
        return tuple(found)

    @cached_property
    def bowed(self) -> tuple[bool, ...]:
        """Which strips are curved along their length."""
        ends = zip(self.strips, self.loops, self.loops[1:], strict=False)
        middles = [(strip.rows(a, 0.5) - (a + b) / 2, np.ptp(b)) for strip, a, b in ends]
        linear = 2.0**-30  # over the size of a strip: what is off by less half way along it is straight, to rounding
        return tuple(bool(np.abs(off).max() > linear * size) for off, size in middles)

    @cached_property
    def stretch(self) -> float:
        """The largest ratio, at least 1, of the chord errors of later loops to those of the first; twice that with
        bowed strips, which leave half of the tolerance to the bow."""
        sags = [
            np.linalg.norm(np.roll(p, 1, axis=0) + np.roll(p, -1, axis=0) - 2 * p, axis=1).max() for p in self.loops
        ]
        return max(1.0, *(s / sags[0] for s in sags)) * (2.0 if any(self.bowed) else 1.0)

    @property
    def sound(self) -> bool:
        """Whether all loops exist and are above the floor."""
        points = np.concatenate(self.loops)
        return bool(np.isfinite(points).all() and (self.floor is None or (self.floor(points) < 0).all()))

    def holds(self, inner: Chain) -> bool:
        """Whether the strips of an inner chain are inside these, beside which they run, by samples."""
        if len(self.strips) != len(inner.strips) > 0:
            return False
        shares, here = np.linspace(0, 1, 9), inner.curve
        for mine, other in zip(self.strips, inner.strips, strict=False):
            rows = [other.rows(here, float(share)) for share in shares]
            if not (mine.surface(np.concatenate(rows)) < 0).all():
                return False
            here = rows[-1]
        return True


def chain_between(
    contact: Contact, plane: Polynomial, cap: Polynomial, names: tuple[str, str], center: Vector | None = None
) -> Chain | None:
    """The continuation of a contact between parallel planes, with the names of its face and its end; see `Sections`."""
    axis, strips = unit(scaled(plane).gradient(np.zeros(3))), tuple[SolidStrip, ...]()
    if cap != plane:
        rows = Sections.of(contact.surface, plane, cap, center)
        if rows is None:
            return None
        strips = (SolidStrip(names[0], contact.scaled.surface, rows),)
    try:
        curve = Contact(contact.surface, plane, contact.near).rim.points()
    except GeometryError:  # no curve that is known to be closed
        return None
    begin, end = (End(scaled(side), axis) for side in (plane, cap))
    return Chain(contact.scaled, begin, curve, strips, end, names[1])


def go_on(
    made: Faces, chains: Sequence[Chain], loops: list[Integers], tolerance: float, without: Collection[int] = ()
) -> bool:
    """Add the strips of chains, but for some by number, each from a loop of a mesh, which its end loop then replaces;
    whether all are within a tolerance, as measured."""
    most_rows = 2**10  # a thousandth of a strip's length is finer than any tolerance in use needs
    for number, strip in ((n, strip) for n, chain in enumerate(chains) if n not in without for strip in chain.strips):
        begin, many = made.points[loops[number]], 1
        rows = [strip.rows(begin, 1.0)]
        while not off_strip(strip.surface, [begin, *rows]) <= tolerance:
            many *= 2
            if many > most_rows:
                return False
            rows = [strip.rows(begin, (k + 1) / many) for k in range(many)]
        every = [loops[number], *map(made.added, rows)]
        made.put_side(strip.name, [np.append(row, row[0]) for row in every[::-1]], strip.surface.jets)
        loops[number] = every[-1]
    return True


def off_strip(surface: Polynomial, rows: Sequence[Floats]) -> float:
    """The largest first-order distance of the triangles between rows, at the middles of their edges, from a surface."""
    found = 0.0
    for here, there in pairwise(rows):
        across = [(here + there) / 2, (np.roll(here, -1, axis=0) + there) / 2]
        along = [(row + np.roll(row, -1, axis=0)) / 2 for row in (here, there)]
        found = max(found, *(float(off_surface(surface, points).max()) for points in (*across, *along)))
    return found
