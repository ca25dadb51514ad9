"""Expressions as people write them, made into Python's: `2y^2`, `x²`, `3(x + y)`, `f = g`.

Products may be written without a sign where only one reading is possible: a number, a bracket or a
name before a bracket or a name, and names of known letters side by side (`2xy`).  `1/2x` has two
readings and is refused.  Powers are ^, ** or raised digits; one `=` stands for a difference.

Everything is checked here, brackets and the order of numbers and signs, so that what is wrong is
named with its column in the user's text; what comes out is an expression that Python can parse.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NoReturn

from pas.errors import meant

DEEPEST = 90
"""Brackets within brackets; Python's parser takes two hundred, of which differences of equations want one."""

RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹"
SAME = {"^": "**", "\u2212": "-", "\u2013": "-", "\u00b7": "*", "\u22c5": "*", "\u00d7": "*", "\u00f7": "/", "==": "="}
"""Other signs for those of Python: minus, dash, dots, cross and division sign."""

LONGEST = 20
"""Letters of a word that is parted into names."""

SIGNS = ("+", "-", "*", "/", "**")
TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:_[0-9]+)*(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    rf"|(?P<name>[^\W\d{RAISED}][^\W{RAISED}]*)|(?P<raised>[{RAISED}]+)|(?P<sign>\*\*|==|[<>!:]=|\S)"
)


@dataclass(frozen=True)
class Token:
    """A number, name, raised number or sign, and where in the user's text it starts (from 0)."""

    kind: str
    text: str
    start: int


def python_expression(
    text: str, names: Collection[str], functions: Collection[str] = (), *, equation: bool = False
) -> str:
    """`text` as an expression of Python's grammar in known names, functions, numbers, + - * / ** and brackets.

    With `equation`, `f = g` is `f - (g)`.  Raises `ValueError` saying what is wrong and in which column.
    """
    reader = _Checker(functions, equation)
    for token in _tokens(text, tuple(names), tuple(functions)):
        reader.take(token)
    return reader.end(text)


class _Checker:
    """Takes tokens in order and writes the expression; `divided` says, by depth, whether a quotient is open."""

    def __init__(self, functions: Collection[str], equation: bool) -> None:
        self.functions, self.equation = functions, equation
        self.source: list[str] = []
        self.opened: list[int] = []
        self.divided = [False]
        self.operand = True
        self.called = False
        self.equal = False

    def take(self, token: Token) -> None:
        column = token.start + 1
        if self.called and token.text != "(":
            raise ValueError(f"the function {self.source[-1]!r} needs its argument in brackets, at column {column}")
        if not self.operand and (token.kind == "name" or token.text == "("):
            self._product(column)
        self.called = False
        if token.kind == "raised":
            self._sign("**", column)
            self._operand("".join(str(RAISED.index(digit)) for digit in token.text), column)
        elif token.kind in ("number", "name"):
            self._operand(token.text, column)
            self.called = self.operand = token.text in self.functions
        elif token.text == "(":
            self._open(token.start)
        elif token.text == ")":
            self._close(column)
        elif token.text == "=" and self.equation:
            self._equals(column)
        else:
            self._sign(token.text, column)

    def end(self, text: str) -> str:
        """The expression, all brackets closed."""
        if self.opened:
            raise ValueError(f"the bracket at column {self.opened[-1] + 1} is never closed")
        if self.operand:
            raise ValueError(f"it ends too early, after {text.rstrip()[-1]!r}")
        return "".join(self.source) + (")" if self.equal else "")

    def _operand(self, text: str, column: int) -> None:
        if not self.operand:
            raise ValueError(f"unexpected {text!r} at column {column}")
        self.source.append(text)
        self.operand = False

    def _sign(self, text: str, column: int) -> None:
        if text not in SIGNS:
            raise ValueError(f"unexpected {text!r} at column {column}")
        if self.operand and text not in "+-":
            raise ValueError(f"unexpected {'^' if text == '**' else text!r} at column {column}")
        if not self.operand and text != "**":
            self.divided[-1] = text == "/"
        self.source.append(text)
        self.operand = True

    def _product(self, column: int) -> None:
        if self.divided[-1]:
            raise ValueError(
                f"the product without a sign at column {column} can be read in two ways, since 1/2x may be (1/2)*x "
                "or 1/(2*x); write one of these"
            )
        self.source.append("*")
        self.operand = True

    def _open(self, start: int) -> None:
        if len(self.opened) == DEEPEST:
            raise ValueError(f"brackets are nested more than {DEEPEST} deep at column {start + 1}")
        self.opened.append(start)
        self.divided.append(False)
        self.source.append("(")
        self.operand = True

    def _close(self, column: int) -> None:
        if not self.opened:
            raise ValueError(f"the bracket closed at column {column} was never opened")
        if self.operand:
            raise ValueError(f"unexpected ')' at column {column}")
        self.opened.pop()
        self.divided.pop()
        self.source.append(")")

    def _equals(self, column: int) -> None:
        if self.equal or self.opened or self.operand:
            raise ValueError(f"unexpected '=' at column {column}")
        self.equal = self.operand = True
        self.divided = [False]
        self.source.append("-(")


def _tokens(text: str, names: tuple[str, ...], functions: tuple[str, ...]) -> Iterator[Token]:
    for match in TOKEN.finditer(text):
        kind, word = match.lastgroup or "sign", match.group()
        if kind == "number":
            word = re.sub(r"^0+(?=[0-9])", "", word)
        if kind != "name" or word in names or word in functions:
            yield Token(kind, SAME.get(word, word), match.start())
            continue
        start = match.start()
        for part in _letters(word, names) or _refuse(word, text[match.end() :], names, functions):
            yield Token("name", part, start)
            start += len(part)


def _refuse(word: str, after: str, names: tuple[str, ...], functions: tuple[str, ...]) -> NoReturn:
    """Raise for a name that is not known, with a guess at what was meant."""
    called = bool(functions) and after.lstrip().startswith("(")
    known = functions if called else names
    hint = meant(word, known)
    if called:
        raise ValueError(f"there is no function {word!r}" + (hint or f"; there are {', '.join(sorted(functions))}"))
    raise ValueError(f"the variable {word!r} is not one of {', '.join(names)}{hint}")


def _letters(word: str, names: tuple[str, ...]) -> tuple[str, ...] | None:
    """The known names that a word consists of, None where there is no or more than one way to part it."""
    ways = _ways(word, names) if len(word) <= LONGEST else ()
    return ways[0] if len(ways) == 1 else None


@lru_cache(maxsize=1024)
def _ways(word: str, names: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """The ways to part a word into names, two at the most."""
    if not word:
        return ((),)
    starts = [name for name in names if word.startswith(name)]
    return tuple((name, *rest) for name in starts for rest in _ways(word[len(name) :], names))[:2]
