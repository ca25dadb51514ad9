"""The curves in which two quadrics meet, branch by branch, as parametrisations.

Along the straight lines of a ruled member of the pencil (`Rulings`; Levin 1976) the curve is given by square roots of a
trigonometric polynomial D(a).  Where D > 0 for all a there are two closed branches, one for each sign of the root.
Else each arc (a0, a1) with D > 0 inside and simple zeros at its ends is one closed branch, which takes both signs;
a = m - w cos u makes it smooth there: with D = sin((a - a0)/2) sin((a1 - a)/2) g(a) the signed root is

    sqrt(D) = (w/2) sin u sqrt(g(a) sinc(w sin^2(u/2)) sinc(w cos^2(u/2))),   sinc x = sin x / x.

Every point is improved by one step of Newton's method on both polynomials.  Where the pencil has a pair of planes, the
branches are conics.

Guaranteed: whether the pencil has planes or definite members is decided exactly.  Branches that touch or cross,
which no regular curve can pass, are reported as such when D has a double zero to about 1e-10.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from flint import fmpq_mat
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.inputs import shown, shown_point
from pas.algebra.lengths import unit
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, to_floats
from pas.arrays import AnyArray, Floats
from pas.certify.free_curves import dual
from pas.errors import GeometryError
from pas.parametric.generatrix.boundary import Boundary, part, source_of
from pas.parametric.generatrix.paths import Curve, on_unit_interval
from pas.parametric.generatrix.quadric import PLANES, Member, Quadric, Rulings, members, planes_of, rulings, to_array
from pas.parametric.generatrix.sections import Conic, ConicKind, conic_section

DEGREE = 4
"""The degree of D in cos a, sin a."""

SAMPLES = 2048
"""Parameters along a branch at which it is looked at."""

FAR = 1e-7
"""A homogeneous point of length one whose last coordinate is below counts as at infinity."""


@dataclass(frozen=True, eq=False)
class QuadricPair:
    """Two quadrics as `given`, and as seen from a point near the first (`local`), which keeps the digits of far ones.

    `offset` (3,) is that point: zero unless the first quadric is many times its size away from the origin.
    """

    given: tuple[Quadric, Quadric]
    local: tuple[Quadric, Quadric]
    offset: Floats

    @classmethod
    def of(cls, first: Quadric, second: Quadric) -> QuadricPair:
        """The pair, moved if need be."""
        q = to_array(first.matrix)
        center = np.linalg.lstsq(q[:3, :3], -q[:3, 3], rcond=1e-10)[0]
        size = np.sqrt(abs(q[3, 3] + q[3, :3] @ center) / np.abs(q[:3, :3]).max())
        if np.abs(center).max() <= 30.0 * max(size, 3e-6):  # cones have no size
            return cls((first, second), (first, second), np.zeros(3))
        digits = [float(f"{c:.6g}") for c in center]
        x, y, z = (Polynomial(v) + Polynomial(c) for v, c in zip("xyz", digits, strict=True))
        local = Quadric(first.polynomial.compose(x, y, z)), Quadric(second.polynomial.compose(x, y, z))
        return cls((first, second), local, np.array(digits))

    @property
    def text(self) -> str:
        """Both equations, for messages."""
        return f"{self.given[0].polynomial} = 0 and {self.given[1].polynomial} = 0"

    def where(self, point: Floats) -> str:
        """A local point (3,), for messages."""
        return shown_point(point + self.offset, 6)

    def polished(self, points: Floats) -> Floats:
        """Local points (n, 3) after one step of Newton's method of least length on both polynomials."""
        f, g = (q.polynomial for q in self.local)
        along_f, along_g, regular = dual(f.gradient(points), g.gradient(points))
        moved = points - f(points)[:, None] * along_f - g(points)[:, None] * along_g
        return np.where(regular[:, None], moved, points)


