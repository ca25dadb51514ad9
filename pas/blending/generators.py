"""Generators of all solutions of any degree: of an ideal for a single cell, else of a module."""

from __future__ import annotations

from dataclasses import dataclass

from pas.algebra.brief import brief
from pas.algebra.normal_form import NormalForm
from pas.algebra.polynomial import Polynomial
from pas.blending.methods import intersection
from pas.blending.multipliers import Multipliers, consistency
from pas.blending.space import Space


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
    forms = [NormalForm([c.surface.raw**2, c.clip.raw]) for c in space.contacts]
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
