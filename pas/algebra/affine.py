"""Exact affine maps of space, and local frames: what they do to polynomials and points."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_mpoly

from pas.algebra.inputs import whole
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import (
    UNITS,
    Exact,
    Vector,
    VectorLike,
    binary_exponent,
    dot,
    minus,
    moved,
    near,
    rational,
    three,
    to_float,
    to_floats,
    two_across,
    vector,
)
from pas.arrays import Floats

ORIGIN = (fmpq(0), fmpq(0), fmpq(0))


def away(point: Sequence[fmpq]) -> list[fmpq_mpoly]:
    """The coordinates relative to a point: x - p, y - q, z - r."""
    return [g - c for g, c in zip(GENERATORS, point, strict=True)]


def height(point: Sequence[fmpq], direction: Sequence[fmpq]) -> fmpq_mpoly:
    """How far along a direction from a point: `direction . (x - point)`, zero in the plane across it there."""
    return sum((d * a for d, a in zip(away(point), direction, strict=True)), GENERATORS[0] * 0)


def quadratic_form(polynomial: Polynomial) -> fmpq_mat:
    """The symmetric matrix (4, 4), in x, y, z and 1, of a polynomial of degree 2 at most."""
    rows = [[fmpq(0)] * 4 for _ in range(4)]
    for exponents, value in polynomial.raw.to_dict().items():
        i, j = [axis for axis, e in enumerate((*exponents, 2 - sum(exponents))) for _ in range(e)]
        rows[i][j] += value / 2
        rows[j][i] += value / 2
    return fmpq_mat(rows)


def slope_at(polynomial: Polynomial, point: Vector = ORIGIN) -> Vector:
    """The gradient at a point, at 0 if none is given, exact."""
    return three(polynomial.diff(i).raw(*point) for i in range(3))


def center_equations(polynomial: Polynomial) -> list[list[fmpq]]:
    """Where the gradient of a polynomial of degree 2 vanishes: three equations (3, 4), right-hand sides last."""
    form = quadratic_form(polynomial)
    return [[form[i, 0], form[i, 1], form[i, 2], -form[i, 3]] for i in range(3)]


@dataclass(frozen=True)
class Affine:
    """The map `x -> matrix x + shift`, exact; rows of the matrix as tuples."""

    matrix: tuple[Vector, Vector, Vector]
    shift: Vector

    @cached_property
    def inverse(self) -> Affine:
        """The inverse map."""
        inverse = fmpq_mat([list(row) for row in self.matrix]).inv()
        rows = three(three(row) for row in inverse.tolist())
        return Affine(rows, three(-dot(row, self.shift) for row in rows))

    def polynomial(self, polynomial: Polynomial) -> Polynomial:
        """The polynomial whose zero set is the image of that of `polynomial`."""
        inverse = self.inverse
        images = (height(ORIGIN, row) + s for row, s in zip(inverse.matrix, inverse.shift, strict=True))
        return polynomial.compose(*map(Polynomial.from_raw, images))

    def exact(self, point: Vector) -> Vector:
        """The image of one exact point."""
        return three(dot(row, point) + s for row, s in zip(self.matrix, self.shift, strict=True))

    def direction(self, vector: Vector) -> Vector:
        """The image of one exact vector: the difference of the images of two points."""
        return three(dot(row, vector) for row in self.matrix)

    def after(self, first: Affine) -> Affine:
        """The map that does `first`, then this one."""
        columns = (self.direction(column) for column in zip(*first.matrix, strict=True))
        return Affine(three(zip(*columns, strict=True)), self.exact(first.shift))

    def points(self, points: Floats) -> Floats:
        """Images of points (..., 3)."""
        return points @ self.floats[0].T + self.floats[1]

    @cached_property
    def floats(self) -> tuple[Floats, Floats]:
        """Matrix and shift rounded to doubles."""
        return np.array([to_floats(row) for row in self.matrix]), np.array(to_floats(self.shift))

    def similarity(self) -> float:
        """The factor by which lengths change; `ValueError` where it depends on the direction."""
        squares = {dot(a, a) for a in zip(*self.matrix, strict=True)}
        columns = list(zip(*self.matrix, strict=True))
        if len(squares) > 1 or any(dot(columns[i], columns[j]) != 0 for i, j in ((0, 1), (0, 2), (1, 2))):
            raise ValueError("a solid with a tube or a shell can only be scaled by the same factor in all directions")
        return math.sqrt(to_float(squares.pop()))


@dataclass(frozen=True)
class Frame:
    """A local frame, in which the program computes: `x = origin + scale * u`, exact.

    The origin is rational and the scale a power of two, so that a region is of size about 1 around 0.  Exact results
    do not depend on it; floating-point work does: a corner a kilometre from the origin would lose its digits in
    powers of large coordinates.
    """

    origin: Vector
    scale: fmpq

    @classmethod
    def around(cls, origin: Vector, points: Sequence[Vector]) -> Frame:
        """The frame at `origin` in which the furthest of `points` is at a distance of 1 to 2."""
        offsets = (minus(p, origin) for p in points)
        return cls(origin, fmpq(2) ** (binary_exponent(max(dot(d, d) for d in offsets)) // 2))

    @cached_property
    def affine(self) -> Affine:
        """The map from local coordinates to the user's."""
        return Affine(three(three(self.scale * c for c in row) for row in UNITS), self.origin)

    def localise(self, polynomial: Polynomial) -> Polynomial:
        """A function of the user's coordinates as one of local coordinates, exact."""
        return self.affine.inverse.polynomial(polynomial)

    def globalise(self, polynomial: Polynomial) -> Polynomial:
        """A function of local coordinates as one of the user's, exact."""
        return self.affine.polynomial(polynomial)

    def local_point(self, point: Sequence[fmpq]) -> Vector:
        """Local coordinates of a point, exact."""
        return three((a - o) / self.scale for a, o in zip(point, self.origin, strict=True))

    def local_points(self, points: Floats) -> Floats:
        """Local coordinates of points (..., 3)."""
        return (np.asarray(points, dtype=float) - to_floats(self.origin)) / to_float(self.scale)

    def place(self, point: Floats) -> tuple[float, float, float]:
        """One local point (3,) in global coordinates, as Python's numbers."""
        return three(self.global_points(point).tolist())

    def global_points(self, points: Floats) -> Floats:
        """The user's coordinates of local points (..., 3)."""
        return np.asarray(points, dtype=float) * to_float(self.scale) + to_floats(self.origin)


