"""Rigorous sign proofs by Bernstein branch and bound.

The claim: on some simplices, `value > 0` wherever `zero = 0` (or everywhere, without `zero`).
A polynomial lies between its smallest and largest B-coefficient, and equals them at the
vertices.  So a simplex is settled when all coefficients of `zero` have one sign or those of
`value` are positive; the claim is refuted when those of `value` are negative and `zero` changes
sign between two vertices (then it vanishes in between); any other simplex is halved at its
longest edge.

Rounding: coefficients come scaled to at most 1 in absolute value, rounded to nearest (error
2^-53).  One halving is a product with rows of at most n+1 nonzero nonnegative weights of sum 1,
whose computed value errs by at most (n+2) 2^-53 (Higham 2002, section 3.1), and does not
enlarge the errors before it.  After m halvings every coefficient is within
`(1 + m (n+2)) 2^-53` of the true one, here doubled; comparisons are made against that bound.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.bernstein.subdivision import edges, halving

UNIT_ROUNDOFF = 2.0**-53


class Status(Enum):
    """What a proof came to; where there is none but samples were taken, whether they agree with the claim."""

    PROVED = "proved"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    HOLDS_MEASURED = "holds, measured"
    FAILS_MEASURED = "fails, measured"


@dataclass(frozen=True)
class SignResult:
    """The outcome: `counterexamples` (m, 3) violate the claim (beyond doubt where REFUTED).

    `undecided` (m, 3) are the centres of simplices left open, `sources` the numbers of the given
    simplices that the counterexamples, then the undecided ones, lie in; `simplices` counts all
    that were examined.
    """

    status: Status
    counterexamples: Floats
    undecided: Floats
    sources: NDArray[np.intp]
    simplices: int


@dataclass
class _Simplices:
    """A batch: B-coefficients (N, m), corner points (N, d+1, 3), numbers of origin (N,)."""

    zero: Floats | None
    value: Floats
    corners: Floats
    source: NDArray[np.intp]

    def select(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> _Simplices:
        zero = None if self.zero is None else self.zero[chosen]
        return _Simplices(zero, self.value[chosen], self.corners[chosen], self.source[chosen])

    def __len__(self) -> int:
        return len(self.value)


@dataclass
class _Findings:
    points: list[Floats] = field(default_factory=list)
    sources: list[NDArray[np.intp]] = field(default_factory=list)

    def add(self, points: Floats, sources: NDArray[np.intp]) -> None:
        self.points.append(points.reshape(-1, 3))
        self.sources.append(sources)

    def all(self) -> tuple[Floats, NDArray[np.intp]]:
        if not self.points:
            return np.empty((0, 3)), np.empty(0, dtype=np.intp)
        return np.concatenate(self.points), np.concatenate(self.sources)


@dataclass(frozen=True)
class Limits:
    """When to give up: after `halvings` rounds, or with more than `largest_batch` simplices open.

    A proof ends at its first counterexamples, or goes on to find others with `exhaustive`.
    """

    halvings: int = 48
    largest_batch: int = 20_000
    exhaustive: bool = False


def prove_positive(
    value: Floats, corners: Floats, where_zero: Floats | None = None, limits: Limits | None = None
) -> SignResult:
    """Prove that `value > 0` on simplices, or only where another polynomial vanishes.

    `value` (N, m) and `where_zero` (N, m') are B-coefficients scaled to at most 1 (see
    `pas.bernstein.forms.rounded`), `corners` (N, d+1, 3) the simplices.  UNDECIDED where
    the limits are reached first.
    """
    limits = limits or Limits()
    batch = _Simplices(where_zero, value, corners, np.arange(len(value)))
    vertices = corners.shape[1]
    degrees = [_degree(c.shape[1], vertices) for c in (value, where_zero) if c is not None]
    found, examined, halved = _Findings(), 0, 0
    while len(batch):
        examined += len(batch)
        bound = 2 * (1 + halved * (max(degrees) + 2)) * UNIT_ROUNDOFF
        batch = batch.select(~_settled(batch, bound))
        witnesses = _violations(batch, bound)
        if witnesses.any():
            found.add(_witness_points(batch.select(witnesses)), batch.source[witnesses])
        batch = batch.select(~witnesses)
        if not len(batch) or halved == limits.halvings or len(batch) > limits.largest_batch:
            break
        if found.points and not limits.exhaustive:
            break
        batch = _halve(batch, degrees)
        halved += 1
    points, sources = found.all()
    status = Status.REFUTED if len(points) else Status.UNDECIDED if len(batch) else Status.PROVED
    centres = batch.corners.mean(axis=1)
    return SignResult(status, points, centres, np.concatenate([sources, batch.source]), examined)


def _degree(size: int, vertices: int) -> int:
    return next(n for n in range(size) if len(homogeneous_exponents(n, vertices)) == size)


def _settled(batch: _Simplices, bound: float) -> NDArray[np.bool_]:
    settled = batch.value.min(axis=1) > bound
    if batch.zero is not None:
        settled |= (batch.zero.min(axis=1) > bound) | (batch.zero.max(axis=1) < -bound)
    return settled


def _violations(batch: _Simplices, bound: float) -> NDArray[np.bool_]:
    if batch.zero is None:
        return _at_vertices(batch.value, batch.corners.shape[1]).min(axis=1) < -bound
    at_vertices = _at_vertices(batch.zero, batch.corners.shape[1])
    changes = (at_vertices.min(axis=1) < -bound) & (at_vertices.max(axis=1) > bound)
    return changes & (batch.value.max(axis=1) < -bound)


def _witness_points(batch: _Simplices) -> Floats:
    """A point of each violating simplex: its worst vertex, or one near the zero set."""
    vertices = batch.corners.shape[1]
    rows = np.arange(len(batch))
    if batch.zero is None:
        return batch.corners[rows, _at_vertices(batch.value, vertices).argmin(axis=1)]
    values = _at_vertices(batch.zero, vertices)
    low, high = values.argmin(axis=1), values.argmax(axis=1)
    below, above = values[rows, low][:, None], values[rows, high][:, None]
    share = below / np.where(below == above, 1.0, below - above)
    return batch.corners[rows, low] * (1 - share) + batch.corners[rows, high] * share


def _at_vertices(coefficients: Floats, vertices: int) -> Floats:
    degree = _degree(coefficients.shape[1], vertices)
    indices = homogeneous_exponents(degree, vertices)
    return coefficients[:, [i for i, a in enumerate(indices) if max(a) == degree][:vertices]]


def _halve(batch: _Simplices, degrees: list[int]) -> _Simplices:
    vertices = batch.corners.shape[1]
    pairs = np.array(edges(vertices))
    spans = batch.corners[:, pairs[:, 0]] - batch.corners[:, pairs[:, 1]]
    longest = np.einsum("nij,nij->ni", spans, spans).argmax(axis=1)
    halves: list[_Simplices] = []
    for edge in np.unique(longest):
        part = batch.select(longest == edge)
        first, second = pairs[edge]
        middle = part.corners[:, [first, second]].mean(axis=1)
        for side, moved in enumerate((second, first)):
            corners = part.corners.copy()
            corners[:, moved] = middle
            value = part.value @ halving(degrees[0], vertices, int(edge))[side].T
            zero = part.zero
            if zero is not None:
                zero = zero @ halving(degrees[1], vertices, int(edge))[side].T
            halves.append(_Simplices(zero, value, corners, part.source))
    return _Simplices(
        None if batch.zero is None else np.concatenate([h.zero for h in halves if h.zero is not None]),
        np.concatenate([h.value for h in halves]),
        np.concatenate([h.corners for h in halves]),
        np.concatenate([h.source for h in halves]),
    )
