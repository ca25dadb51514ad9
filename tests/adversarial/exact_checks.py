"""Exact checks of what certificates claim, that share no code with the proofs but the polynomials.

Divisibility by a power of a plane and membership in `<f, h^(k+1)>` are read off Taylor expansions
in the direction of the plane; roots along rays are counted by Sturm's theorem.  `witness_flaw`
looks, with rational numbers, whether a refuted claim fails where its verdict says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations, pairwise, product

from flint import fmpq, fmpq_poly

from pas import Certificate, PiecewiseSurface, Polynomial, Status, Verdict

Point = tuple[Fraction, ...]
VARIABLES = tuple(map(Polynomial, "xyz"))


def along_plane(plane: Polynomial, *polynomials: Polynomial) -> list[dict[int, Polynomial]]:
    """Polynomials expanded in powers of a linear one: {power: coefficient on the plane}."""
    slopes = [plane.diff(i).at((0, 0, 0)) for i in range(3)]
    axis = max(range(3), key=lambda i: abs(slopes[i]))
    rest = plane - slopes[axis] * VARIABLES[axis]
    new = [(VARIABLES[i] - rest) / slopes[i] if i == axis else VARIABLES[i] for i in range(3)]
    result = []
    for p in polynomials:
        parts: dict[int, dict[tuple[int, ...], Fraction]] = {}
        for exponent, c in p.compose(*new).coefficients().items():
            power = exponent[axis]
            parts.setdefault(power, {})[tuple(0 if i == axis else e for i, e in enumerate(exponent))] = c
        result.append({power: Polynomial(terms) for power, terms in parts.items()})
    return result


def order_across(first: Polynomial, second: Polynomial, plane: Polynomial) -> float:
    """The largest k with which two patches meet C^k in a plane; -1 for none, infinite if they are equal."""
    (parts,) = along_plane(plane, second - first)
    return min(parts, default=float("inf")) - 1


def meets(patch: Polynomial, surface: Polynomial, clip: Polynomial, order: int) -> bool:
    """Whether a patch is in `<surface, clip^(order+1)>`, for a linear clip: division of power series."""
    g, f = along_plane(clip, patch, surface)
    zero = Polynomial(0)
    alpha: list[Polynomial] = []
    for power in range(order + 1):
        rest = g.get(power, zero) - sum((a * f.get(power - i, zero) for i, a in enumerate(alpha)), zero)
        quotient, remainder = divmod(rest.raw, f[0].raw)
        if not remainder.is_zero():
            return False
        alpha.append(Polynomial.from_raw(quotient))
    return True


def on_line(polynomial: Polynomial, start: Sequence[Fraction], end: Sequence[Fraction]) -> fmpq_poly:
    """The polynomial along `start + t (end - start)`, in t."""
    steps = [fmpq_poly([_fmpq(a), _fmpq(b - a)]) for a, b in zip(start, end, strict=True)]
    total = fmpq_poly([])
    for exponent, c in polynomial.coefficients().items():
        term = fmpq_poly([_fmpq(c)])
        for step, e in zip(steps, exponent, strict=True):
            term *= step**e
        total += term
    return total


def roots_in(p: fmpq_poly, low: fmpq, high: fmpq) -> int:
    """The number of distinct roots in (low, high], by Sturm's theorem."""
    simple = p // p.gcd(p.derivative())
    sequence = [simple, simple.derivative()]
    while sequence[-1].degree() >= 0:
        sequence.append(-(sequence[-2] % sequence[-1]))
    return _variations(q(low) for q in sequence) - _variations(q(high) for q in sequence)


def meets_ray_once(polynomial: Polynomial, centre: Point, exit_point: Point) -> bool:
    """Whether a segment from inside meets the surface at most once, and not as a multiple root."""
    p = on_line(polynomial, centre, exit_point)
    if p(fmpq(0)) >= 0 or p.degree() < 0:
        return False
    if p.degree() == 0:
        return True
    common = p.gcd(p.derivative())
    multiple = common.degree() > 0 and roots_in(common, fmpq(0), fmpq(1)) > 0
    return roots_in(p, fmpq(0), fmpq(1)) <= 1 and not multiple