def translation(offset: VectorLike) -> Affine:
    """The map that adds `offset`."""
    return Affine(UNITS, vector(offset, "offset"))


def about(matrix: tuple[Vector, Vector, Vector], center: VectorLike) -> Affine:
    """The linear map with `center` kept in place."""
    c = vector(center, "center")
    return Affine(matrix, three(a - dot(row, c) for a, row in zip(c, matrix, strict=True)))


def rotation(axis: VectorLike, degrees: Exact, center: VectorLike) -> Affine:
    """The rotation about an axis through `center`, exactly a rotation with rational entries.

    It is two reflections, in planes at half of the angle.  The angle is `degrees` to within rounding of a double;
    multiples of 90 degrees about axes of rational length, and whatever else has a rational tangent of its half, are
    exact.
    """
    a = vector(axis, "axis")
    if not any(a):
        raise ValueError("axis must not be the zero vector")
    first, second = two_across(a)
    angle = to_float(rational(degrees, "degrees")) % 360.0
    if angle != 180.0:  # else half of it is a right angle, which has no tangent
        tangent = math.tan(math.radians(angle) / 2) / math.sqrt(to_float(dot(a, a)))
        second = moved(first, (near(tangent), second))  # off by less than 1e-17 radians of what a double can say
    return reflection(second, center).after(reflection(first, center))


def scaling(factors: Exact | VectorLike, center: VectorLike) -> Affine:
    """Scaling by one number or three, all positive, with `center` kept in place."""
    several = hasattr(factors, "__len__") and not isinstance(factors, str)
    sizes = vector(factors, "factors") if several else [rational(factors, "the factor")] * 3
    if any(f <= 0 for f in sizes):
        raise ValueError(f"the factor must be positive, not {factors!r}; use mirror to reflect")
    return about(three(three(f * c for c in unit) for f, unit in zip(sizes, UNITS, strict=True)), center)


def reflection(normal: VectorLike, center: VectorLike) -> Affine:
    """The reflection in the plane through `center` with a normal (any nonzero rational vector)."""
    n = vector(normal, "normal")
    square = dot(n, n)
    if square == 0:
        raise ValueError("normal must not be the zero vector")
    return about(three(three(UNITS[i][j] - 2 * n[i] * n[j] / square for j in range(3)) for i in range(3)), center)


