"""The surfaces of fillets along a seam: the torus of a ball that rolls along a circle, and polynomials elsewhere.

With s and t the faces' polynomials over the heights in which the surface touches the other face and h = 1 - s - t, the
fillet is the part of it where s, t, h >= 0.

Torus: with R the distance from an axis and z the height along it, planes across it, cylinders, cones and spheres are

    round R^2 + square z^2 + slope z + constant = 0,

and so is what is parallel to them.  The ball's centre is where both surfaces parallel to the faces, by its radius,
meet: R^2 from one of them, and z from a quadratic equation.  All is exact, and taken where it is rational.  Where only
that equation has an irrational root, as beside a ball with an upright cylinder on it, the root is rounded and a radius
taken for which it is exact, within 1e-9 of the one that is asked for.

Polynomial of order k: mu s t = h^(k+1), with s and t the faces' polynomials over heights a and b, h = 1 - s - t.  It
has contact of order k with the faces f = 0 and g = 0 along g = b and f = a (Hoffmann and Hopcroft 1985, Warren 1989).
The heights are those at which a rolling ball touches the other face, in the mean along the edge; mu = 2 + 2 c with the
mean cosine c between normals, which makes the fillet of two planes a circular cylinder.  Not guaranteed: that the
fillet of curved faces is near a rolling ball's, which is no algebraic surface of such a degree.

Of even order that curve is turned about the axis, too, of a cylinder that stands on a plane: with t linear in R, it is
the norm A^2 - B^2 R^2 of mu s t - h^(k+1) = A + B R, as A - B R has one sign where s, t and h count.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import comb

from flint import fmpq

from pas.algebra.affine import away, height, slope_at
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, decimal, dot, minus, near, square_root, three, to_float, to_floats, two_across
from pas.contacts.parallels import axis_of_revolution, quadratic_terms
from pas.contacts.torus import torus_polynomial
from pas.solid.face_seams import FaceSeam, SmoothEnd
from pas.solid.joints import Joint
from pas.solid.rolling import touching
from pas.solid.sections import on_plane
from pas.solid.tree import Atom, Tree, combined


@dataclass(frozen=True)
class FilletForm:
    """A surface, not positive on the side of the seam, how high over each face it touches the other, polynomials that
    are positive where it counts, and whether it touches each face in a curve, not in a point."""

    surface: Polynomial
    heights: tuple[fmpq, fmpq]
    sides: tuple[Polynomial, ...] = ()
    curves: tuple[bool, bool] = (True, True)


Axis = tuple[Vector, Vector]
"""A point and a unit vector."""


@dataclass(frozen=True)
class Meridian:
    """A plane, cylinder, cone or sphere by its equation in R^2 and z."""

    round: fmpq
    square: fmpq
    slope: fmpq
    constant: fmpq

    @classmethod
    def of(cls, face: Polynomial, axis: Axis) -> Meridian | None:
        """The meridian of a face; None where it is no such surface about the axis."""
        point, way = axis
        side = two_across(way)[0]
        here, up, down, out, back = (
            face.raw(*(p + step * w for p, w in zip(point, to, strict=True)))
            for step, to in ((0, way), (1, way), (-1, way), (1, side), (-1, side))
        )
        found = cls((out + back - 2 * here) / (2 * dot(side, side)), (up + down) / 2 - here, (up - down) / 2, here)
        w, z = away(point), height(point, way)
        same = (dot(w, w) - z * z) * found.round + z * z * found.square + z * found.slope + found.constant
        bent = found.square not in (0, found.round) and found.slope**2 != 4 * found.square * found.constant
        return None if same != face.raw or bent or (found.square == 0 and found.slope * found.round != 0) else found

    def __call__(self, square: fmpq, z: fmpq) -> fmpq:
        """Its value at R^2 and z."""
        return self.round * square + self.square * z * z + self.slope * z + self.constant

    def parallel(self, depth: fmpq, at: float) -> Meridian | None:
        """The parallel surface so deep inside, of a cone the half with a given height; None where it is irrational."""
        if self.round == 0:
            return replace(self, constant=self.constant + depth * abs(self.slope))
        depth = depth if self.round > 0 else -depth
        if self.square in (0, self.round):
            square = self.slope**2 / (4 * self.round**2) - self.constant / self.round
            radius = square_root(square)
            moved = self.round * (square - (radius - depth) ** 2)
            return replace(self, constant=self.constant + moved) if radius >= depth and radius**2 == square else None
        spread, apex = -self.square / self.round, -self.slope / (2 * self.square)
        stretch = square_root((1 + spread) / spread) if spread > 0 else fmpq(0)
        if spread <= 0 or stretch**2 * spread != 1 + spread:
            return None
        apex += depth * stretch * (1 if at > to_float(apex) else -1)
        return replace(self, slope=-2 * self.square * apex, constant=self.square * apex**2)

    def foot(self, square: fmpq, z: fmpq, depth: fmpq) -> tuple[fmpq, fmpq] | None:
        """R^2 and z of the point outwards by a depth from one on this surface; None where they are irrational."""
        rise = 2 * self.square * z + self.slope
        length2 = 4 * self.round**2 * square + rise**2
        if length2 == 0:  # on the axis of a cylinder
            return depth**2, z
        length = square_root(length2)
        share = depth / length
        return (square * (1 + 2 * self.round * share) ** 2, z + rise * share) if length**2 == length2 else None


@dataclass(frozen=True, eq=False)
class FilletPiece:
    """The part that a fillet adds or takes away along one seam, with the name of its face."""

    face: str
    seam: FaceSeam
    radius: fmpq
    order: int

    @cached_property
    def form(self) -> FilletForm:
        """Its surface."""
        return form_of(self.seam, self.radius, self.order)

    def tree(self, walls: Sequence[Polynomial] = (), trims: Sequence[Atom] = ()) -> Tree:
        """The points between its surface and the edge, where walls are positive, too, and in other sets."""
        pairs = zip(self.seam.faces, self.form.heights, strict=True)
        s, t = (face * (self.seam.sign / height) for face, height in pairs)
        own = [s, t, *([1 - s - t] if self.order else []), *self.form.sides]
        sectors = [[Atom(-wall, "") for wall in sector] for sector in self.seam.sectors]
        where = [combined(True, *(combined(False, *some) for some in sectors))] if all(sectors) else []
        bounds = (Atom(-wall, "") for wall in (*own, *walls))
        return combined(False, Atom(self.form.surface, self.face), *trims, *bounds, *where)

    def claims(self) -> Iterator[Joint]:
        """The joints with both faces."""
        (f, g), (a, b), sign = self.seam.faces, self.form.heights, self.seam.sign
        along = (f, g - b * sign), (g, f - a * sign)
        for name, curve, there in zip(self.seam.names, along, self.form.curves, strict=True):
            for sector in self.seam.sectors if there else ():
                yield Joint(self.face, name, curve, self.order, (*(-wall for wall in self.ended), *sector))

    def section(self, end: SmoothEnd) -> tuple[Polynomial, Polynomial]:
        """The curve in which it continues at a smooth end: the plane, and its surface if the faces were flat there."""
        ends = zip(self.seam.names, end.names, self.seam.faces, strict=True)
        first, second = (face if name == following else end.tangent for name, following, face in ends)
        flat = form_of(replace(self.seam, faces=(first, second)), self.radius, self.order)
        return end.plane.primitive(), flat.surface.primitive()

    def goes_on(self, end: SmoothEnd) -> bool:
        """Whether its surface passes through that curve."""
        plane, section = self.section(end)
        f, g = (on_plane(surface, plane) for surface in (self.form.surface, section))
        return bool(not g.is_zero() and divmod(f, g)[1].is_zero())

    @property
    def ended(self) -> tuple[Polynomial, ...]:
        """The faces that end it, negative along it."""
        return self.seam.left if self.seam.sign > 0 else ()


def form_of(seam: FaceSeam, radius: fmpq, order: int) -> FilletForm:
    """The surface along a seam of a radius and an order."""
    return turned(seam, radius, order) or bent(seam, radius, order)


def turned(seam: FaceSeam, radius: fmpq, order: int) -> FilletForm | None:
    """The torus, or sphere, of a ball that rolls along a seam, of order 0 the cone through the circles in which it
    touches the faces, of even order the section between planes turned; None where there is no such surface."""
    axis = _axis(seam.faces)
    if axis is None:
        return None
    f, g = (Meridian.of(face, axis) for face in seam.faces)
    if f is None or g is None:
        return None
    if order > 1:
        return _turned_section(seam, (f, g), axis, radius, order) if order % 2 == 0 else None
    middle = float(((seam.centers(to_float(radius)) - to_floats(axis[0])) @ to_floats(axis[1])).mean())
    found = _center((f, g), -seam.sign * radius, middle)
    if found is None:
        return None
    both, depth, square, z = found
    first, second = (m.foot(square, z, depth) for m in both)
    if first is None or second is None:
        return None
    heights = f(*second) * seam.sign, g(*first) * seam.sign
    if order == 0:
        cone = _cone(axis, first, second, (square, z))
        return cone and FilletForm(cone[0], heights, cone[1])
    center = [p + z * w for p, w in zip(*axis, strict=True)]
    inner = Polynomial.from_raw(dot(away(center), away(center)) - (depth**2 - square))
    if square == 0:
        return FilletForm(-inner, heights, (), (first[0] > 0, second[0] > 0))
    # Where a torus meets itself the ball of that circle parts its outside from what is within.
    return FilletForm(-torus_polynomial(center, axis[1], square, depth**2), heights, (inner,) * (square < depth**2))


def _turned_section(
    seam: FaceSeam, both: tuple[Meridian, Meridian], axis: Axis, radius: fmpq, order: int
) -> FilletForm | None:
    """The surface of even order beside a plane and a cylinder; None for other faces, and where the latter is within the
    radius or has none that is rational."""
    (plane, flat), (round_, _) = sorted(zip(both, seam.faces, strict=True), key=lambda pair: pair[0].round != 0)
    if plane.round != 0 or plane.square != 0 or round_.round == 0 or round_.square != 0 or round_.slope != 0:
        return None
    size, side = square_root(-round_.constant / round_.round), seam.sign * (1 if round_.round > 0 else -1)
    major = size + side * radius
    if size**2 * round_.round != -round_.constant or major <= 0:
        return None
    w, along = away(axis[0]), height(*axis)
    square, s = Polynomial.from_raw(dot(w, w) - along * along), flat * (seam.sign / (radius * abs(plane.slope)))
    slope, start = side / radius, -side * size / radius  # t = start + slope R
    parts, power = [s * (2 * start), s * (2 * slope)], order + 1
    for k in range(power + 1):
        term = (1 - s - start) ** (power - k) * square ** (k // 2)
        parts[k % 2] -= term * (comb(power, k) * (-slope) ** k)
    surface = (parts[0] ** 2 - square * parts[1] ** 2) * -side
    heights = radius * abs(plane.slope), seam.sign * round_.round * (major**2 - size**2)
    return FilletForm(surface, heights if both[0] is plane else heights[::-1])


def _cone(axis: Axis, *circles: tuple[fmpq, fmpq]) -> tuple[Polynomial, tuple[Polynomial, ...]] | None:
    """The cone through two circles by R^2 and z, positive at the third, and the plane that parts its halves,
    positive here; None where radii are irrational."""
    (first, low), (second, high), (square, z) = circles
    radii = square_root(first), square_root(second)
    if radii[0] ** 2 != first or radii[1] ** 2 != second or low == high:
        return None
    w, along = away(axis[0]), height(*axis)
    radius = (along - low) * ((radii[1] - radii[0]) / (high - low)) + radii[0]
    cone = Polynomial.from_raw(dot(w, w) - along * along - radius * radius)
    inside = square < (radii[0] + (radii[1] - radii[0]) * (z - low) / (high - low)) ** 2
    return -cone if inside else cone, (Polynomial.from_raw(radius),)


def bent(seam: FaceSeam, radius: fmpq, order: int) -> FilletForm:
    """The polynomial mu s t - h^(k+1), or of order 0 -h, which is flat between planes."""
    slopes = [slope_at(face) for face in seam.faces]
    sizes = [square_root(dot(slope, slope)) for slope in slopes]
    if all(f.degree == 1 and dot(w, w) == size**2 for f, w, size in zip(seam.faces, slopes, sizes, strict=True)):
        cosine = dot(*slopes) / (sizes[0] * sizes[1])
        a, b = (radius * (1 - cosine) * size for size in sizes)
    else:
        cosine, touched = decimal(float(seam.cosines.mean())), touching(seam, to_float(radius))
        if touched is None:
            return FilletForm(seam.faces[0], (fmpq(0), fmpq(0)))
        pairs = zip(seam.faces, touched[::-1], strict=True)
        a, b = (decimal(seam.sign * float(face(points).mean())) for face, points in pairs)
    if a == 0 or b == 0:
        return FilletForm(seam.faces[0], (a, b))
    s, t = (face * (seam.sign / height) for face, height in zip(seam.faces, (a, b), strict=True))
    bulge, h = 2 + 2 * cosine, 1 - s - t
    return FilletForm(s * t * bulge - h ** (order + 1) if order else -h, (a, b))


def _center(
    pair: tuple[Meridian, Meridian], depth: fmpq, middle: float
) -> tuple[list[Meridian], fmpq, fmpq, fmpq] | None:
    """What is parallel to two surfaces so deep inside, or nearly so, that depth, and R^2 and z where both meet."""

    def at(depth: fmpq) -> tuple[list[Meridian], tuple[fmpq, fmpq, fmpq]]:
        """Both parallel surfaces, and the equation for z without R."""
        both = [found for m in pair if (found := m.parallel(depth, middle)) is not None]
        if len(both) < len(pair):
            return both, (fmpq(0), fmpq(0), fmpq(0))
        f, g = both
        names = ("square", "slope", "constant")
        a, b, c = (g.round * getattr(f, name) - f.round * getattr(g, name) for name in names)
        return both, (a, b, c)

    both, (a, b, c) = at(depth)
    if a == b == 0 or b * b < 4 * a * c:
        return None
    root = square_root(b * b - 4 * a * c)
    roots = [(-b + sign * root) / (2 * a) for sign in (1, -1)] if a != 0 else [-c / b]
    z = min(roots, key=lambda z: abs(to_float(z) - middle))
    if a * z * z + b * z + c != 0:
        z = near(to_float(z))
        off, beside = ((a * z + b) * z + c for _, (a, b, c) in (at(depth), at(depth * 2)))
        depth -= depth * off / (beside - off) if beside != off else fmpq(0)
        both, (a, b, c) = at(depth)
    curved = next(m for m in both if m.round != 0)
    square = -replace(curved, round=fmpq(0))(fmpq(0), z) / curved.round
    return (both, depth, square, z) if square >= 0 and a * z * z + b * z + c == 0 else None


def _axis(faces: tuple[Polynomial, Polynomial]) -> Axis | None:
    """The axis that planes and quadrics of revolution have in common, if they have one; None also where no vector along
    it has a rational length."""
    points, ways = list[Vector](), list[Vector]()
    for face in faces:
        found = revolved(face)
        if face.degree == 1:
            ways.append(slope_at(face))
        elif found is None:
            return None
        else:
            points.append(found[1])
            ways += found[2]
    if not points:
        return None
    way = ways[0] if ways else minus(points[0], points[1])
    length = square_root(dot(way, way))
    if length == 0 or length**2 != dot(way, way):
        return None
    x, y, z = (w / length for w in way)
    return points[0], (x, y, z)


def revolved(face: Polynomial) -> tuple[fmpq, Vector, list[Vector]] | None:
    """Of a quadric of revolution the eigenvalue across its axis, a point of that, and its direction, which spheres do
    not have; None of other faces."""
    found = axis_of_revolution(quadratic_terms(face)) if face.degree == 2 else None
    if found is None or found[0] == 0:
        return None
    double, single, way = found
    return double, three(-s / (2 * double) for s in slope_at(face)), [way] if single != double else []


def radius_of_turned(face: Polynomial) -> fmpq | None:
    """The radius of a cylinder or sphere, which is 0 of a cone; None where it is irrational, and of other faces."""
    known = revolved(face)
    square = fmpq(-1) if known is None else -face.raw(*known[1]) / known[0]
    return square_root(square) if square >= 0 and square_root(square) ** 2 == square else None
