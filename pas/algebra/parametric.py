"""Membership in contact ideals with parameters: its linear equations, and their solutions case by case.

Where the leading monomials of f and h^(k+1) in some graded order have no variable in common and constant coefficients,
{f, h^(k+1)} is a Groebner basis for all values of the parameters (Buchberger's first criterion), and g lies in the
ideal iff its remainder, linear in the coefficients of g, is zero.

Nullspaces are found by fraction-free Gaussian elimination.  A pivot is used where it is known to vanish nowhere: a
constant, a polynomial of definite sign, or one that the case excludes.  Where no such entry is
left, the case is split on an irreducible factor of an entry (Sit 1992).  Pivots of the same case
are therefore nonzero at each of its points, so dimension and basis hold at each of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import inf

from flint import fmpq_mpoly

from pas.algebra.ideal import MonomialRemainders
from pas.algebra.locus import Locus
from pas.algebra.monomials import Exponents, exponents
from pas.algebra.polynomial import primitive
from pas.limits import checkpoint

Row = dict[int, fmpq_mpoly]

Terms = dict[Exponents, fmpq_mpoly]
"""A polynomial in x, y, z whose coefficients are polynomials in the parameters."""


@dataclass(frozen=True)
class ParametricNullspace:
    """The solutions on one locus: `basis` holds them as {unknown: polynomial in the parameters}."""

    locus: Locus
    basis: tuple[Row, ...]


def parametric_nullspaces(
    rows: Sequence[Mapping[int, fmpq_mpoly]], unknowns: int, locus: Locus
) -> Iterator[ParametricNullspace]:
    """The solutions v of `row . v = 0` for every row, on disjoint loci that together are `locus`."""
    pending = [(locus, [dict(row) for row in rows], list[tuple[int, Row]]())]
    while pending:
        case, open_rows, solved = pending.pop()
        open_rows = _simplified(open_rows, case)
        doubt = _eliminate(open_rows, solved, case)
        if doubt is None:
            yield ParametricNullspace(case, _basis(solved, unknowns, case))
            continue
        for part in (*case.where_zero(doubt), *case.where_nonzero(doubt)):
            pending.append((part, open_rows, list(solved)))


def independent(vectors: Sequence[Mapping[int, fmpq_mpoly]], locus: Locus) -> list[int]:
    """Positions of vectors that are linearly independent at each point of the locus.

    As many as pivots that are known not to vanish will show; earlier vectors are preferred.
    """
    chosen: list[int] = []
    solved: list[tuple[int, Row]] = []
    for number, vector in enumerate(vectors):
        row = _reduced(dict(vector), case=locus)
        for column, other in solved:
            row = _cancelled(row, other, column, locus)
        pivot = min((c for c in row if locus.excludes(row[c])), key=lambda c: len(row[c]), default=None)
        if pivot is not None:
            chosen.append(number)
            solved.append((pivot, row))
    return chosen


def merged(solutions: list[ParametricNullspace]) -> list[ParametricNullspace]:
    """Cases widened over an inequation where the case beyond it has the same solutions.

    Each step takes an inequation away and adds none, so it ends.
    """
    found = list(solutions)
    while True:
        wider = next((w for case in found if (w := _widened(case, found)) is not None), None)
        if wider is None:
            return sorted(found, key=lambda s: (len(s.locus.equations), len(s.basis)))
        found = wider


def _widened(case: ParametricNullspace, cases: list[ParametricNullspace]) -> list[ParametricNullspace] | None:
    """All cases with one inequation of `case` dropped, and others cut down to what is left of them."""
    alike = [c for c in cases if c is not case and len(c.basis) == len(case.basis)]
    for q in case.locus.inequations:
        rest = tuple(p for p in case.locus.inequations if p is not q)
        whole = Locus(case.locus.parameters, case.locus.equations, rest)
        parts = whole.where_zero(q)
        touched = [c for c in alike if any(part.within(c.locus) for part in parts)]
        covered = all(any(part.within(c.locus) for c in touched) for part in parts)
        if not covered or any(len(independent(case.basis, part)) < len(case.basis) for part in parts):
            continue
        cut = [(c, c.locus.outside(whole)) for c in touched]
        if all(len(left) <= 1 and all(len(p.inequations) <= len(c.locus.inequations) for p in left) for c, left in cut):
            others = [c for c in cases if c is not case and all(c is not t for t in touched)]
            smaller = [ParametricNullspace(p, c.basis) for c, left in cut for p in left]
            return [*others, ParametricNullspace(whole, case.basis), *smaller]
    return None


def _eliminate(rows: list[Row], solved: list[tuple[int, Row]], case: Locus) -> fmpq_mpoly | None:
    """Eliminate in place; the factor to split on where no safe pivot is left, None at the end."""
    while rows:
        checkpoint(f"eliminating with parameters ({len(rows)} rows left)")
        constant = _cheapest(rows, lambda entry: bool(entry.is_constant()))
        place = constant or _cheapest(rows, lambda entry: not case.doubtful(entry))
        if place is None:
            return _doubtful_factor(rows, case)
        number, column = place
        pivot = rows.pop(number)
        rows[:] = _simplified([_cancelled(row, pivot, column, case) for row in rows], case)
        solved.append((column, pivot))
    return None


def _cheapest(rows: Sequence[Row], admits: Callable[[fmpq_mpoly], bool]) -> tuple[int, int] | None:
    """Row and column of the entry that fills in least among those admitted (Markowitz 1957)."""
    uses = Counter(column for row in rows for column in row)
    best, place = inf, None
    for number, row in enumerate(rows):
        for column, entry in row.items():
            cost = (len(row) - 1) * (uses[column] - 1) + len(entry) - 1
            if cost < best and admits(entry):
                best, place = cost, (number, column)
    return place


def _doubtful_factor(rows: Sequence[Row], case: Locus) -> fmpq_mpoly:
    """The factor to split on: contents of rows first, then the one of lowest degree that occurs most."""
    contents = [q for row in rows for q in case.doubtful(_content(row))]
    factors = contents or [q for row in rows for entry in row.values() for q in case.doubtful(entry)]
    times = Counter(map(str, factors))
    return min(factors, key=lambda q: (q.total_degree(), len(q), -times[str(q)], str(q)))


def _simplified(rows: Sequence[Row], case: Locus) -> list[Row]:
    """The rows modulo the equations, without zeros, repetitions and contents that do not vanish."""
    distinct: dict[str, Row] = {}
    for row in rows:
        reduced = _stripped(_reduced(row, case), case)
        if reduced:
            distinct[str(sorted((c, str(p)) for c, p in reduced.items()))] = reduced
    return list(distinct.values())


def _reduced(row: Row, case: Locus) -> Row:
    reduced = ((column, case.reduce(entry)) for column, entry in row.items())
    return {column: entry for column, entry in reduced if not entry.is_zero()}


def _content(row: Row) -> fmpq_mpoly:
    common, *others = sorted(row.values(), key=len)
    for entry in others:
        common = common.gcd(entry)
        if common.is_constant():
            break
    return common


def _stripped(row: Row, case: Locus) -> Row:
    """The row divided by the factors of its content that vanish nowhere."""
    if not row:
        return row
    content = _content(row)
    for q in case.doubtful(content):
        while True:
            quotient, rest = divmod(content, q)
            if not rest.is_zero():
                break
            content = quotient
    scale = primitive(content)
    first = next(iter(row.values())) / scale
    unit = primitive(first).leading_coefficient() / first.leading_coefficient()
    return {column: entry / scale * unit for column, entry in row.items()}


def _cancelled(row: Row, pivot: Row, column: int, case: Locus) -> Row:
    """A combination of the row and the pivot's row without the column; equivalent to the row."""
    if column not in row:
        return row
    common = row[column].gcd(pivot[column])
    mine, theirs = pivot[column] / common, row[column] / common
    result = {c: entry * mine for c, entry in row.items() if c != column}
    for c, entry in pivot.items():
        if c != column:
            result[c] = result[c] - entry * theirs if c in result else -(entry * theirs)
    return _reduced(result, case)