def translations(count: int, offset: VectorLike) -> list[Affine]:
    """The maps that move `count` copies, but for the first, each by `offset` from the one before."""
    step = vector(offset, "offset")
    return [translation([k * c for c in step]) for k in range(1, whole(count, "count", 1, 10_000))]


def turns(count: int, axis: VectorLike, center: VectorLike, step: Exact | None) -> list[Affine]:
    """The maps that turn `count` copies, but for the first, each by `step` degrees, or evenly all around."""
    number = whole(count, "count", 1, 10_000)
    degrees = fmpq(360, number) if step is None else rational(step, "step")
    return [rotation(axis, k * degrees, center) for k in range(1, number)]


def numbered(names: Iterable[str], copy: int) -> dict[str, str]:
    """Names for copy number `copy` of things with these names: "hole #2" for "hole" in the second copy; where the
    original has "hole" up to "hole #m", copies continue with "hole #m+1"."""
    split = {name: re.fullmatch(r"(.*?)(?: #([2-9]|[1-9]\d+))?", name, re.DOTALL) for name in names if name}
    known = {name: (found[1], int(found[2] or 1)) for name, found in split.items() if found}
    most = dict(sorted(known.values()))
    moved = {name: f"{base} #{(copy - 1) * most[base] + number}" for name, (base, number) in known.items()}
    return {name: moved.get(name, name) if copy > 1 else name for name in names}


M = TypeVar("M")


class AffineShape(ABC, Generic[M]):
    """A shape that affine maps apply to; it is immutable: all methods return a new one."""

    @abstractmethod
    def _moved(self, map_: Affine) -> M:
        """The image."""

    def translate(self, offset: Exact | VectorLike, *others: Exact) -> M:
        """The shape moved by three numbers (the model's units), given in one sequence or one by one."""
        return self._moved(translation((offset, *others) if others else offset))  # type: ignore[arg-type]

    def rotate(self, axis: VectorLike, degrees: Exact | None = None, center: VectorLike = (0, 0, 0)) -> M:
        """The shape turned about an axis through `center`, counterclockwise seen from the axis' tip.

        Exact rotations by rational matrices; the angle is `degrees` up to rounding, and exact for
        multiples of 90 about an axis of rational length.  Raises `TypeError` where one of the two is missing.
        """
        if degrees is None:
            raise TypeError(f"rotate takes an axis and degrees, as in shape.rotate((0, 0, 1), 90), not {axis!r} alone")
        return self._moved(rotation(axis, degrees, center))

    def scale(self, factor: Exact | VectorLike, *others: Any, center: VectorLike = (0, 0, 0)) -> M:
        """The shape scaled by a positive number, or by three, one for each axis, with `center` kept in place.

        The three are given in one sequence or one by one; the centre may stand after the factor, too.
        """
        if len(others) == 1:
            return self._moved(scaling(factor, others[0]))
        return self._moved(scaling((factor, *others) if others else factor, center))  # type: ignore[arg-type]

    def mirror(self, normal: VectorLike, center: VectorLike = (0, 0, 0)) -> M:
        """The shape reflected in the plane through `center` with the given normal."""
        return self._moved(reflection(normal, center))

    def pattern(self, count: int, offset: VectorLike) -> M:
        """`count` copies as one shape, each moved by `offset` (the model's units) from the one before.

        What is named "hole" is named "hole #2" in the second copy, and so on; in a pattern of a pattern of m copies
        numbers go on, with "hole #m+1".  Raises `TypeError` for a shape that has no unions, such as a surface,
        `ValueError` for a count that is no whole number of at least 1.
        """
        return self._patterned(translations(count, offset))

    def circular_pattern(
        self, count: int, axis: VectorLike, center: VectorLike = (0, 0, 0), step: Exact | None = None
    ) -> M:
        """`count` copies turned about an axis through `center`, evenly all around, or each by `step` degrees.

        Names are those of `pattern`, and so are the errors; angles are exact as those of `rotate`.
        """
        return self._patterned(turns(count, axis, center, step))

    def _patterned(self, maps: Sequence[Affine]) -> M:
        """The shape and its images, as one."""
        raise TypeError(f"a pattern is of solids, meshes, assemblies or profiles; {self!r} has no union")
