"""Short reprs and LaTeX: what an object is in at most `LONGEST` characters, however many numbers it holds.

A class says `__repr__ = brief` (a dataclass keeps it); all numbers are in `str`, where that makes sense, and in its
fields.  LaTeX is for notebooks, hence short of what fills a page.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import fields, is_dataclass
from fractions import Fraction
from reprlib import Repr
from typing import Any

from flint import fmpq

LONGEST = 200
"""Characters of a repr: two lines of a terminal."""

PIECE = 60
"""Characters of one field of it."""

FORMULA = 130
"""Characters of a formula within a repr."""


MOST_TERMS, MOST_DIGITS = 24, 20
"""Terms of a polynomial that LaTeX writes out, some lines of a notebook, and digits of a number."""


class _Brief(Repr):
    def repr_ndarray(self, array: Any, level: int) -> str:
        return f"<{array.dtype} {array.shape}>" if array.size > self.maxtuple else repr(array.tolist())

    def repr_function(self, function: Any, level: int) -> str:
        return "a function"

    def repr_instance(self, thing: Any, level: int) -> str:
        if is_dataclass(thing):
            return f"{type(thing).__name__}(...)"
        return cut(str(thing) if isinstance(thing, Fraction | fmpq) else repr(thing), self.maxother)


_WORDS = _Brief()
_WORDS.maxlevel, _WORDS.maxother, _WORDS.maxstring = 3, PIECE, PIECE
_WORDS.maxtuple = _WORDS.maxlist = _WORDS.maxdict = _WORDS.maxset = 3


def cut(text: str, most: int = LONGEST) -> str:
    """A text of at most `most` characters: the middle of a longer one is left out."""
    head = (most - 3) * 3 // 4
    return text if len(text) <= most else f"{text[:head]}...{text[len(text) - (most - 3 - head) :]}"


def brief(thing: Any) -> str:
    """`Name(field=value, ...)` of a dataclass, or `Name()`, each value and the whole shortened."""
    shown = [f for f in fields(thing) if f.repr] if is_dataclass(thing) else []
    pieces: list[str] = []
    room = LONGEST - len(type(thing).__name__) - len("(, ...)")
    for field in shown:
        piece = f"{field.name}={cut(_WORDS.repr(getattr(thing, field.name)), PIECE)}"
        if len(piece) + 2 > room:
            pieces.append("...")
            break
        pieces.append(piece)
        room -= len(piece) + 2
    return f"{type(thing).__name__}({', '.join(pieces)})"


def formula_repr(name: str, formula: str, what: str) -> str:
    """`Name('formula')`, which Python reads again, or where that is too long `what` it is and its beginning and end."""
    whole = f"{name}({formula!r})"
    return whole if len(whole) <= LONGEST else f"<{name} of {what}: {cut(formula, FORMULA)}>"


def whole_or_brief(name: str, items: Sequence[str], what: str) -> str:
    """`Name(item, ...)`, which Python reads again, or where that is too long the number of items and the first one."""
    text = f"{name}({', '.join(items)})"
    return text if len(text) <= LONGEST else f"<{name} of {len(items)} {what}: {cut(items[0], FORMULA)}, ...>"


def listed(head: str, names: Iterable[str]) -> str:
    """`<head name, name, ...>`, and how many more names there are."""
    all_names, shown = list(names), []
    room = LONGEST - len(head) - len(", and 99999 more>")
    for name in all_names:
        room -= len(name) + 2
        if room < 0:
            break
        shown.append(name)
    more = len(all_names) - len(shown)
    return f"{head} {', '.join(shown)}{f' and {more} more' if more else ''}>"


def latex(text: str, *, whole: bool = False) -> str:
    """A polynomial such as `4/9*x^2*y - z + 1`, as it prints, for math mode.

    Of long ones it is the beginning and the length, unless the `whole` is asked for.

    >>> latex("4/9*x^12*y - z + 1")
    '\\\\frac{4}{9} x^{12} y - z + 1'
    """
    terms = re.split(r" (?=[+-] )", text)
    if len(terms) > MOST_TERMS and not whole:
        terms = [*terms[: MOST_TERMS - 1], rf"+ \cdots \text{{ ({len(terms)} terms)}}"]
    line = re.sub(r"\^(\d+)", r"^{\1}", " ".join(terms))
    line = re.sub(r"(\d+)/(\d+)", lambda found: rf"\frac{{{found[1]}}}{{{found[2]}}}", line)
    return (line if whole else re.sub(r"\d+", lambda found: _shortened(found[0]), line)).replace("*", " ")


def _shortened(digits: str) -> str:
    if len(digits) <= MOST_DIGITS:
        return digits
    return rf"{digits[:6]}\ldots_{{{len(digits)}\text{{ digits}}}}"