def witness_flaws(surface: PiecewiseSurface, certificate: Certificate) -> Iterator[str]:
    """Every refuted verdict whose witness does not show that the claim fails."""
    view = _View(surface)
    for number, verdict in enumerate(certificate.faces):
        if verdict.status is Status.REFUTED and not view.jump(number, view.near(verdict)):
            yield f"no jump at the witness: {verdict}"
    for number, verdict in enumerate(certificate.contacts):
        with_witness = verdict.status is Status.REFUTED and verdict.witness is not None
        if with_witness and not view.contact_fails(number, verdict):
            yield f"the contact is met at the witness: {verdict}"
    for verdict, fails in ((certificate.one_sheet, view.sheet_fails), (certificate.enclosed, view.enclosure_fails)):
        if verdict.status is Status.REFUTED and not any(map(fails, view.near(verdict))):
            yield f"the claim holds at the witness: {verdict}"


class _View:
    """A surface's exact geometry, as the checks of witnesses need it."""

    def __init__(self, surface: PiecewiseSurface) -> None:
        self.surface, self.partition = surface, surface.partition
        self.patches = surface.polynomials
        self.center = None if self.partition.center is None else exact(self.partition.center)
        corners = [exact(v) for v in self.partition.vertices]
        self.size = max((abs(a - b) for p, q in combinations(corners, 2) for a, b in zip(p, q, strict=True)), default=1)
        reach = max((abs(c) for p in corners for c in p), default=Fraction(1))
        # a witness is a double: right to the spacing of doubles at its place
        self.blur = max(self.size, reach) * Fraction(1, 2**50)

    def near(self, verdict: Verdict) -> list[Point]:
        """The witness and points around it within the rounding of doubles."""
        assert verdict.witness is not None, f"no witness: {verdict}"
        w = exact(verdict.witness)
        return sorted(
            (tuple(c + s * self.blur for c, s in zip(w, step, strict=True)) for step in product((0, 1, -1), repeat=3)),
            key=lambda p: sum(abs(a - b) for a, b in zip(p, w, strict=True)),
        )

    def jump(self, number: int, points: list[Point]) -> bool:
        """Whether two patches differ, by the lowest power of the plane, next to a face's witness."""
        face = self.partition.interior_faces[number]
        difference = self.patches[face.second] - self.patches[face.first]
        order = order_across(self.patches[face.first], self.patches[face.second], face.plane)
        if order >= self.surface.order or not self.in_triangle(face.vertices, points[0]):
            return False
        quotient = difference
        for _ in range(int(order) + 1):
            quotient = Polynomial.from_raw(divmod(quotient.raw, face.plane.raw)[0])
        return any(quotient.at(onto(face.plane, p)) != 0 for p in points)

    def contact_fails(self, number: int, verdict: Verdict) -> bool:
        contact, points = self.surface.contacts[number], self.near(verdict)
        if not self.on(contact.clip, points[0]):
            return False
        faces = self.clip_faces(number)
        if "edges" in verdict.reason:
            return any(contact.surface.at(p) <= 0 for p in points)
        if not self.on(contact.surface, points[0]) or not any(self.in_triangle(f.vertices, points[0]) for f in faces):
            return False
        if "alpha" in verdict.reason:
            return any(self.opposite_signs(number, piece, p) for p in points for piece in self.pieces_at(points[0]))
        pieces = {face.piece for face in faces}
        order = self.surface.order
        return not all(meets(self.patches[i], contact.surface, contact.clip, order) for i in pieces)

    def sheet_fails(self, point: Point) -> bool:
        """Whether f comes down through zero along the ray to a point, next to it, or is >= 0 at the centre."""
        assert self.center is not None
        if max(abs(a - b) for a, b in zip(point, self.center, strict=True)) <= 2 * self.blur:
            return any(self.patches[piece].at(self.center) >= 0 for piece in self.pieces_at(self.center))
        return any(self.comes_down(piece, point) for piece in self.pieces_at(point))

    def comes_down(self, piece: int, point: Point) -> bool:
        f = on_line(self.patches[piece], self.center, point)
        slope = f.derivative()(fmpq(1))
        if slope >= 0:
            return False
        step = 4 * abs(f(fmpq(1)) / slope) + _fmpq(Fraction(1, 2**50))
        return step < fmpq(1, 10**2) and f(1 - step) > 0 > f(1 + step)  # a change of signs shows it, however far

    def enclosure_fails(self, point: Point) -> bool:
        """Whether f is not positive on a wall, or not of the contact's sign on a clip face, at a point."""
        clipped = {}
        for number in range(len(self.surface.contacts)):
            clipped |= {face.vertices: number for face in self.clip_faces(number)}
        for face in self.partition.outer_faces:
            if not self.in_triangle(face.vertices, point):
                continue
            at = onto(face.plane, point)
            if face.vertices in clipped:
                if self.opposite_signs(clipped[face.vertices], face.piece, at):
                    return True
            elif self.patches[face.piece].at(at) <= 0:
                return True
        return False

    def opposite_signs(self, number: int, piece: int, point: Point) -> bool:
        """Whether patch and contact differ in sign at a point of the clip plane."""
        contact = self.surface.contacts[number]
        at = onto(contact.clip, point)
        return self.patches[piece].at(at) * contact.surface.at(at) < 0

    def clip_faces(self, number: int) -> list:
        clip = self.surface.contacts[number].clip
        faces = self.partition.outer_faces
        return [f for f in faces if all(clip.at(p) == 0 for p in self.partition.corners(f.vertices))]

    def on(self, polynomial: Polynomial, point: Point) -> bool:
        """Whether a polynomial vanishes at a point, up to the rounding of the point."""
        slope = max(abs(polynomial.diff(i).at(point)) for i in range(3))
        return abs(polynomial.at(point)) <= 64 * slope * self.blur

    def in_triangle(self, indices: Iterable[int], point: Point) -> bool:
        """Whether a point is in a triangle, up to the rounding of the point."""
        a, b, c = (exact(self.partition.vertices[i]) for i in indices)
        normal = _cross(_minus(b, a), _minus(c, a))
        slack = 64 * self.blur / self.size
        if abs(_dot(normal, _minus(point, a))) > slack * self.size * max(map(abs, normal)) * 3:
            return False
        whole = _dot(normal, normal)
        weights = [_dot(_cross(_minus(q, p), _minus(point, p)), normal) for p, q in ((a, b), (b, c), (c, a))]
        return all(w >= -slack * self.size**2 * max(map(abs, normal)) * 3 for w in weights) and whole > 0

    def pieces_at(self, point: Point) -> list[int]:
        """The pieces that hold a point, up to its rounding."""
        found = []
        for cell, piece in zip(self.partition.cells, self.partition.piece_of, strict=True):
            planes = self.partition.planes(self.partition.cells.index(cell))
            if all(
                plane.at(point) <= 64 * self.blur * max(abs(plane.diff(i).at(point)) for i in range(3))
                for plane in planes
            ):
                found.append(int(piece))
        return found


def exact(point: Iterable[object]) -> Point:
    """A point of doubles or flint rationals as fractions."""
    return tuple(Fraction(int(c.p), int(c.q)) if isinstance(c, fmpq) else Fraction(c) for c in point)  # type: ignore[arg-type]


def onto(plane: Polynomial, point: Point) -> Point:
    """The nearest point of a plane."""
    slopes = tuple(plane.diff(i).at(point) for i in range(3))
    share = plane.at(point) / _dot(slopes, slopes)
    return tuple(c - share * s for c, s in zip(point, slopes, strict=True))


def _fmpq(value: Fraction | int) -> fmpq:
    fraction = Fraction(value)
    return fmpq(fraction.numerator, fraction.denominator)


def _variations(values: Iterable[fmpq]) -> int:
    signs = [v > 0 for v in values if v != 0]
    return sum(a != b for a, b in pairwise(signs))


def _minus(a: Point, b: Point) -> Point:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def _dot(a: Point, b: Point) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def _cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
