"""Values of polynomials at many points by Horner's rule.

The rule runs over z inside y inside x (Higham 2002, section 5.1), every product and sum rounded on its own.  All
kernels do these in the same order, so they give the same doubles, bit for bit, on every machine; only their speed
differs.  Compiled code is used (see `pas.kernels`); the one with numpy is what tests compare it with.

The result at a point x errs by at most `2 (n + 3) u / (1 - 2 (n + 3) u)` times the sum of |c| |x|^a over the
terms c x^a, with u = 2^-53 and the degree n: every term goes through at most that many roundings.
"""

from __future__ import annotations

import os
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, count, monomial_values, positions
from pas.limits import checkpoint

WORKSPACE = 1 << 17
"""Doubles that numpy works on at once (1 MB): they stay in the caches, and calls are few."""

SHORTEST, LONGEST_BLOCK = 64, 1 << 13
"""Points in a block: fewer and calls outweigh the work, more and nothing is gained."""

FEW = 4
"""Polynomials for which Horner's rule is faster than products of all monomials and a matrix."""

CHUNK_ENTRIES = 1 << 17
"""Entries of the monomial matrix held at once (1 MB): larger blocks fall out of the caches."""

VARIABLE = "PAS_KERNEL"
"""The environment variable by which tests ask for a kernel: `numpy`, or `compiled`, which is that in use."""


class Kernel(Protocol):
    """Evaluates polynomials: `name` says by which means."""

    name: str

    def __call__(self, coefficients: Floats, degree: int, points: Floats, out: Floats) -> None:
        """Write the values of m polynomials at N points into `out` (m, N).

        `coefficients` (m, C(n+3, 3)) stand in the order of `monomials.exponents(degree)`; `points` (3, N).
        """


class NumpyKernel:
    """Horner's rule for all rows of coefficients at once: of each variable, few calls on arrays that stay in cache."""

    name = "numpy"

    def __call__(self, coefficients: Floats, degree: int, points: Floats, out: Floats) -> None:
        """See `Kernel`."""
        size = count(degree, 2) * len(coefficients)
        step = min(LONGEST_BLOCK, max(SHORTEST, WORKSPACE // size))
        first, levels = _rows(degree)
        start = np.ascontiguousarray(coefficients[:, first].T)[..., None]
        added = [np.ascontiguousarray(coefficients[:, level].T)[..., None] for level in levels]
        space = np.empty((*start.shape[:2], min(step, points.shape[1])))
        for here in range(0, points.shape[1], step):
            x, y, z = points[:, here : here + step]
            rows = space[..., : len(x)]
            rows[...] = start
            for constants in added:
                part = rows[: len(constants)]
                part *= z
                part += constants
            _combine(rows, degree, x, y, out[:, here : here + step])


def _combine(rows: Floats, degree: int, x: Floats, y: Floats, out: Floats) -> None:
    """Horner's rule in y and then in x, of rows x^a y^b by rising a + b and a."""
    in_x = rows[count(degree - 1, 2) :]
    for total in range(degree - 1, -1, -1):
        part = in_x[: total + 1]
        part *= y
        part += rows[count(total - 1, 2) : count(total, 2)]
    out[...] = in_x[degree]
    for a in range(degree - 1, -1, -1):
        out *= x
        out += in_x[a]


@cache
def _rows(degree: int) -> tuple[NDArray[np.intp], tuple[NDArray[np.intp], ...]]:
    """Where the highest coefficients in z of the rows x^a y^b stand, and those that are added in each step.

    Rows are ordered by rising a + b, then a; a step multiplies by z those that are long enough.
    """
    where = positions(degree)
    rows = [(a, total - a) for total in range(degree + 1) for a in range(total + 1)]
    first = np.array([where[a, b, degree - a - b] for a, b in rows], dtype=np.intp)
    levels = tuple(
        np.array([where[a, b, degree - a - b - step] for a, b in rows if a + b + step <= degree], dtype=np.intp)
        for step in range(1, degree + 1)
    )
    return first, levels


NUMPY: Kernel = NumpyKernel()


def horner(coefficients: Floats, degree: int, points: Floats, out: Floats) -> None:
    """Values of m polynomials at N points, written into `out` (m, N); see `Kernel`."""
    with np.errstate(all="ignore"):  # what overflows is infinite or NaN, without a word by any kernel
        chosen()(coefficients, degree, points, out)


def evaluate(points: Floats, coefficients: Floats) -> Floats:
    """Values of polynomials of one degree at many points.

    `points` (..., 3); `coefficients` (C(n+3, 3), m), a polynomial a column; result (..., m).  Of more than `FEW`
    polynomials the last digits depend on the machine's linear algebra library.
    """
    flat = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
    size, columns = coefficients.shape
    degree = next(n for n in range(size) if count(n) >= size)
    result = np.empty((len(flat), columns))
    step = max(1, CHUNK_ENTRIES // max(size, columns))
    for start in range(0, len(flat), step):
        checkpoint()
        block, out = flat[start : start + step], result[start : start + step]
        if columns > FEW:
            np.matmul(monomial_values(block, degree).T, coefficients, out=out)
            continue
        values = np.empty((columns, len(block)))
        horner(coefficients.T, degree, np.ascontiguousarray(block.T), values)
        out[...] = values.T
    return result.reshape(*np.shape(points)[:-1], columns)


def chosen() -> Kernel:
    """The kernel in use.  Raises `ValueError` where the environment asks for one that there is not."""
    return best() if compiling() else NUMPY


def compiling() -> bool:
    """Whether compiled code is used, as it is unless the environment asks for numpy.

    Raises `ValueError` where the environment asks for a kernel that there is not.
    """
    wanted = os.environ[VARIABLE] if VARIABLE in os.environ else ""  # noqa: SIM401  # `get` takes three times as long
    if wanted not in ("", "numpy", "compiled"):
        raise ValueError(f"the environment variable {VARIABLE} must be numpy or compiled, not {wanted!r}")
    return wanted != "numpy"


@cache
def best() -> Kernel:
    """The compiled kernel."""
    from pas.algebra.compiled import CompiledKernel

    return CompiledKernel()
