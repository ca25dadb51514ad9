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
from pas.kernels.library import compiled
from pas.limits import checkpoint
from pas.mesh.field import Integers

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
    (count, size), vertices = forms.shape, corners.shape[1]
    up, (pairs, halves, taken) = _raised(degree, vertices), _cuts(degree, vertices)
    most, sizes = 2 * count if cut else count, np.empty(2, dtype=np.intp)
    left, sure = ((np.empty((most, size)), np.empty((most, vertices, 3))) for _ in range(2))
    tables = (len(up), up, bound, ROUNDINGS * UNIT_ROUNDOFF, cut, len(pairs), pairs, halves.shape[1], halves, taken)
    compiled().call("pas_parted", count, size, vertices - 1, *tables, forms, corners, *left, *sure, sizes)
    first, second = sizes.tolist()
    return (left[0][:first], left[1][:first]), (sure[0][:second], sure[1][:second])


@cache
def _raised(degree: int, vertices: int) -> Integers:
    return raised(degree, vertices) if vertices > 1 else np.zeros((1, 1), dtype=np.intp)


@cache
def _cuts(degree: int, vertices: int) -> tuple[Integers, Integers, Integers]:
    """The edges (E, 2), and for each the means (E, M, 2) of which its halves' coefficients (E, 2, m) are some."""
    cuts = bisection(degree, vertices)
    if not cuts:
        return np.empty((0, 2), dtype=np.intp), np.empty((0, 0, 2), dtype=np.intp), np.empty((0, 2, 0), dtype=np.intp)
    return np.array(edges(vertices)), np.array([c.halves for c in cuts]), np.array([c.taken for c in cuts])