def _basis(solved: list[tuple[int, Row]], unknowns: int, case: Locus) -> tuple[Row, ...]:
    """One solution for each unknown without a pivot, by substitution backwards."""
    done: list[tuple[int, Row]] = []
    for column, raw in reversed(solved):
        row = _reduced(raw, case)
        for other_column, other in done:
            row = _stripped(_cancelled(row, other, other_column, case), case)
        done.append((column, row))
    bound = {column for column, _ in done}
    return tuple(_solution(free, done, case) for free in range(unknowns) if free not in bound)


def _solution(free: int, solved: Sequence[tuple[int, Row]], case: Locus) -> Row:
    using = [(column, row) for column, row in solved if free in row]
    scale = case.parameters.one
    for column, row in using:
        scale = scale * (row[column] / scale.gcd(row[column]))
    vector = {free: scale} | {column: -row[free] * (scale / row[column]) for column, row in using}
    return _stripped(_reduced(vector, case), case)


def remainders_modulo(generators: Sequence[Mapping[Exponents, fmpq_mpoly]]) -> MonomialRemainders:
    """Remainders modulo polynomials whose leading terms are constant and have no common variable.

    Raises `ValueError` where no graded order makes them so.
    """
    for order in permutations(range(3)):
        pairs = [(g, max((_grevlex(e, order), e) for e in g)[1]) for g in generators]
        leads = [lead for _, lead in pairs]
        apart = all(min(a, b) == 0 for i, p in enumerate(leads) for q in leads[:i] for a, b in zip(p, q, strict=True))
        if apart and all(g[lead].is_constant() for g, lead in pairs):
            scaled = [(lead, g, -1 / g[lead].leading_coefficient()) for g, lead in pairs]
            rules = ((lead, [(e, c * by) for e, c in g.items() if e != lead]) for lead, g, by in scaled)
            return MonomialRemainders(rules, next(iter(generators[0].values())) ** 0)
    raise ValueError("the leading terms have a variable in common or depend on the parameters")


def membership_rows(remainders: MonomialRemainders, degree: int) -> list[dict[int, fmpq_mpoly]]:
    """The equations on the coefficients of g (in the order of `exponents(degree)`)."""
    rows: dict[Exponents, dict[int, fmpq_mpoly]] = {}
    for unknown, e in enumerate(exponents(degree)):
        checkpoint("writing the conditions with parameters")
        for target, value in remainders(e).items():
            rows.setdefault(target, {})[unknown] = value
    return list(rows.values())


def _grevlex(e: Exponents, order: Sequence[int]) -> tuple[int, ...]:
    """A key that grows with the graded reverse lexicographic order for a permutation of x, y, z."""
    return (sum(e), *(-e[i] for i in reversed(order)))
