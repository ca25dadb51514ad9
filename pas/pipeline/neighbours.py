"""The continuation of a blend in its solid: the part of each neighbour that is joined to it, proved to be one piece.

A neighbour, f <= 0, goes on from its clip as far as a plane parallel to that, and the slab between the two planes may
hold more of it than what meets the blend: the far side of a torus, the other nappe of a cone.  With the height t over
the clip, up to T, and sections by planes of one height:

Degree 2, with sections that are discs, as a closed curve has (its form in the plane is definite): the least value q of
f in a section is a polynomial of degree 2 in t, exact.  The heights with q <= 0 are one interval from 0 on, unless q
rises to 0 or more and falls again before T.

Other degrees: a cylinder w = 0 across the clip, inside of it w < 0, keeps apart what is elsewhere, and it is proved
that in the slab

- f > 0 on the cylinder,
- f > 0 inside the cylinder on the clip beyond the clip faces, where the blend ends,
- the gradient of f has a part along the sections wherever f = 0 inside the cylinder.

So the sections inside the cylinder change by an isotopy with t (Milnor 1963), and all of the first is in clip faces.

Around an opening: the neighbour between the opening's cone and a wider one, w <= 0, is cut off by a plane at a height H
above it, and it is proved that on the rays of the wider cone f < 0 at the height of its back, f > 0 at H, and that f
rises wherever it is 0.  So each ray leaves it once.

All by Bernstein forms with rounding counted (see `pas.bernstein.signs`).  What cannot be proved is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from flint import fmpq, fmpq_poly

from pas.algebra.affine import away, height, slope_at
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, cross, dot, exact, minus, moved, three, to_float, to_floats, two_across
from pas.arrays import Bools, Floats
from pas.bernstein.signs import alike
from pas.certify.nesting import prove_inside
from pas.certify.proofs import radial_derivative
from pas.contacts.joins import Join
from pas.errors import GeometryError
from pas.partition.boxes import KUHN_CELLS
from pas.piecewise import PiecewiseSurface
from pas.verdicts import Status

ACROSS, ALONG, WIDE = 41, 17, 4.0
"""Samples across a neighbour and along it, by which the cylinder's radius is chosen, and how far they reach from the
middle of its curve, over the curve's radius."""

BEYOND = fmpq(21, 20)
"""How much larger than the cylinder the box is in which it is looked at."""

NOTHING = fmpq(0)

ROUNDED = fmpq(1, 2**40)
"""By which part slabs are taken higher, as a cap's height is rounded."""

Positive = tuple[Polynomial, tuple[Polynomial, ...]]
"""A polynomial that is to be positive where no other one is."""


def separators(
    surface: PiecewiseSurface, number: int, name: str, length: fmpq, beyond: fmpq = NOTHING
) -> tuple[Polynomial, ...]:
    """What keeps the part of contact `number` (from 0), called `name`, apart from the rest of its surface: polynomials
    that are positive there, in the user's coordinates.

    The part is that up to `length + beyond` (the model's units) over its plane clip face, of which `length` was asked
    for.  Raises `GeometryError` where it is not proved that this part is one piece with the blend.
    """
    join, frame = surface.joins[number], surface.partition.frame
    slab = Slab(join, (length + beyond) / frame.scale)
    if join.contact.surface.degree == 2:
        comes_back = slab.comes_back()
        if comes_back is None:
            return ()
        # Of the least length that does not work: its four digits, rounded, are those of one that does.
        advised = 1 - 5e-4
        raise GeometryError(
            f"{name} comes back within {to_float(length):.4g} of its clip; take a length of at most "
            f"{advised * to_float(comes_back * frame.scale - beyond):.4g}"
        )
    radius = slab.radius()
    if radius is None or not slab.is_one_piece(radius):
        raise GeometryError(
            f"{name} is not proved to go on in one piece for {to_float(length):.4g} beyond its clip; "
            "take a shorter length, or compose the solid with pas.solid.patch"
        )
    return (-frame.globalise(slab.cylinder(radius)),)


