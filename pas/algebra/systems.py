"""Ideals and modules in the languages of computer algebra systems, registered by name.

A system's `write` makes its input of rows (generators, each a tuple of polynomials; of one for an ideal) and `read`
makes rows of such input, and of what the system prints.  A user's own is added by `SYSTEMS.register(System(...))`.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from pas.algebra.brief import cut, latex
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


class Exported:
    """An object with generators, which other programs can read."""

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
    """An object that can be made of its generators again."""

    @classmethod
    def of_rows(cls, rows: Rows) -> Self:
        """The object that some tuples generate; raises `ValueError` for tuples of another length than it has."""
        return cls(*rows)

    @classmethod
    def from_singular(cls, text: str) -> Self:
        """The object of input for Singular, `ideal I = ...;` or `module M = ...;`, or of its output, `I[1]=...`.

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


# --- Singular (Decker, Greuel, Pfister and Schoenemann): its input, and what it prints

OF_SINGULAR = re.compile(
    r"ring\s+\w+\s*=\s*\(?(?P<field>\w+)[^,]*,\s*\(?(?P<variables>[\w\s,]*?)\)?\s*,\s*\(?\w+\)?\s*;"
)
GIVEN = re.compile(r"(?:ideal|module)\s+\w+\s*=(?P<all>[^;]*);")
PRINTED = re.compile(r"^\s*\w*\[\d+\]\s*=(?P<one>.*)$", re.M)
UNIT = re.compile(r"\*?gen\((\d+)\)")


def _to_singular(rows: Rows) -> str:
    """The ring and the ideal or module of some generators."""
    parts = [f"[{', '.join(map(str, row))}]" if len(row) > 1 else str(row[0]) for row in rows]
    kind = "module M" if len(rows[0]) > 1 else "ideal I"
    generators = ",\n  ".join(parts)
    return f"ring R = 0, (x, y, z), dp;\n{kind} = {generators};\n"


def _from_singular(text: str) -> Rows:
    """The generators of the ideal or module."""
    check_ring(OF_SINGULAR.search(text))
    given = GIVEN.search(text)
    if given is None and not PRINTED.search(text):
        raise ValueError(f"there is no ideal and no module of Singular in {cut(text.strip(), 60)!r}")
    items = re.split(r",(?![^\[]*\])", given["all"]) if given else [m["one"] for m in PRINTED.finditer(text)]
    rows = [_row(item) for item in items]
    width = max(map(len, rows))
    return tuple((*row, *[Polynomial(0)] * (width - len(row))) for row in rows)  # zeros at the end are not printed


def _row(text: str) -> tuple[Polynomial, ...]:
    """One generator: a polynomial, entries in brackets, or a sum of multiples of unit vectors gen(i)."""
    inner = text.strip()
    if inner.startswith("["):
        return tuple(map(read_entry, inner.strip("[]").split(",")))
    if "gen(" not in inner:
        return (read_entry(inner),)
    entries: dict[int, Polynomial] = {}
    for term in re.findall(r"[+-]?[^+-]+", inner):
        unit = UNIT.search(term)
        if unit is None:
            raise ValueError(f"{term.strip()!r} is no multiple of a unit vector gen(i)")
        factor, number = UNIT.sub("", term).strip(), int(unit[1])
        entries[number] = entries.get(number, Polynomial(0)) + read_entry(factor + "1" * (factor in ("", "+", "-")))
    return tuple(entries.get(i, Polynomial(0)) for i in range(1, max(entries) + 1))


# --- Macaulay2 (Grayson and Stillman): its input, and what its `toString` gives

OF_MACAULAY2 = re.compile(r"(?P<field>\b[A-Z]+[\w/]*)\s*\[(?P<variables>[^\]]*)\]")
MATRIX = re.compile(r"(?P<kind>ideal|image)\s*\(?\s*(?:matrix|map)\b[^{]*\{(?P<rows>.*)\}", re.S)
IDEAL = re.compile(r"\bideal\s*\(?(?P<all>[^;]*?)\)?\s*;?\s*$", re.S)


def _to_macaulay2(rows: Rows) -> str:
    """The ring and the ideal or module of some generators, which are the columns of a matrix."""
    lines = ["{" + ", ".join(map(str, line)) + "}" for line in zip(*rows, strict=True)]
    kind = "M = image" if len(lines) > 1 else "I = ideal"
    return f"R = QQ[x, y, z];\n{kind} matrix(R, {{{', '.join(lines)}}});\n"


def _from_macaulay2(text: str) -> Rows:
    """The generators of the ideal or module."""
    check_ring(OF_MACAULAY2.search(text))
    matrix, ideal = MATRIX.search(text), IDEAL.search(text)
    if matrix:
        table = [[read_entry(e) for e in line.split(",")] for line in re.findall(r"\{([^{}]*)\}", matrix["rows"])]
        if table and len({len(line) for line in table}) == 1:
            return tuple(zip(*table, strict=True))
    elif ideal:
        return tuple((read_entry(e),) for e in ideal["all"].split(","))
    raise ValueError(f"there is no ideal and no module of Macaulay2 in {cut(text.strip(), 60)!r}")


SYSTEMS: Registry[System] = Registry(
    "computer algebra system",
    {
        "singular": System("singular", _to_singular, _from_singular),
        "macaulay2": System("macaulay2", _to_macaulay2, _from_macaulay2),
    },
)
