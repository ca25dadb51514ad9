"""Where rays first meet a piecewise surface.

In each cell the surface along a ray is a univariate polynomial; its B-form on the ray's segment
in the cell is bisected until the first root is isolated (variation diminishing: no sign change
among the B-coefficients means no root, one means exactly one; Lane and Riesenfeld 1981).
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np

from pas.algebra.monomials import Floats, evaluate
from pas.bernstein.subdivision import halving
from pas.partition.cells import Partition

BISECTIONS = 60


def first_hits(partition: Partition, columns: Floats, origins: Floats, directions: Floats) -> Floats:
    """Ray parameters t >= 0 of the first hits, (N,), NaN for rays that miss.

    `columns[c]` (C(n+3, 3),) are the coefficients of the polynomial in cell c, `origins` and
    `directions` (N, 3), all in the partition's coordinates.
    """
    result = np.full(len(origins), np.inf)
    at = partition.barycentric(origins)
    slopes = partition.barycentric(origins + directions) - at
    for cell, column in enumerate(columns):
        enter, leave = _span(at[cell].T, slopes[cell].T)
        rows = np.flatnonzero((leave > enter) & (enter < result))
        if len(rows):
            t = _first_root(column, origins[rows], directions[rows], enter[rows], leave[rows])
            result[rows] = np.fmin(result[rows], t)
    return np.where(np.isfinite(result), result, np.nan)


def _span(at: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Where rays are in a tetrahedron: all four barycentric coordinates nonnegative, t >= 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = -at / slope
    enter = np.where(slope > 0, crossing, -np.inf).max(axis=1)
    leave = np.where(slope < 0, crossing, np.inf).min(axis=1)
    outside = ((slope == 0) & (at < 0)).any(axis=1)
    return np.maximum(enter, 0.0), np.where(outside, -np.inf, leave)


def _first_root(column: Floats, origins: Floats, directions: Floats, enter: Floats, leave: Floats) -> Floats:
    degree = next(n for n in range(len(column)) if (n + 1) * (n + 2) * (n + 3) // 6 >= len(column))
    nodes, to_bernstein = _interpolation(degree)
    t = enter[:, None] + (leave - enter)[:, None] * nodes
    samples = evaluate(origins[:, None] + t[..., None] * directions[:, None], column[:, None])[..., 0]
    forms = samples @ to_bernstein.T
    roots = np.full(len(origins), np.inf)
    rows, start, width = np.arange(len(origins)), enter, leave - enter
    left, right = halving(degree, 2, 0) if degree else (np.eye(1), np.eye(1))
    for _ in range(BISECTIONS):
        alive = (forms.min(axis=1) <= 0) & (forms.max(axis=1) >= 0) & (start < roots[rows])
        forms, rows, start, width = forms[alive], rows[alive], start[alive], width[alive]
        if not len(rows):
            return roots
        width = np.tile(width / 2, 2)
        forms = np.concatenate([forms @ left.T, forms @ right.T])
        start = np.concatenate([start, start + width[: len(start)]])
        rows = np.tile(rows, 2)
        small = width <= 1e-15 * np.maximum(1.0, np.abs(start))
        np.minimum.at(roots, rows[small], start[small])
        keep = ~small
        forms, rows, start, width = forms[keep], rows[keep], start[keep], width[keep]
    np.minimum.at(roots, rows, start + width / 2)
    return roots


@cache
def _interpolation(degree: int) -> tuple[Floats, Floats]:
    """Chebyshev-Lobatto nodes on [0, 1] and the map from values there to B-coefficients."""
    powers = range(degree + 1)
    nodes = (1 - np.cos(np.pi * np.arange(degree + 1) / max(degree, 1))) / 2
    basis = np.array([[comb(degree, j) * (1 - s) ** (degree - j) * s**j for j in powers] for s in nodes])
    return nodes, np.linalg.inv(basis)
