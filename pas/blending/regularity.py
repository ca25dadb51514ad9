"""The members of a space that are regular at its contacts, its trivial part, and generators of members of any degree.

A member g that meets a contact (f, h) is `alpha f + beta h^(k+1)`.  Where alpha vanishes on all of the curve V(f, h),
g is singular along it and continues nothing.  Such members are *singular*.  Of little use are also *products*,
multiples of such as `f1 f2` or `f1 h2^2` and their sums, which exist whatever the contacts are (single cells only),
*global* members, whose pieces are all the same polynomial (several pieces only), and members with a common factor.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod

from flint import fmpq, fmpq_mat

from pas.algebra.brief import brief
from pas.algebra.ideal import Ideal
from pas.algebra.monomials import Exponents, count, exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import Polynomial
from pas.blending.multipliers import Multipliers, consistency
from pas.blending.solving import intersection
from pas.blending.space import Space
from pas.contacts.contact import Contact
from pas.contacts.joins import Join


def vanishing_alpha(space: Space, contact: int) -> fmpq_mat:
    """The members with alpha = 0 on the curve of contact number `contact`, as coefficient rows.

    `g = alpha f + beta h^(k+1)` has alpha in `<f, h>` iff g lies in `<f^2, h>`.
    """
    join, rows = space.placed.joins[contact], list[dict[int, fmpq]]()
    for piece in join.pieces:
        members = enumerate(space.patches[piece].tolist())
        rows += _trivial(join.contact).equations(((i, _terms(row, space.degree)) for i, row in members), space.degree)
    return nullspace(rows, space.dimension)


def is_regular(space: Space) -> bool:
    """Whether some member meets every contact with alpha not identically zero on its curve.

    And, where it is that through which the region is open, leaves its surface at that curve: members of low degree are
    multiples of f, all of which is zero.
    """
    joins = space.placed.joins
    return space.dimension > 0 and all(
        _some_beyond(space, join, _trivial(join.contact))
        and (not join.opening or _some_beyond(space, join, Ideal(join.contact.surface)))
        for join in joins
    )


def _some_beyond(space: Space, join: Join, ideal: Ideal) -> bool:
    """Whether some member is not in an ideal, on a piece that carries a contact; stops at the first."""
    rows = (map(fmpq, space.source.row(piece, member)) for piece in join.pieces for member in range(space.dimension))
    return any(ideal.equations([(0, _terms(row, space.degree))], space.degree) for row in rows)


def _terms(row: Iterable[fmpq], degree: int) -> Iterator[tuple[Exponents, fmpq]]:
    return ((e, c) for e, c in zip(exponents(degree), row, strict=True) if c != 0)


def _trivial(contact: Contact) -> Ideal:
    """Modulo `<f^2, h>`, in which members with alpha = 0 lie."""
    return Ideal.from_raw(contact.surface.raw**2, contact.clip.raw)


@dataclass(frozen=True, eq=False)
class TrivialPart:
    """The trivial members of a space, each kind a subspace (with `dimension`, `basis`, ...).

    `singular[i]` belongs to contact i.  `products` is None for several pieces, `same_everywhere`
    (all pieces the same polynomial) for a single one.
    """

    space: Space
    singular: tuple[Space, ...]
    products: Space | None
    same_everywhere: Space | None

    __repr__ = brief

    @cached_property
    def common_factor(self) -> Polynomial:
        """The greatest common divisor of all members on all pieces (1 where there is none)."""
        common = Polynomial(0).raw
        for member in self.space.basis:
            for patch in member:
                common = common.gcd(patch.raw)
        return Polynomial(1) if common.is_constant() else Polynomial.from_raw(common)

    @cached_property
    def reducible(self) -> dict[int, tuple[tuple[Polynomial, int], ...]]:
        """The basis members that are reducible over Q on every piece: number -> factors of the
        first piece with multiplicities."""
        found = {}
        for number, member in enumerate(self.space.basis):
            factors = [[(Polynomial.from_raw(f), int(e)) for f, e in patch.raw.factor()[1]] for patch in member]
            if all(sum(e for _, e in fs) > 1 for fs in factors):
                found[number] = tuple(factors[0])
        return found

    def remarks(self) -> Iterator[str]:
        """Sentences that a user must know about the space; none where nothing is trivial."""
        m = self.space.dimension
        if m == 0:
            return
        for number, part in enumerate(self.singular, start=1):
            if part.dimension == m:
                yield f"all members are singular along contact {number} (alpha = 0 on its curve): none is usable"
            elif part.dimension:
                yield f"{part.dimension} of {m} dimensions are singular along contact {number}"
        if m > 1 and self.common_factor.degree > 0:
            yield f"all members have the common factor {self.common_factor}"
        if self.products is not None and self.products.dimension:
            kind = "sums of products of the given surfaces and clips, which exist for any data"
            yield f"{_share(self.products, m)} {kind}"
        if self.same_everywhere is not None and self.same_everywhere.dimension:
            yield f"{_share(self.same_everywhere, m)} single polynomials, the same on all pieces"
        if len(self.reducible) == m and (m == 1 or self.common_factor.degree <= 0):
            yield "all basis members are reducible"

    def __str__(self) -> str:
        return "\n".join(self.remarks())


def _share(part: Space, dimension: int) -> str:
    return "all members are" if part.dimension == dimension else f"{part.dimension} of {dimension} dimensions are"


def trivial_part(space: Space) -> TrivialPart:
    """The trivial members of a space."""
    singular = tuple(space.subspace(vanishing_alpha(space, i)) for i in range(len(space.contacts)))
    first, *others = space.patches
    if others:
        differences = (row for other in others for row in (first - other).transpose().tolist())
        equal = [{j: value for j, value in enumerate(row) if value != 0} for row in differences]
        return TrivialPart(space, singular, None, space.subspace(nullspace(equal, space.dimension)))
    # the span of products of one generator of each contact ideal, times anything
    chosen = product(*((c.surface, c.clip ** (space.order + 1)) for c in space.contacts))
    whole = (prod(factors, start=Polynomial(1)) for factors in chosen)
    shifts = ((p, shift) for p in whole for shift in exponents(space.degree - p.degree))
    rows = [(p * Polynomial({shift: 1})).row(space.degree) for p, shift in shifts]
    reduced, rank = fmpq_mat(len(rows), count(space.degree), [v for row in rows for v in row]).rref()
    products = [(Polynomial.from_row(row, space.degree),) for row in reduced.tolist()[:rank]]
    return TrivialPart(space, singular, space.restricted(products), None)


@dataclass(frozen=True, eq=False)
class Generator:
    """One generator: a polynomial for each piece (user's coordinates).

    `multipliers` are those of the contacts and faces (`gamma f + beta h^(k+1)`, `alpha plane^(k+1)`);
    `regular[i]` says whether alpha is not identically zero on the curve of contact i.
    """

    polynomials: tuple[Polynomial, ...]
    multipliers: Multipliers
    regular: tuple[bool, ...]

    __repr__ = brief

    @property
    def degree(self) -> int:
        """The largest degree of its polynomials."""
        return max(p.degree for p in self.polynomials)

    def __str__(self) -> str:
        return ", ".join(map(str, self.polynomials))


def generators(space: Space) -> tuple[Generator, ...]:
    """Generators of all solutions of any degree, by ascending degree.

    For a single cell the reduced graded Groebner basis of the ideal that they form; for
    several pieces generators of the module over Q[x, y, z].
    """
    system = consistency(space.placed)
    if len(space.patches) == 1:
        basis = intersection(space.contacts, space.order).groebner_basis()
        found: list[tuple[Polynomial, ...]] = [(g.primitive(),) for g in basis]
    else:
        found = [s.patches for s in system.generators()]
    forms = list(map(_trivial, space.contacts))
    carriers = [pieces[0] for pieces in space.placed.carriers]
    made = [
        Generator(
            member,
            system.multipliers(member),
            tuple(not form.reduce(member[piece].raw).is_zero() for form, piece in zip(forms, carriers, strict=True)),
        )
        for member in found
    ]
    return tuple(sorted(made, key=lambda g: g.degree))
