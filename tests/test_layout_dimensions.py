"""Dimensions of surfaces on layouts: published formulas, and ranks in floating point by another construction."""

from __future__ import annotations

from itertools import product
from math import comb

import numpy as np
import pytest

import pas
from pas.partition.layout import Layout

POLE, BACK = (1, 2, 5), (-1, -2, -5)
AROUND = [(7, -1, 1), (3, 8, -2), (-4, 6, 1), (-9, 1, 2), (-3, -7, 3), (2, -9, 1), (6, -6, 1)]
"""Rays around the pole, in no two of which half-planes are opposite."""

FORMULAS = [(1, 4, 13, 10, 16), (2, 5, 28, 10, 27), (2, 6, 34, 20, 33)]
"""Order, degree, and the dimension without pieces, more for each half-plane and less for each pipe."""


def fan(number):
    rays = AROUND[:number]
    return Layout([POLE, BACK, *rays], [(0, 2 + i, 1, 2 + (i + 1) % number) for i in range(number)], name="lunes")


def pipes(layout, number):
    """So many pipes in every second piece, in no special directions."""
    found = []
    for piece in layout.pieces[: 2 * number : 2]:
        a, b = (np.array(layout.rays[i], float) for i in (piece[1], piece[3]))
        axis = a / np.linalg.norm(a) + b / np.linalg.norm(b)
        axis += 0.11 * (1 + len(found)) * np.array(POLE) / np.linalg.norm(POLE)
        x, y, z = (int(c) for c in np.round(9 * axis / np.linalg.norm(axis)))
        found.append(pas.Pipe((x, y, z), "1/5", f"{10 + len(found)}/90"))
    return found


TABLE = [
    pytest.param(number, *formula, marks=[pytest.mark.slow] * (number > 5 and formula[1] == 6))
    for number in (5, 6, 7)
    for formula in FORMULAS
]


@pytest.mark.sampled(6)
@pytest.mark.parametrize(("number", "order", "degree", "constant", "each", "less"), TABLE)
def test_pipes_on_fans_have_the_dimensions_of_the_formula(number, order, degree, constant, each, less):
    layout = fan(number)
    for count in (0, 2, 3)[: 2 + (number > 5)]:
        found = layout.dimensions(pipes(layout, count), order, [degree])
        assert found == {degree: constant + each * number - less * count}


def test_tables_have_a_row_for_each_degree():
    layout = fan(6)
    items = pipes(layout, 3)
    found = layout.dimensions(items, 1, range(1, 5))
    assert list(found) == [1, 2, 3, 4]
    assert found == {n: pas.solutions(items, 1, n, layout).dimension for n in found}
    assert layout.dimensions([], 1, 3) == {3: by_rank(layout, [], 1, 3)}
    opened = [pas.Pipe(item.axis, item.radius, "auto") for item in items]
    assert layout.dimensions(opened, 1, [4]) == {4: found[4]}


CASES = [(5, 2, 1, 4), (6, 3, 1, 4), (6, 2, 2, 5)]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("number", "count", "order", "degree"), CASES)
def test_the_rank_in_floating_point_says_the_same(number, count, order, degree):
    layout = fan(number)
    items = pipes(layout, count)
    assert layout.dimensions(items, order, [degree])[degree] == by_rank(layout, items, order, degree)


def by_rank(layout, items, order, degree):
    """Unknown are the coefficients of each piece, and alpha and beta of each `piece = alpha f + beta h^(k+1)`."""
    random = np.random.default_rng(1)
    exponents, cofactors = monomials(degree), [monomials(degree - 2), monomials(degree - order - 1)]
    own, extra = len(exponents), sum(map(len, cofactors))
    pieces = len(layout.pieces)
    width = own * pieces + extra * len(items)
    rows = []
    for arc in layout.arcs:
        a, b = (np.array(layout.rays[i], float) for i in (arc.start, arc.end))
        frame = np.linalg.qr(np.stack([a, b, np.cross(a, b)], axis=1))[0].T
        points = random.uniform(-1, 1, (2 * comb(degree + 2, 2), 2)) @ frame[:2]
        for times in range(order + 1):
            row = np.zeros((len(points), width))
            values = normal_derivative(points, frame[2], exponents, times)
            row[:, arc.first * own : (arc.first + 1) * own] = values
            row[:, arc.second * own : (arc.second + 1) * own] = -values
            rows.append(row)
    for i, item in enumerate(items):
        contact, start = item.contact, own * pieces + extra * i
        points = random.uniform(-1, 1, (2 * own, 3))
        row = np.zeros((len(points), width))
        row[:, 2 * i * own : (2 * i + 1) * own] = powers(points, exponents)  # the pipe is in every second piece
        alpha = powers(points, cofactors[0]) * contact.surface(points)[:, None]
        beta = powers(points, cofactors[1]) * contact.clip(points)[:, None] ** (order + 1)
        row[:, start : start + extra] = -np.concatenate([alpha, beta], axis=1)
        rows.append(row)
    matrix = np.concatenate(rows)
    matrix /= np.linalg.norm(matrix, axis=0).clip(1e-12)
    values = np.linalg.svd(matrix, compute_uv=False)
    rank = int((values > 1e-10 * values[0]).sum())
    gap = values[rank - 1] / max(values[rank] if rank < len(values) else 0, 1e-300)
    assert gap > 1e3, "the rank is not clear"
    # alpha = c h^(k+1), beta = -c f is 0 for every c
    return width - rank - len(items) * len(monomials(degree - 3 - order))


def monomials(degree):
    return [(i, j, k) for i, j, k in product(range(max(degree + 1, 0)), repeat=3) if i + j + k <= degree]


def powers(points, exponents):
    return np.stack([np.prod(points ** np.array(e), axis=1) for e in exponents], axis=1)


def normal_derivative(points, normal, exponents, times):
    """The coefficient of t^times of each monomial along point + t normal: (N, monomials)."""
    highest = sum(exponents[-1])
    steps = np.cos(np.pi * (np.arange(highest + 1) + 0.5) / (highest + 1))
    values = np.stack([powers(points + t * normal, exponents) for t in steps])
    inverse = np.linalg.inv(np.vander(steps, increasing=True))
    return np.einsum("s,snm->nm", inverse[times], values)


@pytest.mark.parametrize(
    ("degrees", "order", "error", "words"),
    [
        ([0], 1, ValueError, r"degrees\[0\]"),
        ("45", 1, TypeError, "degrees must be whole numbers"),
        (None, 1, TypeError, "degrees must be whole numbers"),
        ([4], -1, ValueError, "order"),
    ],
)
def test_tables_that_cannot_be(degrees, order, error, words):
    with pytest.raises(error, match=words):
        fan(5).dimensions([], order, degrees)


def test_contacts_must_fit_the_layout():
    with pytest.raises(pas.GeometryError, match="fits in no piece of the layout"):
        fan(5).dimensions([pas.Pipe(POLE, 1, 1)], 1, [4])
