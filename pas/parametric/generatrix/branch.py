"""A pair of quadrics, and one branch of the curve in which they meet as a parametrisation.

Where D > 0 for all angles a branch keeps one sign of the root.  Else it runs over an arc (a0, a1) with D > 0
inside and simple zeros at its ends, takes both signs, and a = m - w cos u makes it smooth there: with
D = sin((a - a0)/2) sin((a1 - a)/2) g(a) the signed root is

    sqrt(D) = (w/2) sin u sqrt(g(a) sinc(w sin^2(u/2)) sinc(w cos^2(u/2))),   sinc x = sin x / x.

Every point is improved by one step of Newton's method on both polynomials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.inputs import shown, shown_point
from pas.algebra.lengths import unit
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact
from pas.errors import GeometryError
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.paths import on_unit_interval
from pas.parametric.generatrix.quadric import Quadric, Rulings, to_array
from pas.parametric.generatrix.sections import Conic, ConicKind


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

    @property
    def seen(self) -> str:
        """A word on the coordinates of `local`, for messages."""
        return f"seen from {shown_point(self.offset, 6)}, " if self.offset.any() else ""


@dataclass(frozen=True, eq=False)
class QuadricBranch:
    """One branch of the intersection of two quadrics, a curve of s in [0, 1].

    `pair` holds the quadrics, and these as seen from a point nearby: rulings and conic are in those coordinates.
    `interval` are the angles that it runs over.  With a `factor` g it takes both signs of the root (then it is closed
    though D vanishes at the ends), else `sign` is the one.  `poles` are the s at which it is at infinity:
    it is `closed` where there are none.  `conic` is given instead where the branch is plane, `sign` then being that
    of a hyperbola's branch.
    """

    pair: QuadricPair
    interval: tuple[float, float]
    sign: int
    rulings: Rulings | None = None
    factor: Floats | None = None
    conic: Conic | None = None
    poles: tuple[float, ...] = ()

    __repr__ = brief

    @property
    def both_signs(self) -> bool:
        """Whether it takes both signs of the root of D."""
        return self.factor is not None

    @property
    def closed(self) -> bool:
        """Whether the branch is a closed curve in space (none of it at infinity)."""
        return not self.poles

    def __call__(self, s: ArrayLike) -> Floats:
        """Points at `s` (...): (..., 3); infinite or nan at poles."""
        array = np.asarray(s, dtype=float)
        return np.asarray(self.local(array.ravel()) + self.pair.offset).reshape(*array.shape, 3)

    @property
    def quadrics(self) -> tuple[Quadric, Quadric]:
        """The two quadrics as given."""
        return self.pair.given

    def homogeneous(self, s: Floats) -> Floats:
        """Homogeneous points (n, 4) of length one at s (n,), before Newton's step."""
        angle, root = self._place(s)
        assert self.rulings is not None
        return self.rulings.points(angle, root)

    def derivative(self, s: ArrayLike) -> Floats:
        """C'(s) at `s` (...): (..., 3): along the product of the gradients, its length by differences."""
        array = np.asarray(s, dtype=float)
        flat = array.ravel()
        if self.conic is not None:
            place, speed = self._conic_place(flat)
            along = self.conic(place, 1, self.sign) * speed[:, None]
            return np.asarray(along).reshape(*array.shape, 3)
        step = 1e-5  # for the speed alone: the direction comes from the gradients
        change = (self.local(flat + step) - self.local(flat - step)) / (2 * step)
        points = self.local(flat)
        first, second = (q.polynomial.gradient(points) for q in self.pair.local)
        along = unit(np.cross(first, second))
        speed = (change * along).sum(axis=1, keepdims=True)
        return np.asarray(speed * along).reshape(*array.shape, 3)

    def on(
        self, number: int, interval: Sequence[Exact] | None = None, name: str | None = None, side: int | None = None
    ) -> Boundary:
        """The branch as a boundary on quadric `number` (0 or 1) of the two.

        A branch that is not closed needs an `interval` of s without poles; of a closed one it takes a part.
        """
        if number not in (0, 1):
            raise ValueError(f"number must be 0 or 1, the quadric that the blend is to meet, not {shown(number)}")
        f = self.quadrics[number].polynomial
        other = self.quadrics[1 - number].polynomial
        name = f"the branch of {f} = 0 and {other} = 0" if name is None else name
        if interval is None and not self.closed:
            poles = ", ".join(f"{p:.4g}" for p in self.poles)
            raise GeometryError(f"{name} goes to infinity at s = {poles}: say which part, interval=(low, high)")
        low, high = (0.0, 1.0) if interval is None else on_unit_interval(interval, name)[0]
        inside = [p for p in self.poles for k in (-1, 0, 1) if low <= p + k <= high]
        if inside:
            raise GeometryError(f"{name} goes to infinity at s = {inside[0]:.4g}, inside the interval")
        width, near = high - low, self.pair.local[number].polynomial
        return Boundary(
            lambda s: self(low + width * s),
            lambda s: width * self.derivative(low + width * s),
            lambda s: near.gradient(self.local(low + width * s)),
            has_normal=True,
            closed=interval is None,
            name=name,
            side=side,
            surface=f,
        )

    def local(self, s: Floats) -> Floats:
        """Points (n, 3) at s (n,) in the coordinates of `pair.local`."""
        with np.errstate(all="ignore"):
            if self.conic is not None:
                return self.conic(self._conic_place(s)[0], 0, self.sign)
            points = self.homogeneous(s)
            return _polished(self.pair.local, points[:, :3] / points[:, 3:])

    def _conic_place(self, s: Floats) -> tuple[Floats, Floats]:
        """The conic's parameter and its derivative: the angle, or for open ones all reals."""
        assert self.conic is not None
        if self.conic.kind is ConicKind.ELLIPSE:
            return 2 * np.pi * s, np.full_like(s, 2 * np.pi)
        with np.errstate(all="ignore"):
            return 2 * np.arctanh(2 * s - 1), 1.0 / (s * (1 - s))

    def _place(self, s: Floats) -> tuple[Floats, Floats]:
        """The angles and the signed roots of D."""
        low, high = self.interval
        assert self.rulings is not None
        if self.factor is None:
            angle = low + (high - low) * s
            return angle, self.sign * np.sqrt(np.maximum(self.rulings.discriminant(angle), 0.0))
        turn, half = 2 * np.pi * s, (high - low) / 2
        angle = (low + high) / 2 - half * np.cos(turn)
        ends = np.sinc(half * np.sin(turn / 2) ** 2 / np.pi) * np.sinc(half * np.cos(turn / 2) ** 2 / np.pi)
        return angle, half / 2 * np.sin(turn) * np.sqrt(np.maximum(trigonometric(self.factor, angle) * ends, 0.0))

    def __str__(self) -> str:
        kind = "closed" if self.closed else f"open (at infinity at {len(self.poles)} places)"
        first, second = self.quadrics
        return f"a {kind} branch of {first.polynomial} = 0 and {second.polynomial} = 0"


def trigonometric(coefficients: np.ndarray, angle: Floats) -> Floats:
    """The real value of sum_k c_k e^(i(k - n/2)a), n the greatest k."""
    n = len(coefficients) - 1
    value = np.polynomial.polynomial.polyval(np.exp(1j * angle), coefficients)
    return np.asarray((value * np.exp(-0.5j * n * angle)).real)


def _polished(quadrics: tuple[Quadric, Quadric], points: Floats) -> Floats:
    """One step of Newton's method of least length on both polynomials."""
    f, g = (q.polynomial for q in quadrics)
    with np.errstate(all="ignore"):
        p, q = f.gradient(points), g.gradient(points)
        pp, pq, qq = ((a * b).sum(axis=-1) for a, b in ((p, p), (p, q), (q, q)))
        u, v = f(points), g(points)
        gram = pp * qq - pq * pq
        a, b = (u * qq - v * pq) / gram, (v * pp - u * pq) / gram
        moved = points - a[..., None] * p - b[..., None] * q
        good = np.isfinite(moved).all(axis=-1) & (gram > 1e-12 * pp * qq)
    return np.where(good[..., None], moved, points)
