"""Rigorous sign proofs by Bernstein branch and bound.

The claim: on some simplices, `value > 0` wherever `zero = 0` (or everywhere, without `zero`; or
where several polynomials vanish at once).  A polynomial lies between its smallest and largest
B-coefficient, and equals them at the vertices.  So a simplex is settled when all coefficients of
one `zero` have one sign or those of `value` are positive, or those of `value + t zero` for some
number t, if both are written as of one degree: they are where `zero` vanishes only, and there both are
the same.  The claim is refuted when those of `value`, or of such a sum, are negative and `zero` changes
sign between two vertices (then it vanishes in between); any other simplex is halved at its longest edge.
Several polynomials may change their signs without a common zero: with them a claim is proved or left
undecided.  Of where other polynomials are not positive, a simplex is settled when all coefficients of one of
them or of `value` are positive, or of `value` and t >= 0 times one, and the claim is refuted where all
are negative at a vertex.

Rounding: coefficients come scaled to at most 1 in absolute value, rounded to nearest (error
2^-53), or with another error that is known.  One halving is a product with rows of at most n+1
nonzero nonnegative weights of sum 1, whose computed value errs by at most (n+2) 2^-53 (Higham 2002,
section 3.1), and does not enlarge the errors before it.  After m halvings every coefficient is
within `(1 + m (n+2)) 2^-53` of the true one, with the other error in place of the 1, here
doubled; comparisons are made against that bound.  The computed coefficients of `value + t zero` are
within 1 + 2 |t| roundings of what they are by the computed ones of both, so these are compared with
2 (1 + |t|) times the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats, homogeneous_exponents
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.subdivision import edges, halving
from pas.limits import checkpoint
from pas.verdicts import Status

BISECTIONS = 53
"""Of an edge on which a witness is sought: as many as a double has binary digits."""


@dataclass(frozen=True)
class SignResult:
    """The outcome: `counterexamples` (m, 3), each in or at a corner of a simplex that violates the claim.

    `undecided` (m, 3) are the centres of simplices left open, `sources` the numbers of the given
    simplices that the counterexamples, then the undecided ones, lie in; `simplices` counts all
    that were examined.  Where REFUTED, `witness` (3,) is a point at which the claim fails: to
    rounding, `zero` vanishes there, and `value` is negative.
    """

    status: Status
    counterexamples: Floats
    undecided: Floats
    sources: NDArray[np.intp]
    simplices: int
    witness: Floats | None = None


@dataclass
class _Simplices:
    """A batch: B-coefficients (N, m), corner points (N, d+1, 3), numbers of origin (N,).

    The claim is about where all `zeros` vanish, or with `below` where none of them is positive.
    """

    zeros: tuple[Floats, ...]
    value: Floats
    corners: Floats
    source: NDArray[np.intp]
    below: bool = False

    def select(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> _Simplices:
        zeros = tuple(zero[chosen] for zero in self.zeros)
        return _Simplices(zeros, self.value[chosen], self.corners[chosen], self.source[chosen], self.below)

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
    value: Floats,
    corners: Floats,
    where_zero: Floats | Sequence[Floats] | None = None,
    limits: Limits | None = None,
    error: float = UNIT_ROUNDOFF,
) -> SignResult:
    """Prove that `value > 0` on simplices, or only where another polynomial (or several) vanish.

    `value` (N, m) and `where_zero` (N, m') are B-coefficients scaled to at most 1 (see
    `pas.bernstein.forms.rounded`), each off by at most `error`, `corners` (N, d+1, 3) the simplices.  Nothing is
    claimed of no simplices, which is proved.  UNDECIDED where the limits are reached first.
    """
    zeros = (where_zero,) if isinstance(where_zero, np.ndarray) else tuple(where_zero or ())
    return _searched(_Simplices(zeros, value, corners, np.arange(len(value))), limits, error)


def _searched(batch: _Simplices, limits: Limits | None, error: float) -> SignResult:
    """Branch and bound over a batch."""
    limits = limits or Limits()
    if not len(batch):
        return SignResult(Status.PROVED, np.empty((0, 3)), np.empty((0, 3)), np.empty(0, dtype=np.intp), 0)
    degrees = [_degree(c.shape[1], batch.corners.shape[1]) for c in (batch.value, *batch.zeros)]
    found, examined, halved, witness = _Findings(), 0, 0, None
    while len(batch):
        checkpoint(f"proving signs ({examined} simplices examined)")
        examined += len(batch)
        bound = rounding_bound(max(degrees), halved, error)
        batch = batch.select(~_settled(batch, bound))
        batch = batch.select(~_by_multiple(batch, bound))
        witnesses = _violations(batch, bound)
        if witnesses.any():
            if witness is None:
                witness = _witness(batch, int(witnesses.argmax()))
            found.add(_near_witnesses(batch.select(witnesses)), batch.source[witnesses])
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
    return SignResult(status, points, centres, np.concatenate([sources, batch.source]), examined, witness)


def prove_positive_inside(
    value: Floats,
    inside: Floats | Sequence[Floats],
    corners: Floats,
    limits: Limits | None = None,
    error: float = UNIT_ROUNDOFF,
) -> SignResult:
    """Prove that `value > 0` wherever another polynomial, `inside`, is not positive, or none of several: arguments as
    `prove_positive` has.

    A simplex is settled when all coefficients of `value` or all of one that is `inside` are positive.
    """
    walls = (inside,) if isinstance(inside, np.ndarray) else tuple(inside)
    return _searched(_Simplices(walls, value, corners, np.arange(len(value)), below=True), limits, error)


def prove_apart(zeros: Sequence[Floats], corners: Floats, limits: Limits | None = None) -> SignResult:
    """Prove that some polynomials have no common zero on simplices; `zeros` are their B-coefficients (N, m)."""
    nowhere = np.full((len(corners), 1), -1.0)
    return prove_positive(nowhere, corners, zeros, limits)


def rounding_bound(degree: int, halvings: int, error: float = UNIT_ROUNDOFF) -> float:
    """Twice the most by which a coefficient can be off after some halvings (see above), of so much before them."""
    return 2 * (error + halvings * (degree + 2) * UNIT_ROUNDOFF)


def _degree(size: int, vertices: int) -> int:
    return next(n for n in range(size) if len(homogeneous_exponents(n, vertices)) == size)


def _settled(batch: _Simplices, bound: float) -> NDArray[np.bool_]:
    settled = batch.value.min(axis=1) > bound
    for zero in batch.zeros:
        settled |= zero.min(axis=1) > bound
        if not batch.below:
            settled |= zero.max(axis=1) < -bound
    return settled


def _by_multiple(batch: _Simplices, bound: float) -> NDArray[np.bool_]:
    """Where a multiple of a polynomial that vanishes makes up for what is negative."""
    settled = np.zeros(len(batch), dtype=bool)
    for zero in batch.zeros if len(batch.zeros) == 1 or batch.below else ():
        if zero.shape == batch.value.shape:
            settled |= _by_multiple_of(zero, batch, bound)
    return settled


def _by_multiple_of(zero: Floats, batch: _Simplices, bound: float) -> NDArray[np.bool_]:
    value = batch.value
    with np.errstate(all="ignore"):
        ratios = -value / zero
        least = np.where(zero > 0, ratios, -np.inf).max(axis=1)
        if batch.below:
            least = np.maximum(least, 0.0)
        times = (least + np.where(zero < 0, ratios, np.inf).min(axis=1)) / 2
        sums = (value + times[:, None] * zero).min(axis=1)
        return np.asarray(sums > 2 * bound * (1 + np.abs(times)))  # false where it is nan


def _violations(batch: _Simplices, bound: float) -> NDArray[np.bool_]:
    if not batch.zeros:
        return _at_vertices(batch.value, batch.corners.shape[1]).min(axis=1) < -bound
    if batch.below:
        return np.asarray(_highest(batch).min(axis=1) < -bound)
    if len(batch.zeros) > 1:
        return np.zeros(len(batch), dtype=bool)
    at_vertices = _at_vertices(batch.zeros[0], batch.corners.shape[1])
    changing = np.flatnonzero((at_vertices.min(axis=1) < -bound) & (at_vertices.max(axis=1) > bound))
    opposite, result = replace(batch.select(changing), value=-batch.value[changing]), np.zeros(len(batch), dtype=bool)
    result[changing] = (opposite.value.min(axis=1) > bound) | _by_multiple(opposite, bound)
    return result


def _near_witnesses(batch: _Simplices) -> Floats:
    """A point of each violating simplex: its worst vertex, or one near the zero set."""
    vertices = batch.corners.shape[1]
    rows = np.arange(len(batch))
    if batch.below:
        return batch.corners[rows, _highest(batch).argmin(axis=1)]
    if not batch.zeros:
        return batch.corners[rows, _at_vertices(batch.value, vertices).argmin(axis=1)]
    values = _at_vertices(batch.zeros[0], vertices)
    low, high = values.argmin(axis=1), values.argmax(axis=1)
    below, above = values[rows, low][:, None], values[rows, high][:, None]
    share = below / np.where(below == above, 1.0, below - above)
    return batch.corners[rows, low] * (1 - share) + batch.corners[rows, high] * share


def _witness(batch: _Simplices, row: int) -> Floats:
    """Where one simplex violates the claim: its worst vertex, or the zero between two vertices."""
    vertices, corners = batch.corners.shape[1], batch.corners[row]
    if batch.below:
        return corners[_highest(batch)[row].argmin()]
    if not batch.zeros:
        return corners[_at_vertices(batch.value[[row]], vertices)[0].argmin()]
    values = _at_vertices(batch.zeros[0][[row]], vertices)[0]
    low, high = int(values.argmin()), int(values.argmax())
    degree = _degree(batch.zeros[0].shape[1], vertices)
    # the B-form on the edge from low to high: of all other vertices the index is 0
    pairs = zip(homogeneous_exponents(degree, vertices), batch.zeros[0][row], strict=True)
    edge = np.array([c for _, c in sorted((a[high], c) for a, c in pairs if a[low] + a[high] == degree)])
    near, far = halving(degree, 2, 0)
    share = 0.0
    for step in range(1, BISECTIONS + 1):
        first = near @ edge
        if first[-1] < 0:
            edge, share = far @ edge, share + 2.0**-step
        else:
            edge = first
    return corners[low] * (1 - share) + corners[high] * share


def _highest(batch: _Simplices) -> Floats:
    """The largest of all polynomials at each vertex (N, d+1)."""
    return np.maximum.reduce([_at_vertices(c, batch.corners.shape[1]) for c in (batch.value, *batch.zeros)])


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
            zeros = tuple(
                zero @ halving(degree, vertices, int(edge))[side].T
                for zero, degree in zip(part.zeros, degrees[1:], strict=True)
            )
            halves.append(_Simplices(zeros, value, corners, part.source, batch.below))
    return _Simplices(
        tuple(map(np.concatenate, zip(*(h.zeros for h in halves), strict=True))),
        np.concatenate([h.value for h in halves]),
        np.concatenate([h.corners for h in halves]),
        np.concatenate([h.source for h in halves]),
        batch.below,
    )