class Slab:
    """The slab between a plane clip face and a height of `length` over it, in local coordinates."""

    def __init__(self, join: Join, length: fmpq) -> None:
        self.join, self.surface, self.plane = join, join.contact.surface, join.planes[0].plane
        self.normal = slope_at(self.plane)
        square = dot(self.normal, self.normal)
        self.size = exact(float(np.sqrt(to_float(square))))  # of the normal, rounded as that of the cap is
        self.top = length * self.size / square * (1 + ROUNDED)
        self.across = tuple(three(c / _length(way) for c in way) for way in two_across(self.normal))
        curve = join.curve()
        low, high = curve.min(axis=0), curve.max(axis=0)
        near: Vector = tuple(exact(float(c)) for c in (low + high) / 2)  # type: ignore[assignment]
        self.middle = moved(near, (-self.plane.raw(*near) / square, self.normal))
        self.reach = float(np.linalg.norm(curve - to_floats(self.middle), axis=1).max())

    def comes_back(self) -> fmpq | None:
        """For degree 2: the height at which the joined part ends and another begins before the top; None for none."""
        u, v, t = GENERATORS
        places = zip(self.middle, *self.across, self.normal, strict=True)
        raw = self.surface.raw.compose(*(m + a * u + b * v + n * t for m, a, b, n in places))
        terms = Polynomial.from_raw(raw).raw.to_dict()
        a, b, c = (terms.get(e, fmpq(0)) for e in ((2, 0, 0), (1, 1, 0), (0, 2, 0)))
        det = 4 * a * c - b * b
        if a <= 0 or det <= 0:
            raise GeometryError("a neighbour of degree 2 whose sections are no discs does not end in a closed curve")
        p, q, r = (fmpq_poly([terms.get((*e, i), fmpq(0)) for i in range(3)]) for e in ((1, 0), (0, 1), (0, 0)))
        # f is least where its slope along the section is 0
        least = r - (c * p * p - b * p * q + a * q * q) / det
        if least[2] >= 0:
            return None
        turn = -least[1] / (2 * least[2])
        if not 0 < turn < self.top or least(turn) < 0 or least(self.top) > 0:
            return None
        first = turn - exact(float(np.sqrt(to_float(-least(turn) / least[2]))))
        return first * dot(self.normal, self.normal) / self.size

    def radius(self) -> fmpq | None:
        """A radius for the cylinder, between the sections joined to the clip faces and everything else, by samples."""
        from scipy.ndimage import label

        ways = np.array([to_floats(v) for v in self.across])
        units = ways / np.linalg.norm(ways, axis=1)[:, None]
        line = np.linspace(-WIDE, WIDE, ACROSS) * self.reach
        heights = np.linspace(0, to_float(self.top), ALONG)
        x, y, t = np.meshgrid(line, line, heights, indexing="ij")
        points = to_floats(self.middle) + x[..., None] * units[0] + y[..., None] * units[1]
        points = points + t[..., None] * to_floats(self.normal)
        inside = self.surface(points.reshape(-1, 3)).reshape(x.shape) < 0
        parts, _ = label(inside)
        found = np.unique(parts[..., 0][self._in_faces(points[:, :, 0].reshape(-1, 3)).reshape(ACROSS, ACROSS)])
        joined = inside & np.isin(parts, found[found > 0])
        away = np.hypot(x, y)
        if not joined.any():
            return None
        far, near = float(away[joined].max()), float(away[inside & ~joined].min(initial=np.inf))
        step = 2 * WIDE * self.reach / (ACROSS - 1)
        if near <= far + step or far > (WIDE - 1) * self.reach:
            return None
        # Over the distance of the neighbour from the middle: the cylinder's radius where nothing else is near.
        room = 1.5
        return exact(min(room * max(far, self.reach), (far + near) / 2))

    def _in_faces(self, points: Floats) -> Bools:
        """Which points (N, 3) of the plane are in the clip faces."""
        inside = np.zeros(len(points), dtype=bool)
        for face in self.join.faces:
            corners = self.join.partition.points[list(face.vertices)]
            weights = np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), np.vstack([points.T, np.ones(len(points))]))
            inside |= weights[0].min(axis=0) > 0
        return inside

    def cylinder(self, radius: fmpq) -> Polynomial:
        """The cylinder across the clip around the middle, negative inside."""
        along, square = height(self.middle, self.normal), dot(self.normal, self.normal)
        raw = square * sum((d * d for d in away(self.middle)), 0 * along) - along * along
        return Polynomial.from_raw(raw - square * radius * radius)

    def is_one_piece(self, radius: fmpq) -> bool:
        """Whether it is proved that the cylinder holds the part joined to the clip faces, and nothing else."""
        f, cylinder = self.surface, self.cylinder(radius)
        ways = [tuple(BEYOND * radius * c / _length(way) for c in way) for way in self.across]
        ends = [moved(self.middle, *zip(signs, ways, strict=True)) for signs in product((-1, 1), repeat=2)]
        square = [ends[0], ends[1], ends[3], ends[2]]
        box = kuhn([square, [moved(corner, (self.top, self.normal)) for corner in square]])
        slope = [f.diff(i) for i in range(3)]
        turned = [
            a * self.normal[j] - slope[j] * self.normal[i]
            for (i, a), j in zip(enumerate(slope), (1, 2, 0), strict=True)
        ]
        along = turned[0] ** 2 + turned[1] ** 2 + turned[2] ** 2
        claims: list[tuple[Positive, Sequence[Sequence[Vector]]]] = [
            ((cylinder, ()), sides(square)),
            ((f, (cylinder, -cylinder)), box),
            ((along, (f, -f, cylinder)), box),
        ]
        inner = self.join.inside_point()
        for first, second in self.join.rim():
            edge = Polynomial.from_raw(height(first, cross(minus(second, first), self.normal)))
            edge = edge if inner is None or edge.raw(*inner) < 0 else -edge
            claims.append(((f, (-edge, cylinder)), halves(square)))
        return all(proved(claim, simplices) for claim, simplices in claims)