@dataclass(frozen=True, eq=False)
class QuadricBranch:
    """One branch of the intersection of two quadrics, a curve of s in [0, 1].

    `pair` holds the quadrics, and these as seen from a point nearby: rulings and conic are in those coordinates.
    `interval` are the angles that it runs over.  With a `factor` g it takes both signs of the root (then it is closed
    though D vanishes at the ends), else `sign` is the one.  `poles` are the s at which it is at infinity:
    it is `closed` where there are none.  `conic` is given instead where the branch is plane, `sign` then being that
    of a hyperbola's branch.  Its `number` is that among the branches.
    """

    pair: QuadricPair
    interval: tuple[float, float]
    sign: int
    rulings: Rulings | None = None
    factor: Floats | None = None
    conic: Conic | None = None
    poles: tuple[float, ...] = ()
    number: int = 0

    __repr__ = brief

    @property
    def closed(self) -> bool:
        """Whether the branch is a closed curve in space (none of it at infinity)."""
        return not self.poles

    @property
    def quadrics(self) -> tuple[Quadric, Quadric]:
        """The two quadrics as given."""
        return self.pair.given

    def __call__(self, s: ArrayLike) -> Floats:
        """Points at `s` (...): (..., 3); infinite or nan at poles."""
        array = np.asarray(s, dtype=float)
        return np.asarray(self.local(array.ravel()) + self.pair.offset).reshape(*array.shape, 3)

    def derivative(self, s: ArrayLike) -> Floats:
        """C'(s) at `s` (...): (..., 3), but of conics along the product of gradients, its length by differences."""
        array = np.asarray(s, dtype=float)
        flat, step = array.ravel(), 1e-5  # for the speed alone: the direction comes from the gradients
        if self.conic is not None:  # along which the quadrics may touch
            speed = np.full(len(flat), 2 * np.pi) if self.closed else 1 / (flat * (1 - flat))
            return np.asarray(self.conic(self._turn(flat), 1, self.sign) * speed[:, None]).reshape(*array.shape, 3)
        change = (self.local(flat + step) - self.local(flat - step)) / (2 * step)
        points = self.local(flat)
        first, second = (q.polynomial.gradient(points) for q in self.pair.local)
        along = unit(np.cross(first, second))
        return np.asarray((change * along).sum(axis=1, keepdims=True) * along).reshape(*array.shape, 3)

    def on(
        self, number: int, interval: Sequence[Exact] | None = None, name: str | None = None, side: int | None = None
    ) -> Boundary:
        """The branch as a boundary on quadric `number` (0 or 1) of the two.

        A branch that is not closed needs an `interval` of s without poles; of a closed one it takes a part.
        """
        if number not in (0, 1):
            raise ValueError(f"number must be 0 or 1, the quadric that the blend is to meet, not {shown(number)}")
        f, other = (self.quadrics[i].polynomial for i in (number, 1 - number))
        needs = {key: q.text for key, q in zip(("quadric", "other"), self.quadrics, strict=True)}
        source = source_of(needs, interval, branch=self.number or None, number=number or None, name=name)
        name = f"the branch of {f} = 0 and {other} = 0" if name is None else name
        if interval is None and not self.closed:
            poles = ", ".join(f"{p:.4g}" for p in self.poles)
            raise GeometryError(f"{name} goes to infinity at s = {poles}: say which part, interval=(low, high)")
        ends = (0.0, 1.0) if interval is None else on_unit_interval(interval, name)[0]
        inside = [p for p in self.poles for k in (-1, 0, 1) if ends[0] <= p + k <= ends[1]]
        if inside:
            raise GeometryError(f"{name} goes to infinity at s = {inside[0]:.4g}, inside the interval")
        near, shut = self.pair.local[number].polynomial, interval is None
        field: Curve = lambda s: near.gradient(self.local(s))  # noqa: E731
        return part(self, self.derivative, field, ends, shut, name=name, side=side, surface=f, source=source)

    def homogeneous(self, s: Floats) -> Floats:
        """Homogeneous points (n, 4) of length one at s (n,) on the straight lines, before Newton's step."""
        assert self.rulings is not None
        low, high = self.interval
        if self.factor is None:
            angle = low + (high - low) * s
            return self.rulings.points(angle, self.sign * np.sqrt(np.maximum(self.rulings.discriminant(angle), 0.0)))
        turn, half = 2 * np.pi * s, (high - low) / 2
        angle = (low + high) / 2 - half * np.cos(turn)
        ends = np.sinc(half * np.sin(turn / 2) ** 2 / np.pi) * np.sinc(half * np.cos(turn / 2) ** 2 / np.pi)
        root = half / 2 * np.sin(turn) * np.sqrt(np.maximum(_trigonometric(self.factor, angle) * ends, 0.0))
        return self.rulings.points(angle, root)

    def local(self, s: Floats) -> Floats:
        """Points (n, 3) at s (n,) in the coordinates of `pair.local`."""
        with np.errstate(all="ignore"):
            if self.conic is not None:
                return self.conic(self._turn(s), 0, self.sign)
            points = self.homogeneous(s)
            return self.pair.polished(points[:, :3] / points[:, 3:])

    def _turn(self, s: Floats) -> Floats:
        """The conic's own parameter at s (n,), which is all reals for an open one."""
        return np.asarray(2 * np.pi * s if self.closed else 2 * np.arctanh(2 * s - 1))

    def __str__(self) -> str:
        kind = "closed" if self.closed else f"open (at infinity at {len(self.poles)} places)"
        first, second = self.quadrics
        return f"a {kind} branch of {first.polynomial} = 0 and {second.polynomial} = 0"


