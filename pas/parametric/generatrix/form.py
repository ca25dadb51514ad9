"""A blend by a generatrix as a surface: its control points, its values, and its exact components where it has such.

For each s the segment runs from C1(s) to C2(s) with inner control points C_i + l_i T_i (Cheng and Gao, section 3),

    T_i = +-sqrt(1 - lambda_i^2) W_i + lambda_i E_i,

W_i across the curve in the tangent plane (N_i x C_i' or V_i) and E_i along it (C_i'), both of length one, the sign
such that T_i points to the other surface.  Where the curves are regular the blend meets both with G1, whatever
0 < l_i and -1 < lambda_i < 1 are.  A middle curve makes the segments quartic.

What does not depend on the shape values is kept (`Frames`): C, C', W, E, and the derivatives of these two in s
(differences; C' itself comes from the curve).  With them a point is the Bernstein sum of four or five control points,
and its normal P_s x P_t: a few products of small matrices.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import numpy as np
from flint import fmpq
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.callables import on_series
from pas.algebra.lengths import exponent, lengths, unit
from pas.algebra.rational import rational, square_root, three
from pas.algebra.rational_function import GENERATORS, ONE, RationalFunction, total
from pas.arrays import Floats, Integers
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.align import Alignment
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.paths import NAMES, value_at
from pas.parametric.generatrix.shape import FOUR, GeneratrixShape, ShapeFunction
from pas.parametric.nets import bernstein_at, bernstein_polynomials
from pas.parametric.series import Components
from pas.parametric.surface import ParametricSurface

STEP = 3e-6
"""The step of differences: truncation (2 pi step)^2 / 6 and rounding 1e-16 / step are both about 1e-10."""


@dataclass(frozen=True)
class Edge:
    """At n values of s: C and C' (n, 3), W and E as first rows, their derivatives as second rows (2, n, 3)."""

    point: Floats
    velocity: Floats
    across: Floats
    along: Floats

    def leg(self, length: ShapeFunction, slant: ShapeFunction, s: Floats) -> tuple[Floats, Floats]:
        """C + l T and its derivative, (n, 3) each."""
        size, growth = length(s)[:, None], length(s, 1)[:, None]
        slope, dslope = slant(s)[:, None], slant(s, 1)[:, None]
        rest = np.sqrt(1.0 - slope * slope)
        tangent = rest * self.across[0] + slope * self.along[0]
        change = rest * self.across[1] + slope * self.along[1]
        if dslope.any():
            change = change + dslope * (self.along[0] - slope / rest * self.across[0])
        return self.point + size * tangent, self.velocity + growth * tangent + size * change


@dataclass(frozen=True)
class Stations:
    """Both edges at n values of s, and the middle curve there with its derivative, (n, 3) each."""

    s: Floats
    edges: tuple[Edge, Edge]
    middle: tuple[Floats, Floats] | None

    def controls(self, shape: GeneratrixShape) -> tuple[Floats, Floats]:
        """Control points and their derivatives in s, (m + 1, n, 3) each."""
        assert shape.l1 is not None and shape.l2 is not None
        start, end = self.edges
        one, two = start.leg(shape.l1, shape.lambda1, self.s), end.leg(shape.l2, shape.lambda2, self.s)
        middle = [] if self.middle is None else [self.middle]
        rows = [(start.point, start.velocity), one, *middle, two, (end.point, end.velocity)]
        return np.stack([r[0] for r in rows]), np.stack([r[1] for r in rows])


