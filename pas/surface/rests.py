"""Where a polynomial may rest on simplices: parts that hold all its critical points, on each of which it has a sign.

A simplex is dropped when the derivative along some direction in it has B-coefficients of one sign, and kept as a place
of rest when the polynomial itself has and the simplex is free of what must not be in it; any other is halved.
Directions are given by numbers u_1 .. u_d, as `sum u_i (d_i - d_0)` of the barycentric coordinates, so they need not be
known exactly.  Rounding is counted as in `pas.bernstein.signs`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from pas.algebra.monomials import Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.polar import bisection
from pas.bernstein.signs import rounding_bound
from pas.bernstein.subdivision import edges, raised
from pas.limits import checkpoint
from pas.mesh.field import Integers
from pas.mesh.rows import dots
from pas.surface.kernels import compiled

HALVINGS, MOST = 150, 6000
"""Halvings of a simplex, and simplices still open, at which the search ends."""

LOOKS = 4
"""Halvings between looks for simplices on which the polynomial is nothing but rounding, which stay open."""

ROUNDINGS = 16
"""Of derivatives, over the largest coefficient, beyond what halvings make of it."""


@dataclass(frozen=True)
class Leaves:
    """Simplices (L, d + 1, 3) with B-coefficients (L, m) of one sign; the corners (U, d + 1, 3) of those left open.

    Coefficients are off by what `halved` halvings make of `error`; `examined` counts all simplices.
    """

    forms: Floats
    corners: Floats
    open: Floats
    halved: int
    error: float
    examined: int


@dataclass(frozen=True)
class Rests:
    """Simplices (R, d + 1, 3) with the sign (R,) of the polynomial on each; the middles (U, 3) of those left open."""

    simplices: Floats
    signs: Floats
    open: Floats
    examined: int


Free = Callable[[Floats, Floats], np.ndarray]
"""Says which simplices (N, d + 1, 3), on which the polynomial's size is at least (N,), are free of what must not be
in them."""


def leaves(forms: Floats, corners: Floats, degree: int, error: float = UNIT_ROUNDOFF, most: int = MOST) -> Leaves:
    """Places of rest on simplices (N, d + 1, 3) of B-coefficients (N, m), at most 1 in size, each off by `error`."""
    kept, places, hopeless, examined = [], [], [], 0
    for halved in range(HALVINGS + 1):
        checkpoint(f"looking for critical points ({examined} simplices examined)")
        bound = rounding_bound(degree, halved, error)
        examined += len(forms) * (2 if halved else 1)
        (forms, corners), sure = _parted(forms, corners, degree, bound, cut=halved > 0)
        kept.append(sure[0])
        places.append(sure[1])
        if len(forms) and halved % LOOKS == 0:  # where all coefficients are rounding, those of parts are no more
            lost = np.abs(forms).max(axis=1) <= bound
            hopeless.append(corners[lost])
            forms, corners = forms[~lost], corners[~lost]
        if not len(forms) or len(forms) > most or corners.shape[1] == 1:
            break
    left = np.concatenate([*hopeless, corners])
    return Leaves(np.concatenate(kept), np.concatenate(places), left, halved, error, examined)


def rests(found: Leaves, degree: int, free: Free, most: int = MOST) -> Rests:
    """The places of rest that are free: leaves, or parts of these where they are not."""
    forms, corners, halved, examined = found.forms, found.corners, found.halved, found.examined
    kept, signs = [], []
    while True:
        bound = rounding_bound(degree, halved, found.error)
        sure = np.asarray(free(_least(forms, bound), corners))
        kept.append(corners[sure])
        signs.append(np.sign(forms[sure, 0]))
        forms, corners = forms[~sure], corners[~sure]
        if not len(forms) or len(forms) > most or halved >= HALVINGS or corners.shape[1] == 1:
            break
        checkpoint(f"looking for critical points ({examined} simplices examined)")
        halved, examined = halved + 1, examined + 2 * len(forms)
        parts = _parted(forms, corners, degree, rounding_bound(degree, halved, found.error), cut=True)
        forms, corners = (np.concatenate(both) for both in zip(*parts, strict=True))
    return Rests(np.concatenate(kept), np.concatenate(signs), corners.mean(axis=1), examined)


def _least(forms: Floats, bound: float) -> Floats:
    return np.asarray(np.maximum(forms.min(axis=1), -forms.max(axis=1)) - bound)


def _parted(
    forms: Floats, corners: Floats, degree: int, bound: float, *, cut: bool
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Of simplices, or of their halves if they are `cut`, those that are left open, and those of one sign.

    Those along one direction in which the derivative is positive are dropped.
    """
    up = _raised(degree, corners.shape[1])
    kernel = compiled()
    if kernel is not None:
        bounds = bound, ROUNDINGS * UNIT_ROUNDOFF
        return kernel.parted((forms, corners), up, bounds, cut, _cuts(degree, corners.shape[1]))
    if cut:
        forms, corners = _halved(forms, corners, degree)
    rises, sure = _rises(forms, corners, up, bound), _least(forms, bound) > 0
    left, sure = ~rises & ~sure, ~rises & sure
    return (forms[left], corners[left]), (forms[sure], corners[sure])


