"""Bernstein forms of polynomials in two parameters on [0, 1]^2: conversion and products.

There a polynomial has the coefficients b_ij = sum_{p<=i, q<=j} C(i,p) C(j,q) / (C(n,p) C(m,q)) a_pq in the basis
B_i(u) B_j(v), and its values lie between them (Farin 2002, chapter 6).
"""

from __future__ import annotations

from itertools import pairwise
from math import comb

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.monomials import Floats

Table = list[list[fmpq]]


def box_form(polynomial: fmpq_mpoly, degrees: list[int]) -> Table:
    """The coefficients over [0, 1]^2 as a polynomial of these degrees, exact."""
    n, m = degrees
    table = [[fmpq(0)] * (m + 1) for _ in range(n + 1)]
    for (p, q), c in polynomial.to_dict().items():
        table[int(p)][int(q)] = c / (comb(n, int(p)) * comb(m, int(q)))
    rows = [_accumulated(row) for row in table]
    return [list(row) for row in zip(*(_accumulated(list(c)) for c in zip(*rows, strict=True)), strict=True)]


def product(left: Floats, right: Floats) -> Floats:
    """Products of nets (C, m+1, n+1, d) and (C, k+1, l+1, d): degrees add, C and d broadcast (Farin 2002, 5.12)."""
    degrees = [(a - 1, b - 1) for a, b in zip(left.shape[1:3], right.shape[1:3], strict=True)]
    (rows, more), (columns, further) = ((_binomials(a), _binomials(b)) for a, b in degrees)
    first = left * (rows[:, None] * columns[None, :])[..., None]
    second = right * (more[:, None] * further[None, :])[..., None]
    count, last = max(len(left), len(right)), max(left.shape[3], right.shape[3])
    result = np.zeros((count, degrees[0][0] + degrees[0][1] + 1, degrees[1][0] + degrees[1][1] + 1, last))
    for i in range(right.shape[1]):
        for j in range(right.shape[2]):
            result[:, i : i + left.shape[1], j : j + left.shape[2]] += first * second[:, i, j][:, None, None]
    return result / (_binomials(sum(degrees[0]))[:, None] * _binomials(sum(degrees[1]))[None, :])[..., None]


def _binomials(degree: int) -> Floats:
    return np.array([comb(degree, i) for i in range(degree + 1)], dtype=float)


def _accumulated(values: list[fmpq]) -> list[fmpq]:
    """b_i = sum_p C(i, p) a_p by repeated sums."""
    result, row = [], list(values)
    while row:
        result.append(row[0])
        row = [a + b for a, b in pairwise(row)]
    return result