@dataclass(frozen=True, eq=False)
class Frames:
    """The two boundaries, turned to fit, their signs, and what was computed of them.

    With `unit` false W and E are N x C' (or V) and C' as they are, not made of length one.
    """

    boundaries: tuple[Boundary, Boundary]
    signs: tuple[int, int]
    unit: bool
    middle: ParametricSurface | None = None

    @property
    def closed(self) -> bool:
        """Whether the curves are closed."""
        return self.boundaries[0].closed

    @property
    def degree(self) -> int:
        """The degree of the generatrices: 3, or 4 with a middle curve."""
        return 3 if self.middle is None else 4

    @cached_property
    def inward(self) -> bool:
        """Whether P_s x P_t at the first boundary is opposed to the normal of its surface, where that is known."""
        first = self.boundaries[0]
        if not first.has_normal:
            return False
        s = self.parameters(16)
        made = np.cross(unit(first.derivative(s)), self.signs[0] * unit(first.across(s)))
        return bool((made * unit(first.field(s))).sum() < 0)

    def parameters(self, size: int) -> Floats:
        """`size` values of s, evenly: for closed curves without s = 1."""
        return np.linspace(0.0, 1.0, size, endpoint=not self.closed)

    @cached_property
    def grid(self) -> Callable[[int], Stations]:
        """The stations at so many values of s, computed once."""
        return cache(lambda size: self.at(self.parameters(size)))

    def at(self, s: Floats) -> Stations:
        """Both edges and the middle curve at s (n,)."""
        first, second = (self._edge(b, sign, s) for b, sign in zip(self.boundaries, self.signs, strict=True))
        middle = None if self.middle is None else (value_at(self.middle, s), value_at(self.middle, s, 1))
        return Stations(s, (first, second), middle)

    def _edge(self, boundary: Boundary, sign: int, s: Floats) -> Edge:
        center = s if self.closed else np.clip(s, STEP, 1.0 - STEP)
        low, mid, high = (self._vectors(boundary, sign, center + k * STEP) for k in (-1, 0, 1))
        slope = (high - low) / (2 * STEP) + ((s - center) / STEP**2)[:, None] * (high - 2 * mid + low)
        here = mid if center is s else self._vectors(boundary, sign, s)
        both = np.stack([here, slope], axis=1)
        return Edge(boundary(s), boundary.derivative(s), both[0], both[1])

    def _vectors(self, boundary: Boundary, sign: int, s: Floats) -> Floats:
        """W and E (2, n, 3)."""
        both = np.stack([sign * boundary.across(s), boundary.derivative(s)])
        return unit(both) if self.unit else both

    def sheet(self, shape: GeneratrixShape, size: tuple[int, int]) -> tuple[Floats, Floats]:
        """Points and P_s x P_t over a common number on a grid: (n, m, 3) each."""
        controls, slopes = self.grid(size[0]).controls(shape)
        t = np.linspace(0.0, 1.0, size[1])
        value, slope = bernstein_at(self.degree, t), bernstein_at(self.degree, t, 1)
        small = np.ldexp(slopes, -exponent(slopes)), np.ldexp(controls, -exponent(controls))
        points, across, along = (
            np.einsum("ji,ikx->kjx", b, c) for b, c in ((value, controls), (value, small[0]), (slope, small[1]))
        )
        return points, np.cross(across, along)


@lru_cache(maxsize=32)
def connectivity(size: tuple[int, int], closed: bool, flipped: bool) -> Integers:
    """Triangles of a grid of points numbered row by row; a closed one is welded, its last row to the first."""
    n, m = size
    rows = np.arange(n if closed else n - 1)
    a = (rows[:, None] * m + np.arange(m - 1)[None]).ravel()
    b = (((rows + 1) % n)[:, None] * m + np.arange(m - 1)[None]).ravel()
    triangles = np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])
    return np.ascontiguousarray(triangles[:, ::-1] if flipped else triangles).astype(np.intp)


def with_lengths(shape: GeneratrixShape, frames: Frames) -> GeneratrixShape:
    """The shape with open lengths filled in: a third of the distance of corresponding points, rounded.

    A straight generatrix has its inner control points at thirds.  It is the mean distance, for closed curves with its
    first harmonic, so that the outside of a bend bulges as it should.
    """
    missing = [name for name in ("l1", "l2") if getattr(shape, name) is None]
    if not missing:
        return shape
    s = frames.parameters(120)
    first, second = frames.boundaries
    distance = 1 / 3 * lengths(first(s) - second(s))
    mean = float(distance.mean())
    wave = complex(2 * (distance * np.exp(2j * np.pi * s)).mean())
    swing = min(abs(wave), 0.9 * mean)  # more would not be positive
    if not frames.closed or not frames.unit or swing < 0.02 * mean:  # not worth it
        length = ShapeFunction.constant(f"{mean:.3g}")
    else:
        start = (np.angle(wave) / (2 * np.pi) + 0.5) % 1.0
        length = ShapeFunction.cosine(*(f"{x:.3g}" for x in (mean - swing, mean + swing, start)))
    return shape.changed(**dict.fromkeys(missing, length))