@cache
def _raised(degree: int, vertices: int) -> Integers:
    return raised(degree, vertices) if vertices > 1 else np.zeros((1, 1), dtype=np.intp)


def _rises(forms: Floats, corners: Floats, up: Integers, bound: float) -> np.ndarray:
    """On which simplices the derivative along one direction, about that of the mean gradient, is positive."""
    if corners.shape[1] == 1 or not len(forms):
        return np.zeros(len(forms), dtype=bool)
    number = corners.shape[1] - 1
    ways = [corners[:, i + 1] - corners[:, 0] for i in range(number)]
    gram = [[dots(a, b) for b in ways] for a in ways]
    steps = [[forms[:, row[i + 1]] - forms[:, row[0]] for row in up] for i in range(number)]
    mean = [sum(along[1:], start=0.0 + along[0]) / len(up) for along in steps]
    with np.errstate(all="ignore"):
        u = _direction(gram, mean)
        least = np.full(len(forms), np.inf)
        for some in zip(*steps, strict=True):
            least = np.minimum(least, sum((s * w for s, w in zip(some[1:], u[1:], strict=True)), start=some[0] * u[0]))
    largest = np.maximum(-forms.min(axis=1), forms.max(axis=1))
    return np.asarray(least > 2 * bound + ROUNDINGS * UNIT_ROUNDOFF * largest)


def _direction(gram: list[list[Floats]], mean: list[Floats]) -> list[Floats]:
    """The direction with given products with edges, by those (d, d) of edges with one another: by cofactors, its sizes
    summing to 1."""
    trace = sum((gram[i][i] for i in range(1, len(gram))), start=gram[0][0])
    g = [[entry / trace for entry in row] for row in gram]
    if len(g) == 1:
        found = [mean[0]]
    elif len(g) == 2:
        found = [g[1][1] * mean[0] - g[0][1] * mean[1], g[0][0] * mean[1] - g[0][1] * mean[0]]
    else:
        xx, xy = g[1][1] * g[2][2] - g[1][2] * g[1][2], g[0][2] * g[1][2] - g[0][1] * g[2][2]
        xz, yy = g[0][1] * g[1][2] - g[0][2] * g[1][1], g[0][0] * g[2][2] - g[0][2] * g[0][2]
        yz, zz = g[0][1] * g[0][2] - g[0][0] * g[1][2], g[0][0] * g[1][1] - g[0][1] * g[0][1]
        x, y, z = mean
        found = [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
    size = sum((np.abs(c) for c in found[1:]), start=np.abs(found[0]))
    return [c / size for c in found]


def _halved(forms: Floats, corners: Floats, degree: int) -> tuple[Floats, Floats]:
    """Both halves of each simplex, one behind the other, cut at the middle of its longest edge."""
    vertices = corners.shape[1]
    pairs = _cuts(degree, vertices)[0]
    spans = [corners[:, a] - corners[:, b] for a, b in pairs.tolist()]
    longest = np.argmax([dots(span, span) for span in spans], axis=0)
    found, places = np.empty((2 * len(forms), forms.shape[1])), np.repeat(corners, 2, axis=0)
    for edge, cut in enumerate(bisection(degree, vertices)):
        here = np.flatnonzero(longest == edge)
        first, second = pairs[edge]
        middle = (corners[here, first] + corners[here, second]) / 2
        for side, (moved, part) in enumerate(zip((second, first), cut(forms[here]), strict=True)):
            found[2 * here + side] = part
            places[2 * here + side, moved] = middle
    return found, places


@cache
def _cuts(degree: int, vertices: int) -> tuple[Integers, Integers, Integers]:
    """The edges (E, 2), and for each the means (E, M, 2) of which its halves' coefficients (E, 2, m) are some."""
    cuts = bisection(degree, vertices)
    if not cuts:
        return np.empty((0, 2), dtype=np.intp), np.empty((0, 0, 2), dtype=np.intp), np.empty((0, 2, 0), dtype=np.intp)
    return np.array(edges(vertices)), np.array([c.halves for c in cuts]), np.array([c.taken for c in cuts])
