"""Singular (Decker, Greuel, Pfister and Schoenemann): its input, and what it prints."""

from __future__ import annotations

import re

from pas.algebra.brief import cut
from pas.algebra.polynomial import Polynomial
from pas.algebra.systems import Rows, System, check_ring, read_entry

RING = re.compile(r"ring\s+\w+\s*=\s*\(?(?P<field>\w+)[^,]*,\s*\(?(?P<variables>[\w\s,]*?)\)?\s*,\s*\(?\w+\)?\s*;")
GIVEN = re.compile(r"(?:ideal|module)\s+\w+\s*=(?P<all>[^;]*);")
PRINTED = re.compile(r"^\s*\w*\[\d+\]\s*=(?P<one>.*)$", re.M)
UNIT = re.compile(r"\*?gen\((\d+)\)")


def write(rows: Rows) -> str:
    """The ring and the ideal or module of some generators."""
    parts = [f"[{', '.join(map(str, row))}]" if len(row) > 1 else str(row[0]) for row in rows]
    kind = "module M" if len(rows[0]) > 1 else "ideal I"
    generators = ",\n  ".join(parts)
    return f"ring R = 0, (x, y, z), dp;\n{kind} = {generators};\n"


def read(text: str) -> Rows:
    """The generators of the ideal or module."""
    check_ring(RING.search(text))
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


SINGULAR = System("singular", write, read)
