"""Shape control on any solution space, exact where the mathematics is: optima, handles, least squares.

- `optimum`: the member of least energy (and squared values at points) under equations and
  inequalities, as exact rationals, with a certificate of optimality (the multipliers).
- `determining_set`: B-coefficients that can be set freely, and determine the member (a minimal
  determining set; Alfeld and Schumaker 1987).
- `least_squares`: the smallest `sum w_i f(p_i)^2 / |f|^2`, |f| the Euclidean length of the
  coefficient vector: a generalised eigenproblem (Lou, Feng, Chen and Deng 2002); or by gradients,
  `sum w_i f(p_i)^2 / sum w_i |grad f(p_i)|^2`, which approximates squared distances (Taubin 1991).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Unpack

import numpy as np
from flint import arb, fmpq, fmpq_mat
from scipy.linalg import svd

from pas.algebra.brief import brief
from pas.algebra.matrices import Products, leads
from pas.algebra.monomials import derivative_matrix, homogeneous_exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, Vector, rational, to_float, to_fraction
from pas.arrays import Floats
from pas.blending.net import Point, domain_point
from pas.blending.refining import refined
from pas.blending.space import Space
from pas.certify.free_curves import transversality
from pas.errors import InfeasibleError
from pas.fairing.basis import orthonormal, to_doubles
from pas.fairing.energy import Energy, as_energy
from pas.fairing.functionals import Handle, b_coefficient, value_at
from pas.fairing.programme import SIDES, ExactRows
from pas.fairing.qp import ExactProgramme, solve_exactly
from pas.fairing.wishes import (
    MeanAlpha,
    PointOptions,
    PointsLike,
    SumOfCoefficients,
    UnitCoefficients,
    Wishes,
    check_point_options,
    exact_points,
)
from pas.limits import Report, limited
from pas.piecewise import PiecewiseSurface


@dataclass(frozen=True, eq=False)
class Optimum:
    """The exact optimum: `coefficients` in the space's basis, the `surface`, its `energy` and the
    `value` of the whole objective.

    `active` maps each inequality that holds with equality, in words, to its multiplier (how fast the value falls when
    it is relaxed).  `unique` is False where the objective has several minimisers; then this is one of them.
    """

    surface: PiecewiseSurface
    coefficients: tuple[Fraction, ...]
    energy: Fraction
    value: Fraction
    active: dict[str, Fraction]
    unique: bool

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """The least-squares member: `coefficients` in the space's basis (doubles, the last one that is
    not tiny being 1 or -1), the `surface` with these taken exactly, and the quotient reached.

    Its sign, which the quotient does not tell, is that of the project: f < 0 inside (see `orientation`)."""

    surface: PiecewiseSurface
    coefficients: Floats
    quotient: float

    __repr__ = brief


@limited("finding the optimum", "a lower degree")
def optimum(
    space: Space,
    energy: Energy | None = None,
    *,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[PointOptions],
) -> Optimum:
    """The exact member of least energy, with its certificate of optimality.

    `options` are those of `fit` that are linear: `inside`, `outside` (`margin` 0 by default), `through`, `near`,
    `near_weight`, `handles`, `coefficients`, and `normalize`: the sum of coefficients is 1 by default, unless a handle
    or a coefficient with a value other than 0 fixes the scale.  No condition of a clean sheet is asked.

    Raises `InfeasibleError` for constraints that contradict, `NoSolutionError` for an empty space.
    """
    check_point_options(options)
    space.check_not_empty()
    wishes = Wishes(**options)
    if options.get("normalize") is not None:
        if isinstance(wishes.normalize, MeanAlpha | UnitCoefficients):
            raise ValueError(
                "an exact optimum needs a linear normalisation: pas.SumOfCoefficients() or pas.ValueAt(...)"
            )
    elif not any(value != 0 for _, value in wishes.handles + wishes.coefficients):
        wishes = wishes.changed(normalize=SumOfCoefficients())
    quadratic, m = as_energy(energy).products(space), space.dimension
    asked = ExactRows(wishes, space.partition, space.degree, lambda functional: functional.on(space.patches))
    near = fmpq_mat(m, m)
    for weight, row in zip(wishes.near_weights, asked.values("near"), strict=True):
        near += fmpq_mat(m, 1, row) * fmpq_mat(1, m, row) * (2 * weight)
    equations = asked.equations(fmpq_mat(m, m, [int(i == j) for i in range(m) for j in range(m)]))
    sides = ((kind, i, sign, row) for kind, sign in SIDES for i, row in enumerate(asked.values(kind)))
    sided = {(kind, i): [*(sign * v for v in row), wishes.margin or fmpq(0)] for kind, i, sign, row in sides}
    systems = (fmpq_mat(len(rows), m + 1, [v for row in rows for v in row]) for rows in (equations, sided.values()))
    programme = ExactProgramme(quadratic + near, *systems)
    try:
        solution = solve_exactly(programme)
    except InfeasibleError as error:
        raise InfeasibleError(f"no member of degree {space.degree} satisfies all constraints: {error}") from None
    a = solution.unknowns
    return Optimum(
        surface=space.member(a.entries()),
        coefficients=tuple(map(to_fraction, a.entries())),
        energy=to_fraction((a * quadratic * a.transpose())[0, 0] / 2),
        value=to_fraction(solution.value),
        active={wishes.describe([*sided][i]): to_fraction(v) for i, v in solution.multipliers.items()},
        unique=solution.unique,
    )


def handles(space: Space) -> tuple[Handle, ...]:
    """All B-coefficients of a space: (cell, multi-index), each domain point once, cell by cell."""
    cells = space.partition.cells or ((0, 1, 2, 3),)
    first: dict[Point, Handle] = {}
    for number, cell in enumerate(cells):
        for i, j, k, m in homogeneous_exponents(space.degree, 4):
            first.setdefault(domain_point(cell, (i, j, k, m)), (number, (i, j, k, m)))
    return tuple(first.values())


def determining_set(space: Space, prefer: Sequence[Handle] = ()) -> tuple[Handle, ...]:
    """B-coefficients that can be set freely and determine the member: `dimension` many.

    Each is (cell, multi-index of the cell's corners); those in `prefer` come first, as far as they are independent.
    Set some of them with `optimum(handles=...)` or `fit(handles=...)`, and the rest follow.
    """
    candidates = tuple(dict.fromkeys((*prefer, *handles(space))))
    functionals = [b_coefficient(space.partition, handle, space.degree) for handle in candidates]
    reduced, rank = space.functional_rows(functionals).transpose().rref()
    return tuple(candidates[lead] for lead in leads(reduced, rank))


def least_squares(
    space: Space, points: PointsLike, weights: Sequence[Exact] | None = None, *, by_gradient: bool = False
) -> LeastSquares:
    """The member with the least `sum w_i f(p_i)^2 / |f|^2`, |f| the length of its coefficients.

    With `by_gradient` the divisor is `sum w_i |grad f(p_i)|^2` instead: the quotient is then a mean
    squared distance to first order, whatever the place and size of the figure (Taubin 1991).  Of f and -f, which
    have the same quotient, it is the one that is negative at the centre of the partition, or has alpha > 0 on the
    contacts' curves where there is no centre.

    `points` are three numbers each (floats as the exact rationals they are), `weights` one positive number for each.
    For members through other points take `space.through(...)` first; with energy, inside or outside points use
    `fit(near=..., normalize=pas.UnitCoefficients())`.

    Raises `ValueError` for fewer points than dimensions less one.
    """
    points = exact_points(points, "points")
    space.check_not_empty()
    if len(points) < space.dimension - 1:
        raise ValueError(
            f"{len(points)} points do not determine one of {space.dimension} dimensions; "
            f"give at least {space.dimension - 1}, or choose by energy with `fit` or `optimum`"
        )
    given = [fmpq(1)] * len(points) if weights is None else [rational(w, "weights") for w in weights]
    if len(given) != len(points) or any(w <= 0 for w in given):
        raise ValueError(f"weights must be {len(points)} positive numbers, one for each point")
    vectors = fmpq_mat([[v for patch in member for v in patch.row(space.degree)] for member in space.basis])
    change = orthonormal(Products.of((vectors,)), lambda tables: tables[0].T)[0].matrix
    if by_gradient:
        below, below_weights = change * _gradients(space, points).transpose(), [w for w in given for _ in range(3)]
    else:
        below, below_weights = change * vectors, [fmpq(1)] * vectors.ncols()
    above = change * space.values(points).transpose()
    weighted = ((above, given), (below, below_weights))
    scaled, measured = (to_doubles(m).T * np.sqrt([to_float(w) for w in ws])[:, None] for m, ws in weighted)
    if by_gradient and np.linalg.matrix_rank(measured) < space.dimension:
        raise ValueError(
            "some member has no gradient at any of the points, so distances cannot be measured by gradients; "
            "give points off its singular curve, or leave by_gradient False"
        )
    triangular: Floats = np.asarray(np.linalg.qr(measured, mode="r"))
    # singular values, not eigenvalues: small quotients keep their digits
    _, singular, right = svd(np.linalg.solve(triangular.T, scaled.T).T, full_matrices=True)
    last = np.linalg.solve(triangular, right[-1])
    smallest = float(singular[-1]) if len(singular) == space.dimension else 0.0
    sharp = refined(last, above, below, (list(map(arb, given)), list(map(arb, below_weights))), change)
    found, quotient = (last @ to_doubles(change), smallest**2) if sharp is None else sharp
    coefficients = np.asarray(found)
    significant = np.flatnonzero(np.abs(coefficients) > 1e-9 * np.abs(coefficients).max())
    coefficients = coefficients / coefficients[significant[-1]]
    coefficients = coefficients * orientation(space.member([float(c) for c in coefficients]))
    return LeastSquares(space.member([float(c) for c in coefficients]), coefficients, quotient)


def orientation(surface: PiecewiseSurface) -> int:
    """1 for a surface whose function is negative inside, as all proofs take it, else -1.

    It is negative at the centre of the partition.  Where that is on the surface, or where there is none, alpha is
    positive on the contacts' curves in the region's faces, in the mean of all; without such curves there is no inside,
    and it is 1.
    """
    center = 0 if surface.partition.center is None else surface.patches[0].at((0, 0, 0))  # in local coordinates
    if center:
        return -1 if center > 0 else 1
    alpha = 0.0
    for join in surface.joins:
        for face, (points, weights) in zip(join.faces, join.measured_curves() if join.faces else (), strict=True):
            f, d = join.contact.surface, Polynomial.from_raw(face.plane.raw)
            # both are the same multiple of what alpha is on the curve
            above, below = (transversality(g, f, d)(points) for g in (surface.patches[face.piece], f))
            alpha += float(weights @ (above / below))
    return -1 if alpha < 0 else 1


def _gradients(space: Space, points: Sequence[Vector]) -> fmpq_mat:
    """The exact gradients of the members at points, a row for each coordinate: (3 m, dimension)."""
    derivatives = (fmpq_mat(derivative_matrix(space.degree, axis).T.astype(int).tolist()) for axis in range(3))
    slopes = [[patch * derivative for patch in space.patches] for derivative in derivatives]
    values = (value_at(space.partition, point, space.degree, f"points[{i}]") for i, point in enumerate(points))
    rows = [v / space.partition.frame.scale for at in values for patches in slopes for v in at.on(patches)]
    return fmpq_mat(3 * len(points), space.dimension, rows)
