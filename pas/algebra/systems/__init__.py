"""Ideals and modules in the languages of computer algebra systems: one short file each, registered by name.

A system's `write` makes its input of rows (generators, each a tuple of polynomials; of one for an ideal) and `read`
makes rows of such input, and of what the system prints.  A user's own is added by `SYSTEMS.register(System(...))`.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from pas.algebra.brief import latex
from pas.algebra.polynomial import Polynomial
from pas.registry import Registry

if TYPE_CHECKING:
    import sympy

Rows = tuple[tuple[Polynomial, ...], ...]
"""Generators of a module, all of one length; of length 1 they generate an ideal."""

SHOWN = 4
"""Generators that a notebook shows."""


@dataclass(frozen=True)
class System:
    """A language: how rows are written in it, and how they are read; raises `ValueError` for what it cannot read."""

    name: str
    write: Callable[[Rows], str]
    read: Callable[[str], Rows]


SYSTEMS: Registry[System] = Registry(
    "computer algebra system",
    {"singular": "pas.algebra.systems.singular:SINGULAR", "macaulay2": "pas.algebra.systems.macaulay2:MACAULAY2"},
)


class Exported:
    """What has generators that other programs can go on with."""

    @property
    @abstractmethod
    def rows(self) -> Rows:
        """The generators, as tuples of polynomials."""

    def written(self, system: str) -> str:
        """The generators in the language of a registered system; raises `ValueError` for another, and for none."""
        if not self.rows:
            raise ValueError("there are no generators to write")
        return SYSTEMS[system].write(self.rows)

    def to_singular(self) -> str:
        """Input for Singular: the ring R, and the ideal I or the module M that the generators generate."""
        return self.written("singular")

    def to_macaulay2(self) -> str:
        """Input for Macaulay2: the ring R, and the ideal I or the module M that the generators generate."""
        return self.written("macaulay2")

    def to_sympy(self) -> list[sympy.Expr | tuple[sympy.Expr, ...]]:
        """The generators as sympy expressions in the symbols x, y, z, or tuples of them."""
        rows = [tuple(p.to_sympy() for p in row) for row in self.rows]
        return [row[0] if len(row) == 1 else row for row in rows]

    def to_latex(self) -> str:
        """The generators between angle brackets, all terms and digits written out, for math mode."""
        return spanned(self.rows, len(self.rows), whole=True)

    def _repr_latex_(self) -> str:
        return f"${spanned(self.rows)}$"


class Exchanged(Exported):
    """What can be made of its generators again."""

    @classmethod
    def of_rows(cls, rows: Rows) -> Self:
        """That which some tuples generate; raises `ValueError` for tuples of another length than it has."""
        return cls(*rows)

    @classmethod
    def from_singular(cls, text: str) -> Self:
        """That of input for Singular, `ideal I = ...;` or `module M = ...;`, or of what it prints, `I[1]=...`.

        The ring is Q[x, y, z].  Raises `ValueError`, which quotes what cannot be read.
        """
        return cls.of_rows(SYSTEMS["singular"].read(text))

    @classmethod
    def from_macaulay2(cls, text: str) -> Self:
        """That of `ideal(...)`, `ideal matrix {...}` or `image matrix {...}`, as `toString` of Macaulay2 gives them.

        The ring is Q[x, y, z].  Raises `ValueError`, which quotes what cannot be read.
        """
        return cls.of_rows(SYSTEMS["macaulay2"].read(text))


def spanned(rows: Sequence[Sequence[Polynomial]], most: int = SHOWN, *, whole: bool = False) -> str:
    """The first generators between angle brackets in LaTeX; long ones are shortened but where the `whole` is asked."""
    parts = [", ".join(latex(str(p), whole=whole) for p in row) for row in rows[:most]]
    parts = [part if len(row) == 1 else f"({part})" for part, row in zip(parts, rows, strict=False)]
    listed = r",\; ".join([*parts, *[r"\ldots"] * (len(rows) > most)])
    return rf"\langle {listed} \rangle"


def check_ring(found: re.Match[str] | None) -> None:
    """Raise `ValueError` for another ring than Q[x, y, z]; None where the text does not say."""
    if found is not None and not {"x", "y", "z"}.issuperset(re.split(r"\s*,\s*", found["variables"].strip())):
        raise ValueError(f"the variables must be x, y and z, not {found['variables']}")
    if found is not None and found["field"] not in ("0", "QQ"):
        raise ValueError(f"the characteristic must be 0, not {found['field']}")


def read_entry(text: str) -> Polynomial:
    """A polynomial, with or without signs for products and powers: `3/2x2y` is `3/2*x^2*y`."""
    plain = re.sub(r"(?<=[xyz])(?=\d)", "^", re.sub(r"\s+", "", text).replace("**", "^"))
    plain = re.sub(r"(?<=[\dxyz)])(?=[xyz(])", "*", plain)
    try:
        return Polynomial(plain)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{text.strip()!r} is no polynomial in x, y and z: {error}") from None
