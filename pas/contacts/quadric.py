"""Quadrics of any kind as contacts, by a polynomial or a matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, TypeAlias

from flint import fmpq_mpoly

from pas.algebra.brief import brief
from pas.algebra.inputs import shown
from pas.algebra.polynomial import GENERATORS, RING, Polynomial, PolynomialLike
from pas.algebra.rational import Exact, rational
from pas.contacts.contact import Contact
from pas.contacts.movable import Movable

QuadricLike: TypeAlias = "PolynomialLike | Sequence[Sequence[Exact]]"
"""What is taken for a quadric: a polynomial of degree 2, or a symmetric 4x4 matrix of exact numbers."""


@dataclass(frozen=True)
class QuadricContact(Movable):
    """A quadric with a clip: any of the kinds that there are, in any position.

    `quadric` is a polynomial of degree 2, or a symmetric 4x4 matrix Q of exact numbers that stands for
    `(x, y, z, 1) Q (x, y, z, 1)^T` (Salmon 1862); negative inside.  `clip` is a polynomial, as a rule a plane, negative
    on the blend's side.

    Raises `ValueError` for what is no quadric, for a constant clip and one that has a factor in common with the
    quadric.
    """

    table: ClassVar[str] = "quadrics"

    quadric: Polynomial
    clip: Polynomial

    def __init__(self, quadric: QuadricLike, clip: PolynomialLike) -> None:
        found = Contact(_polynomial(quadric), clip)
        if found.surface.degree != 2:
            raise ValueError(f"quadric must be of degree 2, and {found.surface} is of degree {found.surface.degree}")
        object.__setattr__(self, "quadric", found.surface)
        object.__setattr__(self, "clip", found.clip)

    __repr__ = brief

    @cached_property
    def contact(self) -> Contact:
        """The surface and its clip as polynomials."""
        return Contact(self.quadric, self.clip)

    def __str__(self) -> str:
        return f"quadric {self.quadric} = 0 up to {self.clip} = 0"


def _polynomial(quadric: Any) -> Polynomial:
    if isinstance(quadric, str) or not hasattr(quadric, "__len__") or hasattr(quadric, "keys"):
        try:
            return Polynomial(quadric)
        except (ValueError, TypeError) as error:
            raise type(error)(f"quadric: {error}") from None
    if len(quadric) != 4 or any(not hasattr(row, "__len__") or len(row) != 4 for row in quadric):
        raise ValueError(
            f"quadric must be a polynomial or a symmetric matrix of 4 rows of 4 numbers, not {shown(quadric)}"
        )
    rows = [[rational(c, f"quadric[{i}][{j}]") for j, c in enumerate(row)] for i, row in enumerate(quadric)]
    wrong = next(((i, j) for i in range(4) for j in range(i) if rows[i][j] != rows[j][i]), None)
    if wrong is not None:
        i, j = wrong
        raise ValueError(f"quadric must be symmetric, and quadric[{i}][{j}] is not quadric[{j}][{i}]")
    four: list[fmpq_mpoly] = [*GENERATORS, RING.constant(1)]
    raw = sum((four[i] * four[j] * c for i, row in enumerate(rows) for j, c in enumerate(row)), RING.constant(0))
    return Polynomial.from_raw(raw)