def quadric_intersection(
    first: PolynomialLike | Quadric, second: PolynomialLike | Quadric
) -> tuple[QuadricBranch, ...]:
    """All branches of the intersection of two quadrics, given by polynomials of degree two in any position.

    Closed branches first; they follow the lines of a ruled quadric of the pencil (Levin 1976).

    Raises `GeometryError` where they do not meet, meet in single points only, have a straight line or a surface in
    common, or where branches touch or cross (and where).
    """
    given = Quadric(first, "first"), Quadric(second, "second")
    for quadric, name in zip(given, ("first", "second"), strict=True):
        quadric.require_curved(name)
    pair = QuadricPair.of(*given)
    if int(fmpq_mat([q.matrix.entries() for q in given]).rank()) < 2:
        raise GeometryError(f"{pair.text} are the same surface")
    found = members(*pair.local)
    if any(4 in inertia for _, inertia in found):  # a definite member: no real point in common
        raise GeometryError(f"{pair.text} do not meet: the intersection is empty (complex)")
    planes = next((matrix for matrix, inertia in found if inertia in PLANES), None)
    branches = _plane_branches(pair, planes) if planes is not None else _ruled_branches(pair, found)
    return tuple(replace(b, number=n) for n, b in enumerate(sorted(branches, key=lambda b: not b.closed)))


def _plane_branches(pair: QuadricPair, member: fmpq_mat) -> list[QuadricBranch]:
    """The sections of the first quadric by the planes of a member of the pencil."""
    branches, reasons = list[QuadricBranch](), list[str]()
    planes = [p for p in planes_of(member) if any(c != 0 for c in p[:3])]  # not that at infinity
    for x, y, z, c in planes:
        try:
            conic = conic_section(pair.local[0], (x, y, z), -c)
        except GeometryError as error:
            reasons.append(str(error))
            continue
        size = max(np.abs(conic.first).max(), np.abs(conic.second).max())
        if conic.kind is ConicKind.ELLIPSE and size < 1e-7 * (1 + np.abs(conic.origin).max()):
            reasons.append(f"one of their planes meets them in one point, {shown_point(conic.origin, 6)}")
            continue
        signs = (1, -1) if conic.kind is ConicKind.HYPERBOLA else (1,)
        poles = () if conic.kind is ConicKind.ELLIPSE else (0.0, 1.0)
        branches += [QuadricBranch(pair, (0.0, 1.0), sign, conic=conic, poles=poles) for sign in signs]
    if not branches:
        seen = f"seen from {shown_point(pair.offset, 6)}, " if pair.offset.any() else ""
        raise GeometryError(f"{pair.text} have no curve in common; {seen}" + "; ".join(reasons))
    for branch in branches:
        _require_uncut(branch, [np.array(to_floats(p)) for p in planes])
    return branches


def _require_uncut(branch: QuadricBranch, planes: list[Floats]) -> None:
    """Raise where the other plane of the pair cuts the conic: there the two sections cross, or touch."""
    points = branch.local((np.arange(2 * SAMPLES) + 0.5) / (2 * SAMPLES))
    size = 1.0 + np.abs(points).max(axis=1)
    for plane in planes:
        heights = (points @ plane[:3] + plane[3]) / np.linalg.norm(plane[:3])
        if (np.abs(heights) <= 1e-9 * size).all():
            continue  # its own
        near = int((np.abs(heights) / size).argmin())
        if heights.min() < 0 < heights.max() or abs(heights[near]) <= 1e-7 * size[near]:
            raise GeometryError(
                f"the two plane curves in which {branch.pair.text} meet cross or touch each other near "
                f"{branch.pair.where(points[near])}; take plane_section for one of them, or move a quadric"
            )


def _ruled_branches(pair: QuadricPair, found: list[Member]) -> list[QuadricBranch]:
    lines = rulings(*pair.local, found)
    if lines is None:
        raise GeometryError(f"{pair.text} have no curve in common: the intersection is empty or single points")
    size = 4 * DEGREE  # angles at which D tells its coefficients c_k, D(a) = sum_k c_k e^(ika), k = -4..4
    transform = np.fft.fft(lines.discriminant(2 * np.pi * np.arange(size) / size)) / size
    coefficients = np.array([transform[k] for k in range(-DEGREE, DEGREE + 1)])
    zeros, made = _zeros(lines, coefficients, pair), []
    if zeros:
        for low, high in zip(zeros, [*zeros[1:], zeros[0] + 2 * np.pi], strict=True):
            if lines.discriminant(low + (high - low) * np.array([0.3, 0.5, 0.6])).sum() > 0:
                made.append(QuadricBranch(pair, (low, high), 1, lines, _divided(coefficients, low, high)))
    elif lines.discriminant(np.array([0.3, 2.1, 4.2])).sum() > 0:
        made = [QuadricBranch(pair, (0.0, 2 * np.pi), sign, lines) for sign in (1, -1)]
    branches = [replace(branch, poles=_poles(branch)) for branch in made if not _is_point(branch)]
    if not branches:
        raise GeometryError(f"{pair.text} do not meet in a curve: the intersection is empty (complex) or single points")
    return branches


