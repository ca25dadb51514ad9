"""What is of little use in a solution space, told apart: a user who gets only that is told so.

- *singular*: members with alpha = 0 on a contact curve, such as squares; a member outside all of
  these subspaces is regular.
- *products*: multiples of products such as `f1 f2` or `f1 h2^2` and their sums: they exist whatever
  the contacts are, from the degree of the products on (single cells only).
- *global*: members whose pieces are all the same polynomial (several pieces only).
- a *common factor* of all members, and basis members that are reducible.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod

from flint import fmpq, fmpq_mat

from pas.algebra.brief import brief
from pas.algebra.monomials import count, exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import Polynomial
from pas.blending.regularity import vanishing_alpha
from pas.blending.space import Space


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
        """What a user must know, a sentence each; nothing for a space with nothing trivial."""
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
            kind = (
                "all members are"
                if self.products.dimension == m
                else f"{self.products.dimension} of {m} dimensions are"
            )
            yield f"{kind} sums of products of the given surfaces and clips, which exist for any data"
        if self.same_everywhere is not None and self.same_everywhere.dimension:
            found = self.same_everywhere.dimension
            kind = "all members are" if found == m else f"{found} of {m} dimensions are"
            yield f"{kind} single polynomials, the same on all pieces"
        if len(self.reducible) == m and (m == 1 or self.common_factor.degree <= 0):
            yield "all basis members are reducible"

    def __str__(self) -> str:
        return "\n".join(self.remarks())


def trivial_part(space: Space) -> TrivialPart:
    """The trivial members of a space."""
    singular = tuple(space.subspace(vanishing_alpha(space, i)) for i in range(len(space.contacts)))
    single = len(space.patches) == 1
    return TrivialPart(
        space, singular, _products(space) if single else None, None if single else _same_everywhere(space)
    )


def _products(space: Space) -> Space:
    """The span of products of one generator of each contact ideal, times anything, in degree."""
    factors = [(c.surface, c.clip ** (space.order + 1)) for c in space.contacts]
    rows = []
    for chosen in product(*factors):
        whole = prod(chosen, start=Polynomial(1))
        for shift in exponents(space.degree - whole.degree) if whole.degree <= space.degree else ():
            rows.append((whole * Polynomial({shift: 1})).row(space.degree))
    reduced, rank = fmpq_mat(len(rows), count(space.degree), [v for row in rows for v in row]).rref()
    return space.restricted([(Polynomial.from_row(row, space.degree),) for row in reduced.tolist()[:rank]])


def _same_everywhere(space: Space) -> Space:
    first, *others = (m.transpose().tolist() for m in space.patches)
    rows: list[dict[int, fmpq]] = []
    for other in others:
        for a, b in zip(first, other, strict=True):
            rows.append({j: u - v for j, (u, v) in enumerate(zip(a, b, strict=True)) if u != v})
    found: fmpq_mat = nullspace(rows, space.dimension)
    return space.subspace(found)
