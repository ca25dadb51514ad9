"""Rigorous sign proofs by Bernstein branch and bound.

The claim: on some simplices, `value > 0` wherever `zero = 0` (or everywhere, without `zero`; or where several
polynomials vanish at once).  A polynomial lies between its smallest and largest B-coefficient, and equals them at the
vertices.  So a simplex is settled when all coefficients of one `zero` have one sign or those of `value` are positive,
or those of `value + t zero` for some number t, if both are written as of one degree: they are where `zero` vanishes
only, and there both are the same.  The claim is refuted when those of `value`, or of such a sum, are negative and
`zero` changes sign between two vertices (then it vanishes in between); any other simplex is halved at its longest edge.
Several polynomials may change their signs without a common zero: with them a claim is proved or left undecided.  Of
where other polynomials are not positive, a simplex is settled when all coefficients of one of them or of `value` are
positive, or of `value` and t >= 0 times one, and the claim is refuted where all are negative at a vertex.

Rounding is counted as in `pas.bernstein.simplices`, and comparisons are made against the bound there.  The computed
coefficients of `value + t zero` are within 1 + 2 |t| roundings of what they are by the computed ones of both, so these
are compared with 2 (1 + |t|) times the bound.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from flint import fmpq_mpoly

from pas.algebra.evaluation import degree_of
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.polynomial import RING
from pas.algebra.rational import Vector
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF, corner_points, nearby_forms, rounded_form
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.bernstein.simplices import Simplices, at_vertices, halves
from pas.verdicts import Status


@dataclass(frozen=True)
class SignResult:
    """The outcome.  Where REFUTED, `witness` (3,) is a point at which the claim fails: to rounding, the polynomials of
    which it is about the zeros vanish there, and the value is negative.

    `undecided` (m, 3) are the centres of simplices left open, `sources` the numbers of the given simplices that those
    which violate the claim, then the undecided ones, lie in; `examined` counts all that were.
    """

    status: Status
    undecided: Floats
    sources: Integers
    examined: int
    witness: Floats | None = None


@dataclass(frozen=True)
class _Claim(Simplices):
    """Simplices on which the first polynomial is to be positive where all others vanish, or with `below` where none of
    them is positive."""

    below: bool = False

    @property
    def value(self) -> Floats:
        return self.forms[0]

    @property
    def zeros(self) -> list[Floats]:
        return self.forms[1:]

    @property
    def opposed(self) -> _Claim:
        return replace(self, table=np.concatenate([-self.value, *self.zeros], axis=1))


Anew: TypeAlias = Callable[[Floats, Integers], tuple[Floats, float]]
"""Works out the values (K, m), scaled to at most 1, on parts (K, d + 1, 3) of simplices of given numbers (K,), and by
how much each may be off."""

LOST = 2.0**16
"""Values are worked out anew where the largest coefficient is below so many times what rounding counts: a value of a
high degree is much smaller near the surface than elsewhere in its cell."""


def prove_positive(
    value: Floats,
    corners: Floats,
    where_zero: Floats | Sequence[Floats] | None = None,
    limits: Limits | None = None,
    error: float = UNIT_ROUNDOFF,
    anew: Anew | None = None,
    *,
    below: bool = False,
) -> SignResult:
    """Prove that `value > 0` on simplices, or only where another polynomial (or several) vanish, or with `below` where
    none of them is positive.

    `value` (N, m) and `where_zero` (N, m') are B-coefficients scaled to at most 1 (see
    `pas.bernstein.forms.rounded`), each off by at most `error`, `corners` (N, d+1, 3) the simplices.  Nothing is
    claimed of no simplices, which is proved.  UNDECIDED where the limits are reached first.  With `anew` values that
    became as small as what rounding counts are worked out again on the parts.
    """
    zeros = (where_zero,) if isinstance(where_zero, np.ndarray) else tuple(where_zero or ())
    if not len(corners):
        return SignResult(Status.PROVED, np.empty((0, 3)), np.empty(0, dtype=np.intp), 0)
    batch = replace(_Claim.of((value, *zeros), corners, error), below=below)

    def split(some: _Claim) -> _Claim:
        return (some if anew is None else _renewed(some, anew)).halved()

    found = search(batch, _judged, split, limits or Limits(), "proving signs")
    sources = np.concatenate([found.refuted.source, found.open.source])
    witness = _witness(found.refuted) if len(found.refuted) else None
    return SignResult(found.status, found.open.corners.mean(axis=1), sources, found.examined, witness)


Exact: TypeAlias = "tuple[Sequence[fmpq_mpoly], int]"
"""Polynomials, one on each of some simplices, and the degree as of which they are taken."""


def alike(polynomial: fmpq_mpoly, simplices: Sequence[object]) -> Exact:
    """One polynomial on all simplices, as of its own degree."""
    return [polynomial] * len(simplices), max(int(polynomial.total_degree()), 0)


def positive_on(
    simplices: Sequence[Sequence[Vector]],
    values: Exact,
    others: Sequence[Exact] = (),
    *,
    inside: bool = False,
    near: bool = False,
    limits: Limits | None = None,
) -> SignResult:
    """Prove that polynomials are positive on exact simplices, where all `others` vanish, or with `inside` where none of
    these is positive.

    B-coefficients are exact ones, rounded; or with `near` worked out in doubles, which is faster where they are many.
    """
    found = [_forms(raws, simplices, degree, near) for raws, degree in (values, *others)]
    (value, *rest), error = [form for form, _ in found], max(off for _, off in found)
    return prove_positive(value, corner_points(simplices), rest, limits, error, below=inside)


def apart_on(simplices: Sequence[Sequence[Vector]], polynomials: Sequence[fmpq_mpoly]) -> SignResult:
    """Prove that some polynomials have no common zero on exact simplices: there -1 would have to be positive."""
    return positive_on(simplices, alike(RING.constant(-1), simplices), [alike(p, simplices) for p in polynomials])


def _forms(
    raws: Sequence[fmpq_mpoly], simplices: Sequence[Sequence[Vector]], degree: int, near: bool
) -> tuple[Floats, float]:
    if near:
        return nearby_forms(raws, simplices, degree)
    forms = [rounded_form(raw, simplex, degree) for raw, simplex in zip(raws, simplices, strict=True)]
    return np.array(forms), UNIT_ROUNDOFF


def _renewed(batch: _Claim, anew: Anew) -> _Claim:
    """The batch with the values that halving left too small worked out anew; the error is the largest of all."""
    rows = np.flatnonzero(np.abs(batch.value).max(axis=1) < LOST * batch.bound)
    if not len(rows):
        return batch
    values, error = anew(batch.corners[rows], batch.source[rows])
    table = batch.table.copy()
    table[rows, : values.shape[1]] = values
    return replace(batch, table=table, error=max(error, batch.error))


def _judged(batch: _Claim, _: int) -> Fates:
    fates = np.where(_settled(batch, batch.bound), Fate.SETTLED, Fate.SPLIT).astype(np.intp)
    for rule, fate in ((_by_multiple, Fate.SETTLED), (_violations, Fate.REFUTE)):
        rows = np.flatnonzero(fates == Fate.SPLIT)
        fates[rows[rule(batch.select(rows), batch.bound)]] = fate
    return fates


def _settled(batch: _Claim, bound: float) -> Bools:
    settled = batch.value.min(axis=1) > bound
    for zero in batch.zeros:
        settled |= zero.min(axis=1) > bound
        if not batch.below:
            settled |= zero.max(axis=1) < -bound
    return settled


def _by_multiple(batch: _Claim, bound: float) -> Bools:
    """Where a multiple of a polynomial that vanishes makes up for what is negative."""
    settled, value = np.zeros(len(batch), dtype=bool), batch.value
    zeros = batch.zeros if len(batch.zeros) == 1 or batch.below else ()
    for zero in (zero for zero in zeros if zero.shape == value.shape):
        with np.errstate(all="ignore"):
            ratios = -value / zero
            least = np.where(zero > 0, ratios, -np.inf).max(axis=1)
            if batch.below:
                least = np.maximum(least, 0.0)
            times = (least + np.where(zero < 0, ratios, np.inf).min(axis=1)) / 2
            sums = (value + times[:, None] * zero).min(axis=1)
            settled |= sums > 2 * bound * (1 + np.abs(times))  # false where it is nan
    return settled


def _violations(batch: _Claim, bound: float) -> Bools:
    if not batch.zeros:
        return at_vertices(batch.value, batch.corners.shape[1]).min(axis=1) < -bound
    if batch.below:
        return np.asarray(_highest(batch).min(axis=1) < -bound)
    if len(batch.zeros) > 1:
        return np.zeros(len(batch), dtype=bool)
    ends = at_vertices(batch.zeros[0], batch.corners.shape[1])
    changing = np.flatnonzero((ends.min(axis=1) < -bound) & (ends.max(axis=1) > bound))
    result, opposite = np.zeros(len(batch), dtype=bool), batch.select(changing).opposed
    result[changing] = (opposite.value.min(axis=1) > bound) | _by_multiple(opposite, bound)
    return result


def _witness(batch: _Claim) -> Floats:
    """Where the first simplex violates the claim: its worst vertex, or the zero between two vertices."""
    vertices, corners = batch.corners.shape[1], batch.corners[0]
    if batch.below:
        return corners[_highest(batch)[0].argmin()]
    if not batch.zeros:
        return corners[at_vertices(batch.value, vertices)[0].argmin()]
    values = at_vertices(batch.zeros[0], vertices)[0]
    low, high = int(values.argmin()), int(values.argmax())
    degree = degree_of(batch.zeros[0].shape[1], vertices - 1)
    # the B-form on the edge from low to high: of all other vertices the index is 0
    pairs = zip(homogeneous_exponents(degree, vertices), batch.zeros[0][0], strict=True)
    edge = np.array([c for _, c in sorted((a[high], c) for a, c in pairs if a[low] + a[high] == degree)])
    share = 0.0
    for step in range(1, 54):  # as many bisections as a double has binary digits
        first, second = halves(edge, 0)
        edge = second if first[-1] < 0 else first
        share += 2.0**-step * (first[-1] < 0)
    return corners[low] * (1 - share) + corners[high] * share


def _highest(batch: _Claim) -> Floats:
    """The largest of all polynomials at each vertex (N, d+1)."""
    return np.maximum.reduce([at_vertices(c, batch.corners.shape[1]) for c in (batch.value, *batch.zeros)])
