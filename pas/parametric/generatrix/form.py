"""A blend by a generatrix as a surface: its control points, its values, and its exact components where it has such.

For each s the segment runs from C1(s) to C2(s) with inner control points C_i + l_i T_i,

    T_i = +-sqrt(1 - lambda_i^2) W_i + lambda_i E_i,

W_i across the curve in the tangent plane (N_i x C_i' or V_i) and E_i along it (C_i'), both of length one, the sign
such that T_i points to the other surface.  Where the curves are regular the blend meets both with G1, whatever
0 < l_i and -1 < lambda_i < 1 are.  A middle curve makes the segments quartic.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.callables import on_series
from pas.algebra.monomials import Floats
from pas.algebra.rational import rational
from pas.algebra.rational_function import GENERATORS, ONE, RationalFunction, total
from pas.mesh.mesh import Mesh
from pas.parametric.generatrix.align import Alignment
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.frames import Frames, connectivity
from pas.parametric.generatrix.paths import NAMES
from pas.parametric.generatrix.shape import FOUR, GeneratrixShape, ShapeFunction
from pas.parametric.nets import bernstein_at, bernstein_polynomials
from pas.parametric.series import Components, square_root
from pas.parametric.surface import ParametricSurface


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
        points, _ = self.frames.controls(self.shape, array.ravel())
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
        return Mesh.smooth(points.reshape(-1, 3), triangles, normals.reshape(-1, 3), "blend")

    def _derivative(self, s: ArrayLike, t: ArrayLike, first: int, second: int) -> Floats:
        """d^(i+j) P / ds^i dt^j at arrays that broadcast; from the second order in s on by differences."""
        u, v = np.asarray(s, dtype=float), np.asarray(t, dtype=float)
        controls = np.moveaxis(self._controls(u.ravel(), first), 0, -2).reshape(*u.shape, -1, 3)
        return np.asarray(np.einsum("...i,...ix->...x", bernstein_at(self.degree, v, second), controls))

    def _controls(self, s: Floats, order: int) -> Floats:
        if order <= 1:
            return self.frames.controls(self.shape, s)[order]
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
        pairs = zip(self.boundaries, self.frames.signs, self.shape.lengths, self.shape.slants, strict=True)
        (start, one), (end, two) = (_exact_leg(*each) for each in pairs)
        middle = [] if self.frames.middle is None else [self.frames.middle.components]
        weights = bernstein_polynomials(self.degree, GENERATORS[1], fmpq(0), fmpq(1))
        functions = [RationalFunction.quotient(w, ONE, NAMES) for w in weights]
        rows = list(zip(functions, [start, one, *middle, two, end], strict=True))
        x, y, z = (total([b * row[axis] for b, row in rows]) for axis in range(3))
        return x, y, z


def _exact_leg(
    boundary: Boundary, sign: int, length: ShapeFunction | None, slant: ShapeFunction
) -> tuple[Components, Components]:
    """C and C + l T of a boundary as functions of (s, t)."""
    exact, slope, rest = boundary.exact, slant.value, _cosine_of(slant)
    assert exact is not None and length is not None and slope is not None and rest is not None
    start = 1 - GENERATORS[0] if boundary.backwards else GENERATORS[0]
    own = RationalFunction.quotient(start, ONE, NAMES)
    along = rational(-slope if boundary.backwards else slope)
    size = length.exact
    assert size is not None
    x, y, z = (c.substitute(own, own) for c in exact.curve)
    tangent = [
        (w * (rest * sign) + e * along).substitute(own, own) for w, e in zip(exact.across, exact.velocity, strict=True)
    ]
    u, v, w = (c + size * part for c, part in zip((x, y, z), tangent, strict=True))
    return (x, y, z), (u, v, w)


def _cosine_of(slant: ShapeFunction) -> fmpq | None:
    """sqrt(1 - lambda^2) where it and lambda are rational numbers, else None."""
    value = slant.value
    return None if value is None else square_root(1 - rational(value) ** 2)
