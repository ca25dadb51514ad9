"""Everything of a blend that does not depend on its shape values, and fast evaluation with them.

Along each curve: C, C', the vector W across it and E along it, and the derivatives of these two in s
(differences; C' itself comes from the curve).  Then a control leg is C + l (sqrt(1 - lambda^2) W + lambda E), a point
the Bernstein sum of four or five control points, and its normal P_s x P_t: a few products of small matrices.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from pas.algebra.lengths import exponent, lengths, unit
from pas.algebra.monomials import Floats
from pas.mesh.rows import Integers
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.paths import value_at
from pas.parametric.generatrix.shape import GeneratrixShape, ShapeFunction
from pas.parametric.nets import bernstein_at
from pas.parametric.surface import ParametricSurface

STEP = 3e-6
"""Of the differences: truncation (2 pi step)^2 / 6 and rounding 1e-16 / step are both about 1e-10."""


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


@dataclass(frozen=True, eq=False)
class Frames:
    """The two boundaries, turned to fit, their signs, and what was computed of them.

    With `unit` false W and E are N x C' (or V) and C' as they are, not made of length one.
    """

    boundaries: tuple[Boundary, Boundary]
    signs: tuple[int, int]
    unit: bool
    middle: ParametricSurface | None = None
    kept: dict[int, tuple[Floats, tuple[Edge, Edge], tuple[Floats, Floats] | None]] = field(default_factory=dict)

    @property
    def closed(self) -> bool:
        """Whether the curves are."""
        return self.boundaries[0].closed

    @property
    def degree(self) -> int:
        """Of the generatrices: 3, or 4 with a middle curve."""
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

    def grid(self, size: int) -> tuple[Floats, tuple[Edge, Edge], tuple[Floats, Floats] | None]:
        """The values of s and what belongs to them, computed once."""
        if size not in self.kept:
            s = self.parameters(size)
            self.kept[size] = (s, self.edges(s), self.middles(s))
        return self.kept[size]

    def edges(self, s: Floats) -> tuple[Edge, Edge]:
        """Both edges at s (n,)."""
        first, second = (self._edge(b, sign, s) for b, sign in zip(self.boundaries, self.signs, strict=True))
        return first, second

    def middles(self, s: Floats) -> tuple[Floats, Floats] | None:
        """The middle curve and its derivative at s (n,)."""
        if self.middle is None:
            return None
        return value_at(self.middle, s), value_at(self.middle, s, 1)

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

    def controls(self, shape: GeneratrixShape, s: Floats, size: int | None = None) -> tuple[Floats, Floats]:
        """Control points and their derivatives in s, (m + 1, n, 3) each; with `size` those kept for that grid."""
        if size is None:
            edges, middle = self.edges(s), self.middles(s)
        else:
            _, edges, middle = self.grid(size)
        assert shape.l1 is not None and shape.l2 is not None
        start, end = edges
        one = start.leg(shape.l1, shape.lambda1, s)
        two = end.leg(shape.l2, shape.lambda2, s)
        rows = [(start.point, start.velocity), one, *([] if middle is None else [middle]), two]
        rows.append((end.point, end.velocity))
        return np.stack([r[0] for r in rows]), np.stack([r[1] for r in rows])

    def sheet(self, shape: GeneratrixShape, size: tuple[int, int]) -> tuple[Floats, Floats]:
        """Points and P_s x P_t over a common number on a grid: (n, m, 3) each."""
        s = self.grid(size[0])[0]
        controls, slopes = self.controls(shape, s, size[0])
        t = np.linspace(0.0, 1.0, size[1])
        value, slope = bernstein_at(self.degree, t), bernstein_at(self.degree, t, 1)
        points = _combined(value, controls)
        across, along = (_combined(b, np.ldexp(c, -exponent(c))) for b, c in ((value, slopes), (slope, controls)))
        return points, _crossed(across, along)


def _combined(weights: Floats, controls: Floats) -> Floats:
    """sum_i weights[j, i] controls[i, k]: (k, j, 3)."""
    size = controls.shape[1]
    flat = weights @ controls.reshape(len(controls), -1)
    return np.ascontiguousarray(flat.reshape(len(weights), size, 3).swapaxes(0, 1))


def _crossed(a: Floats, b: Floats) -> Floats:
    """The vector product along the last axis, with fewer copies than numpy's."""
    result = np.empty_like(a)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[..., j], b[..., k], out=result[..., i])
        result[..., i] -= a[..., k] * b[..., j]
    return result


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