def is_left_once(surface: Polynomial, cone: Polynomial, floor: Sequence[Vector], roof: Sequence[Vector]) -> bool:
    """Whether it is proved that each ray from 0 in a cone, `cone <= 0`, leaves a surface once between two plane quads
    across it, four corners each in order on the same four rays, and from inside to outside."""
    rising = Polynomial.from_raw(radial_derivative(surface))
    claims: list[tuple[Positive, Sequence[Sequence[Vector]]]] = [
        ((cone, ()), sides(roof)),
        ((-surface, (cone,)), halves(floor)),
        ((surface, (cone,)), halves(roof)),
        ((rising, (surface, -surface, cone)), kuhn([floor, roof])),
    ]
    return all(proved(claim, simplices) for claim, simplices in claims)


def sides(quad: Sequence[Vector]) -> list[tuple[Vector, ...]]:
    """The edges of a quad."""
    return list(zip(quad, [*quad[1:], quad[0]], strict=True))


def halves(quad: Sequence[Vector]) -> list[tuple[Vector, ...]]:
    """A quad as two triangles."""
    return [tuple(quad[:3]), (quad[0], *quad[2:])]


def proved(claim: Positive, simplices: Sequence[Sequence[Vector]]) -> bool:
    """Whether a polynomial is proved to be positive where no other is, on simplices."""
    value, *others = (alike(p.raw, simplices) for p in (claim[0], *claim[1]))
    return prove_inside(simplices, value, others).status is Status.PROVED


def kuhn(quads: Sequence[Sequence[Vector]]) -> list[tuple[Vector, ...]]:
    """Six tetrahedra that fill a convex hexahedron, given by two opposite sides, corners in order (Kuhn 1960)."""
    corners = [quads[k][(0, 3)[i] if j == 0 else (1, 2)[i]] for i, j, k in product((0, 1), repeat=3)]
    return [tuple(corners[v] for v in cell) for cell in KUHN_CELLS]


def _length(vector: Vector) -> fmpq:
    """A rational number that is about the length of a vector."""
    return exact(float(np.linalg.norm(to_floats(vector))))
