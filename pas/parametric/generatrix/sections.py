"""Plane sections of quadrics as boundaries of blends, in closed form.

In a plane with a rational orthogonal basis the quadric is a conic with rational coefficients; its kind is decided
exactly by its determinants (Salmon 1862).  Ellipses are m + a cos 2 pi s + b sin 2 pi s; hyperbolas
m +- a cosh u + b sinh u and parabolas m + a u + b u^2 run over a stated interval of u.  The vectors are rounded
to doubles: about 1e-15 of their size off.  For ellipses what that does to the contact is bounded for all s, by exact
arithmetic on the rounded vectors (`ellipse_bounds`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.expressions import as_text
from pas.algebra.inputs import short, shown, shown_point
from pas.algebra.lengths import exponent
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, Vector, dot, exact, three, to_float, to_floats, two_across
from pas.arrays import Floats
from pas.contacts.rims import PlaneChart
from pas.errors import GeometryError
from pas.parametric.generatrix.boundary import Boundary, ContactBounds, part, source_of
from pas.parametric.generatrix.paths import on_unit_interval
from pas.parametric.generatrix.quadric import Quadric, plane_text, read_plane, to_array


class ConicKind(Enum):
    """The plane sections that are regular curves."""

    ELLIPSE = "ellipse"
    PARABOLA = "parabola"
    HYPERBOLA = "hyperbola"


@dataclass(frozen=True)
class Conic:
    """`origin` + `first` f(u) + `second` g(u), (f, g) being (cos, sin), (u, u^2) or (cosh, sinh)."""

    kind: ConicKind
    origin: Floats
    first: Floats
    second: Floats

    def __call__(self, u: Floats, order: int = 0, sign: int = 1) -> Floats:
        """Points (n, 3) at u (n,), or derivatives of order 1; `sign` -1 is the other branch of a hyperbola."""
        f, g = FUNCTIONS[self.kind][order]
        start = self.origin if order == 0 else 0.0
        return np.asarray(start + sign * f(u)[:, None] * self.first + g(u)[:, None] * self.second)


Function = Callable[[Floats], Floats]
FUNCTIONS: dict[ConicKind, tuple[tuple[Function, Function], ...]] = {
    ConicKind.ELLIPSE: ((np.cos, np.sin), (lambda u: -np.sin(u), np.cos)),
    ConicKind.PARABOLA: ((lambda u: u, lambda u: u * u), (np.ones_like, lambda u: 2.0 * u)),
    ConicKind.HYPERBOLA: ((np.cosh, np.sinh), (np.sinh, np.cosh)),
}


ROUNDED = 1.001
"""For the rounding of the bounds themselves."""


def _vector(plane: PlaneChart, a: Any, b: Any) -> Floats:
    """a u + b v, u and v being the axes of a plane, rounded."""
    u, v = np.array(to_floats(plane.first)), np.array(to_floats(plane.second))
    return np.asarray(float(a) * u + float(b) * v)


def plane_section(
    quadric: PolynomialLike | Quadric,
    plane: PolynomialLike,
    interval: Sequence[Exact] | None = None,
    branch: int = 1,
    name: str | None = None,
    side: int | None = None,
) -> Boundary:
    """The conic in which a plane cuts a quadric, as a boundary of a blend.

    Which conic it is is decided exactly (Salmon 1862).

    `quadric` and `plane` are polynomials (or strings) of degree two and one.  An open conic needs `interval`,
    that of u (module docstring; for a parabola the length along the tangent at its vertex), and a hyperbola the
    `branch`, 1 or -1.  `side` is that of `Boundary`.

    Raises `GeometryError` where the section is empty, a point or straight lines, saying which, `ValueError` for another
    branch.
    """
    surface, (normal, offset) = Quadric(quadric), read_plane(plane)
    surface.require_curved("quadric")
    conic = conic_section(surface, normal, offset)
    needs, told = {"quadric": surface.text, "plane": as_text(plane) or str(Polynomial(plane))}, name
    f = surface.polynomial
    name = f"the section of {short(str(f))} = 0 by {plane_text(normal, offset)}" if name is None else name
    if branch not in (1, -1):
        raise ValueError(f"branch must be 1 or -1, not {shown(branch)}")
    closed, ends = conic.kind is ConicKind.ELLIPSE, (0.0, 2.0 * np.pi)
    if not closed and interval is None:
        raise GeometryError(
            f"{name} is a {conic.kind.value}, an open curve: say which part, for example interval=(-1, 1)"
        )
    if not closed and interval is not None:
        ends, _ = on_unit_interval(interval, name)
    sign = branch if conic.kind is ConicKind.HYPERBOLA else 1
    return part(
        lambda u: conic(u, 0, sign),
        lambda u: conic(u, 1, sign),
        lambda u: f.gradient(conic(u, 0, sign)),
        ends,
        closed=closed,
        name=name,
        side=side,
        bounds=(lambda: ellipse_bounds(surface, conic)) if closed else None,
        surface=f,
        source=source_of(needs, interval, branch=branch if branch != 1 else None, name=told),
    )


def ellipse_bounds(quadric: Quadric, conic: Conic) -> ContactBounds:
    """How far an ellipse m + a cos + b sin is from a quadric, and how steep against it, for all angles.

    f is p0 + p1 cos + q1 sin + p2 cos 2 + q2 sin 2 with coefficients that are exact in the doubles m, a, b; the
    sums of their absolute values bound f and C' . grad f.  |C'| is at least the smaller half-axis, |grad f| the least
    of its samples less what it can change by around each.  All is done in a unit of the size of the ellipse.
    """
    power = exponent(np.stack([conic.first, conic.second]))
    conic = Conic(conic.kind, *(np.ldexp(v, -power) for v in (conic.origin, conic.first, conic.second)))
    matrix = _in_units(quadric.matrix, exact(math.ldexp(1.0, power)))
    rows = [[exact(x) for x in v] for v in (conic.origin, conic.first, conic.second)]
    lift = fmpq_mat([[*row, fmpq(int(i == 0))] for i, row in enumerate(rows)])
    form = lift * matrix * lift.transpose()
    first = [abs(2 * form[0, i]) for i in (1, 2)]
    second = [abs(form[1, 1] - form[2, 2]) / 2, abs(form[1, 2])]
    constant = abs(form[0, 0] + (form[1, 1] + form[2, 2]) / 2)
    axes = np.stack([conic.first, conic.second])
    speed = _smaller_half_axis(rows[1], rows[2]) / ROUNDED
    steps = 2048  # of |grad f|, which between two changes by as much as its derivatives allow
    angle, half = np.linspace(0, 2 * np.pi, steps, endpoint=False), np.pi / steps
    whole = 2 * to_array(matrix)
    hessian = whole[:3, :3]
    slopes = np.linalg.norm(conic(angle) @ hessian + whole[3, :3], axis=1)
    turns = np.linalg.norm(conic(angle, 1) @ hessian, axis=1)
    bend = np.linalg.norm(axes @ hessian, axis=1).sum()
    slope = float((slopes - half * turns - half**2 / 2 * bend).min()) / ROUNDED
    if not (speed * slope > 0):
        return ContactBounds(np.inf, np.inf)
    steepest = to_float(sum(first, fmpq(0)) + 2 * sum(second, fmpq(0)))
    furthest = to_float(constant + sum(first, fmpq(0)) + sum(second, fmpq(0)))
    sine = steepest / float(speed * slope)
    distance = furthest / float(slope) * ROUNDED
    return ContactBounds(float(np.arcsin(min(1.0, sine))) * ROUNDED, math.ldexp(distance, power))


def _in_units(matrix: fmpq_mat, unit: fmpq) -> fmpq_mat:
    """The matrix of a quadric where lengths are multiples of `unit`, over its greatest entry."""
    scale = fmpq_mat([[(unit if i < 3 else fmpq(1)) * int(i == j) for j in range(4)] for i in range(4)])
    scaled = scale * matrix * scale
    return scaled * (1 / max(map(abs, scaled.entries())))


def _smaller_half_axis(first: Sequence[fmpq], second: Sequence[fmpq]) -> float:
    """Of the ellipse a cos + b sin: the root of the smaller eigenvalue of its Gram matrix, 2 det / (tr + sqrt(...))."""
    a, b, c = dot(first, first), dot(first, second), dot(second, second)
    trace, determinant = to_float(a + c), to_float(a * c - b * b)
    root = to_float((a - c) ** 2 + 4 * b * b) ** 0.5
    return float((2 * determinant / (trace + root)) ** 0.5) if trace > 0 else 0.0


def conic_section(quadric: Quadric, normal: Vector, offset: fmpq) -> Conic:
    """The conic; raises `GeometryError` for sections that are no regular curve."""
    point = three(offset / dot(normal, normal) * c for c in normal)
    plane = PlaneChart(normal, point, *two_across(normal))
    q = quadric.matrix
    lift = fmpq_mat([[*plane.first, fmpq(0)], [*plane.second, fmpq(0)], [*plane.origin, fmpq(1)]])
    form = lift * q * lift.transpose()
    small = form[0, 0] * form[1, 1] - form[0, 1] ** 2
    _refuse_degenerate(quadric, plane, form, small)
    if small == 0:
        return _parabola(plane, form)
    return _central(plane, form, small)


def _refuse_degenerate(quadric: Quadric, plane: PlaneChart, form: fmpq_mat, small: fmpq) -> None:
    """Raise for the sections that are empty, points or lines: by the ranks and signs of the two determinants."""
    text = plane_text(plane.normal, dot(plane.normal, plane.origin))
    where = f"the plane {text} and {short(str(quadric.polynomial))} = 0"
    rank = int(form.rank())
    corner = form[0, 0] if form[0, 0] != 0 else form[1, 1]
    if rank == 3 and not (small > 0 and corner * form.det() > 0):
        return
    if rank == 3:
        raise GeometryError(f"{where} do not meet: the section is empty (complex); move the plane")
    if small != 0:
        place = shown_point(plane.point(*_center(form, small)), 6)
        what = "one point" if small > 0 else "two straight lines that cross"
        remedy = "it touches there" if quadric.kind.value != "elliptic cone" else "it passes through the apex"
        raise GeometryError(f"{where} meet in {what} at {place}; {remedy}: move the plane")
    if rank == 0:
        raise GeometryError(f"{where}: the plane is part of the quadric")
    if corner == 0:
        what = "one straight line" if form[0, 2] != 0 or form[1, 2] != 0 else "nothing: the section is empty"
    elif rank == 1:
        what = "one straight line, along which they touch"
    else:
        gap = max((form[i, 2] ** 2 - form[i, i] * form[2, 2] for i in (0, 1)), key=lambda v: (v != 0, v))
        what = "two parallel straight lines" if gap > 0 else "nothing: the section is empty (complex)"
    raise GeometryError(f"{where} meet in {what}; tilt or move the plane")


def _center(form: fmpq_mat, small: fmpq) -> tuple[fmpq, fmpq]:
    """Where the gradient of the conic vanishes, in coordinates of the basis."""
    a = (form[0, 1] * form[1, 2] - form[1, 1] * form[0, 2]) / small
    b = (form[0, 1] * form[0, 2] - form[0, 0] * form[1, 2]) / small
    return a, b


def _central(plane: PlaneChart, form: fmpq_mat, small: fmpq) -> Conic:
    """Ellipse or hyperbola: half-axes from the eigenvalues in unit coordinates."""
    center = _center(form, small)
    greatest = max(abs(form[i, j]) for i in (0, 1) for j in (0, 1))
    value = to_float(form.det() / small / greatest)
    lengths = [to_float(dot(v, v)) ** 0.5 for v in (plane.first, plane.second)]
    unit = np.array([[to_float(form[i, j] / greatest) / (lengths[i] * lengths[j]) for j in (0, 1)] for i in (0, 1)])
    eigenvalues, vectors = np.linalg.eigh(unit)
    with np.errstate(all="ignore"):
        axes = [_vector(plane, *(vectors[:, i] / lengths)) * np.abs(value / eigenvalues[i]) ** 0.5 for i in (0, 1)]
    origin = np.array(to_floats(plane.point(*center)))
    sizes = [float(np.abs(axis).max()) for axis in axes]
    if not (min(sizes) >= 1e-150 and max(sizes) <= 1e150):  # whose squares are still doubles
        raise GeometryError(
            f"a plane section has half-axes of {sizes[1]:.2g} and {sizes[0]:.2g}; they are made from 1e-150 to 1e+150: "
            "choose another unit of length"
        )
    if small > 0:
        return Conic(ConicKind.ELLIPSE, origin, axes[1], axes[0])
    across = 0 if -value / eigenvalues[0] > 0 else 1
    return Conic(ConicKind.HYPERBOLA, origin, axes[across], axes[1 - across])


def _parabola(plane: PlaneChart, form: fmpq_mat) -> Conic:
    """With z the direction of the axis (the null vector) and w perpendicular to it: the vertex and u^2."""
    row = 0 if form[0, 0] != 0 else 1
    z = (-form[row, 1], form[row, 0])
    gram = [dot(v, v) for v in (plane.first, plane.second)]
    w = (-z[1] * gram[1], z[0] * gram[0])
    bend = sum((w[i] * w[j] * form[i, j] for i in (0, 1) for j in (0, 1)), fmpq(0))
    along, aside = (v[0] * form[0, 2] + v[1] * form[1, 2] for v in (z, w))
    start = -aside / bend
    height = -(start * start * bend + 2 * start * aside + form[2, 2]) / (2 * along)
    origin = plane.point(start * w[0] + height * z[0], start * w[1] + height * z[1])
    square = w[0] * w[0] * gram[0] + w[1] * w[1] * gram[1]
    second = _vector(plane, *(to_float(-bend / (2 * along) / square * c) for c in z))
    first = _vector(plane, *map(to_float, w)) / to_float(square) ** 0.5
    return Conic(ConicKind.PARABOLA, np.array(to_floats(origin)), first, second)
