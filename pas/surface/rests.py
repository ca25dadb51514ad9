"""Where a polynomial may rest on simplices: parts that hold all its critical points, on each of which it has a sign.

A simplex is dropped when the derivative along some direction in it has B-coefficients of one sign, and kept as a place
of rest when the polynomial itself has and the simplex is free of what must not be in it; any other is halved.
Directions are given by numbers u_1 .. u_d, as `sum u_i (d_i - d_0)` of the barycentric coordinates, so they need not be
known exactly.  Rounding is counted as in `pas.bernstein.signs`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.signs import rounding_bound
from pas.bernstein.subdivision import edges, halving, raised
from pas.limits import checkpoint

HALVINGS, MOST = 150, 6000
"""Halvings of a simplex, and simplices still open, at which the search ends."""


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
    kept, places, examined = [forms[:0]], [corners[:0]], 0
    for halved in range(HALVINGS + 1):
        checkpoint(f"looking for critical points ({examined} simplices examined)")
        examined += len(forms)
        bound = rounding_bound(degree, halved, error)
        still = ~_rises(forms, corners, degree, bound)
        forms, corners = forms[still], corners[still]
        sure = _least(forms, bound) > 0
        kept.append(forms[sure])
        places.append(corners[sure])
        forms, corners = forms[~sure], corners[~sure]
        if not len(forms) or len(forms) > most or halved == HALVINGS or corners.shape[1] == 1:
            break
        forms, corners = halves(forms, corners, degree)
    return Leaves(np.concatenate(kept), np.concatenate(places), corners, halved, error, examined)


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
        forms, corners = halves(forms, corners, degree)
        halved, examined = halved + 1, examined + len(forms)
        still = ~_rises(forms, corners, degree, rounding_bound(degree, halved, found.error))
        forms, corners = forms[still], corners[still]
    left = np.concatenate([found.open.mean(axis=1), corners.mean(axis=1)])
    return Rests(np.concatenate(kept), np.concatenate(signs), left, examined)


def _least(forms: Floats, bound: float) -> Floats:
    return np.asarray(np.maximum(forms.min(axis=1), -forms.max(axis=1)) - bound)


def _rises(forms: Floats, corners: Floats, degree: int, bound: float) -> np.ndarray:
    """On which simplices the derivative along one direction, about that of the mean gradient, is positive."""
    if corners.shape[1] == 1 or not len(forms):
        return np.zeros(len(forms), dtype=bool)
    up = raised(degree, corners.shape[1])
    steps = forms[:, up[:, 1:]] - forms[:, up[:, :1]]
    way = corners[:, 1:] - corners[:, :1]
    gram = way @ way.transpose(0, 2, 1)
    gram /= np.einsum("nii->n", gram)[:, None, None]
    mean = steps.mean(axis=1)
    with np.errstate(all="ignore"):
        u = np.linalg.solve(gram, mean[..., None])[..., 0]
        u /= np.abs(u).sum(axis=1, keepdims=True)
    along = np.einsum("nmi,ni->nm", steps, u)
    largest = np.abs(forms).max(axis=1)
    return np.asarray(along.min(axis=1) > 2 * bound + 16 * UNIT_ROUNDOFF * largest)


def halves(forms: Floats, corners: Floats, degree: int) -> tuple[Floats, Floats]:
    """Both halves of each simplex at the middle of its longest edge."""
    vertices = corners.shape[1]
    pairs = np.array(edges(vertices))
    spans = corners[:, pairs[:, 0]] - corners[:, pairs[:, 1]]
    longest = np.einsum("nij,nij->ni", spans, spans).argmax(axis=1)
    found, places = [], []
    for edge in np.unique(longest).tolist():
        here = longest == edge
        first, second = pairs[edge]
        middle = corners[here][:, [first, second]].mean(axis=1)
        for side, moved in enumerate((second, first)):
            place = corners[here].copy()
            place[:, moved] = middle
            places.append(place)
            found.append(forms[here] @ halving(degree, vertices, edge)[side].T)
    return np.concatenate(found), np.concatenate(places)