def _is_point(branch: QuadricBranch) -> bool:
    """Whether the branch is the apex alone: it lies on both quadrics, and every straight line passes through it."""
    points = branch.homogeneous(np.array([0.05, 0.2, 0.45, 0.8]))
    return bool(np.abs(points[1:] @ points[0]).min() > 1 - 1e-12)


def _trigonometric(coefficients: AnyArray, angle: Floats) -> Floats:
    """The real value of sum_k c_k e^(i(k - n/2)a), n the greatest k."""
    n = len(coefficients) - 1
    value = np.polynomial.polynomial.polyval(np.exp(1j * angle), coefficients)
    return np.asarray((value * np.exp(-0.5j * n * angle)).real)


def _divided(coefficients: Any, low: float, high: float) -> Any:
    """g with D = sin((a - low)/2) sin((high - a)/2) g: two linear factors in e^(ia) divided off."""
    ends = np.exp(1j * np.array([low, high]))
    quotient, _ = np.polynomial.polynomial.polydiv(coefficients, np.polynomial.polynomial.polyfromroots(ends))
    whole = np.zeros(len(coefficients) - 2, dtype=complex)  # leading zeros were trimmed
    whole[: len(quotient)] = quotient
    return whole * 4.0 * np.exp(0.5j * (low + high))


def _zeros(lines: Rulings, coefficients: Any, pair: QuadricPair) -> list[float]:
    """The simple zeros of D in [0, 2 pi), ascending; raises `GeometryError` for double ones.

    D is monotone between the real zeros of its derivative, found as eigenvalues.
    """
    from scipy.optimize import brentq

    def value(angle: float) -> float:
        return float(_trigonometric(coefficients, np.array([angle]))[0])

    a, b, c = lines.equation(np.linspace(0, 2 * np.pi, 64))
    least = 1e-11 * float((b * b + np.abs(a * c)).max())  # an extremum below counts as zero: rounding makes 1e-14
    steep = np.roots((coefficients * np.arange(-DEGREE, DEGREE + 1))[::-1])
    knots = sorted(np.angle(steep[np.abs(np.abs(steep) - 1) < 1e-3]).tolist()) or [0.0]
    heights = [value(k) for k in knots]
    if max(map(abs, heights)) <= least:
        raise GeometryError(f"{pair.text} have straight lines in common, or touch along a curve; move one of them")
    for knot, height in zip(knots, heights, strict=True):
        point = lines.points(np.array([knot]), np.array([0.0]))[0]
        if abs(height) <= least and abs(point[3]) >= FAR**0.5:  # not at infinity
            crossing = value(knot + 1e-3) > 0
            how = "their curves cross or have a straight line in common" if crossing else "they touch"
            raise GeometryError(f"{pair.text}: at {pair.where(point[:3] / point[3])} {how}; move one of them")
    ends = zip(knots, [*knots[1:], knots[0] + 2 * np.pi], heights, [*heights[1:], heights[0]], strict=True)
    zeros = [float(brentq(value, low, high, xtol=1e-15, rtol=1e-15)) for low, high, u, v in ends if u * v < 0]
    return sorted(z % (2 * np.pi) for z in zeros)


def _poles(branch: QuadricBranch) -> tuple[float, ...]:
    """The s at which a branch is at infinity, ascending."""
    s = np.linspace(0.0, 1.0, SAMPLES + 1)
    points = branch.homogeneous(s)
    turns = np.where((points[1:] * points[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    last = points[:, 3] * np.concatenate([[1.0], np.cumprod(turns)])
    crossings = np.flatnonzero(last[1:] * last[:-1] < 0)
    poles = [float((s[i] * last[i + 1] - s[i + 1] * last[i]) / (last[i + 1] - last[i])) for i in crossings]
    near = np.flatnonzero(np.abs(last) < FAR)
    for run in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1) if len(near) else ():
        poles.append(float(s[run[np.abs(last[run]).argmin()]]))
    ordered = sorted(poles)
    return tuple(p for i, p in enumerate(ordered) if i == 0 or p - ordered[i - 1] > 1e-3)