@dataclass(frozen=True, eq=False)
class GeneratrixForm:
    """A surface P(s, t) by a generatrix: t = 0 is the first boundary, t = 1 the second.

    `frames` holds the boundaries, turned to fit, `shape` the shape functions, `alignment` how the second was turned.
    """

    frames: Frames
    shape: GeneratrixShape
    alignment: Alignment

    __repr__ = brief

    @property
    def boundaries(self) -> tuple[Boundary, Boundary]:
        """The two boundaries, the second one turned to fit the first."""
        return self.frames.boundaries

    @property
    def closed(self) -> bool:
        """Whether the curves are closed, and the blend a tube."""
        return self.frames.closed

    @property
    def degree(self) -> int:
        """The degree of the generatrices."""
        return self.frames.degree

    def control_points(self, s: ArrayLike) -> Floats:
        """The control points of the generatrices at `s` (...): (..., 4, 3), with a middle curve (..., 5, 3).

        Raises `ValueError` for s outside [0, 1].
        """
        array = np.asarray(s, dtype=float)
        bad = array[~((array >= 0.0) & (array <= 1.0))]
        if bad.size:
            raise ValueError(f"parameter s = {bad[0]:.6g} lies outside [0, 1]")
        points, _ = self.frames.at(array.ravel()).controls(self.shape)
        return np.moveaxis(points, 0, 1).reshape(*array.shape, self.degree + 1, 3)

    @cached_property
    def surface(self) -> ParametricSurface:
        """The blend as a surface over [0, 1]^2, parameters (s, t).

        Exact where all data are: rational boundaries, `unit=False`, polynomial lengths, constant slants with
        rational sqrt(1 - lambda^2), a rational middle curve, and no shift of a closed curve.
        """
        reason = self._why_inexact
        source = None if reason else self._components
        return ParametricSurface.from_parts(on_series(self._derivative), source, NAMES, ((0, 1), (0, 1)), reason)

    def sheet(self, size: tuple[int, int] = (100, 100)) -> tuple[Floats, Floats]:
        """Points and unit normals on a grid of parameters, (n, m, 3) each; for closed curves s < 1."""
        points, normals = self.frames.sheet(self.shape, size)
        length = np.sqrt(np.einsum("ijk,ijk->ij", normals, normals))
        normals /= np.maximum(length, 1e-300)[..., None]
        return points, -normals if self.frames.inward else normals

    def gridded(self, size: tuple[int, int]) -> Mesh:
        """Triangles on a grid of `size` points in s and t, the seam of closed curves welded."""
        points, normals = self.sheet(size)
        triangles = connectivity(size, self.closed, self.frames.inward)
        both = np.meshgrid(self.frames.parameters(size[0]), np.linspace(0.0, 1.0, size[1]), indexing="ij")
        places = np.stack(both, axis=-1).reshape(-1, 2)
        return Mesh.smooth(points.reshape(-1, 3), triangles, normals.reshape(-1, 3), "blend", parameters=places)

    def _derivative(self, s: ArrayLike, t: ArrayLike, first: int, second: int) -> Floats:
        """d^(i+j) P / ds^i dt^j at arrays that broadcast; from the second order in s on by differences."""
        u, v = np.asarray(s, dtype=float), np.asarray(t, dtype=float)
        controls = np.moveaxis(self._controls(u.ravel(), first), 0, -2).reshape(*u.shape, -1, 3)
        return np.asarray(np.einsum("...i,...ix->...x", bernstein_at(self.degree, v, second), controls))

    def _controls(self, s: Floats, order: int) -> Floats:
        if order <= 1:
            return self.frames.at(s).controls(self.shape)[order]
        step = 1e-4
        center = s if self.closed else np.clip(s, order * step, 1 - order * step)
        low, high = (self._controls(center + k * step, order - 1) for k in (-1, 1))
        return np.asarray((high - low) / (2 * step))

    @property
    def _why_inexact(self) -> str:
        """Why the surface is not exact; empty where it is."""
        if self.frames.unit:
            return "the vectors are made of length one (unit=False leaves them)"
        for boundary in self.boundaries:
            if boundary.exact is None:
                return f"{boundary.name} is not rational"
            if boundary.phase not in (0.0, 1.0) or (boundary.closed and boundary.phase):
                return f"{boundary.name} starts at {boundary.phase:.4g}, between its ends"
        if self.frames.middle is not None and not self.frames.middle.is_exact:
            return "the middle curve is not rational"
        for name in FOUR[:2]:
            if getattr(self.shape, name).exact is None:
                return f"{name} is no polynomial"
        for name in FOUR[2:]:
            if _cosine_of(getattr(self.shape, name)) is None:
                return f"{name} is not a constant with a rational sqrt(1 - {name}^2), such as 0 or 3/5"
        return ""

    def _components(self) -> Components:
        """x, y, z as rational functions of s and t."""
        lengths, slants = (self.shape.l1, self.shape.l2), (self.shape.lambda1, self.shape.lambda2)
        pairs = zip(self.boundaries, self.frames.signs, lengths, slants, strict=True)
        (start, one), (end, two) = (_exact_leg(*each) for each in pairs)
        middle = [] if self.frames.middle is None else [self.frames.middle.components]
        weights = bernstein_polynomials(self.degree, GENERATORS[1], fmpq(0), fmpq(1))
        functions = [RationalFunction.quotient(w, ONE, NAMES) for w in weights]
        rows = list(zip(functions, [start, one, *middle, two, end], strict=True))
        return three(total([b * row[axis] for b, row in rows]) for axis in range(3))


def _exact_leg(
    boundary: Boundary, sign: int, length: ShapeFunction | None, slant: ShapeFunction
) -> tuple[Components, Components]:
    """C and C + l T of a boundary as functions of (s, t)."""
    exact, slope, rest = boundary.exact, slant.value, _cosine_of(slant)
    assert exact is not None and length is not None and slope is not None and rest is not None
    own = RationalFunction.quotient(1 - GENERATORS[0] if boundary.backwards else GENERATORS[0], ONE, NAMES)
    along = rational(-slope if boundary.backwards else slope)
    size = length.exact
    assert size is not None
    start = three(c.substitute(own, own) for c in exact.curve)
    ways = (w * (rest * sign) + e * along for w, e in zip(exact.across, exact.velocity, strict=True))
    return start, three(c + size * way.substitute(own, own) for c, way in zip(start, ways, strict=True))


def _cosine_of(slant: ShapeFunction) -> fmpq | None:
    """sqrt(1 - lambda^2) where it and lambda are rational numbers, else None."""
    if slant.value is None:
        return None
    square = 1 - rational(slant.value) ** 2
    root = square_root(square)
    return root if root * root == square else None
