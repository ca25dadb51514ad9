"""Exact polynomials as LaTeX, from the text that they print as: for notebooks, hence short of what fills a page."""

from __future__ import annotations

import re

MOST_TERMS = 24
"""Terms that are written out: some lines of a notebook."""

MOST_DIGITS = 20
"""Of a number that is written out."""


def latex(text: str) -> str:
    """A text such as `4/9*x^2*y - z + 1` for math mode; of long sums and numbers the beginning and their length.

    >>> latex("4/9*x^12*y - z + 1")
    '\\\\frac{4}{9} x^{12} y - z + 1'
    """
    terms = re.split(r" (?=[+-] )", text)
    if len(terms) > MOST_TERMS:
        terms = [*terms[: MOST_TERMS - 1], rf"+ \cdots \text{{ ({len(terms)} terms)}}"]
    line = re.sub(r"\^(\d+)", r"^{\1}", " ".join(terms))
    line = re.sub(r"(\d+)/(\d+)", lambda found: rf"\frac{{{found[1]}}}{{{found[2]}}}", line)
    return re.sub(r"\d+", lambda found: _number(found[0]), line).replace("*", " ")


def _number(digits: str) -> str:
    if len(digits) <= MOST_DIGITS:
        return digits
    return rf"{digits[:6]}\ldots_{{{len(digits)}\text{{ digits}}}}"
