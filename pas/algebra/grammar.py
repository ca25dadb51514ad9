"""The one grammar of expressions, as people write them: `2y^2`, `x²`, `3(x + y)`, `f = g`.

Products may be written without a sign where only one reading is possible: a number, a bracket or a
name before a bracket or a name, and names of known letters side by side (`2xy`).  `1/2x` has two
readings and is refused.  Powers are ^, ** or raised digits; one `=` stands for a difference.

What is wrong is named with its column in the user's text.  What comes out is a list of steps for a
machine with a stack (Dijkstra 1961), which `run` works off in values of any kind: nothing nests, so
no expression is too deep, on whatever Python.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NoReturn, Protocol, TypeVar

from flint import fmpq

from pas.algebra.inputs import check_text, short, shown
from pas.algebra.rational import read_number
from pas.errors import meant

V = TypeVar("V")

ZERO = fmpq(0)

DEEPEST = 90
"""Brackets within brackets, beyond what anybody writes."""

MOST_SUMMANDS = 3000
"""Terms of one sum: all those of degree 24 are 2925.  Sums of fractions take time with the square of their number."""

RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹"
SAME = {"^": "**", "\u2212": "-", "\u2013": "-", "\u00b7": "*", "\u22c5": "*", "\u00d7": "*", "\u00f7": "/", "==": "="}
"""Other signs for those of Python: minus, dash, dots, cross and division sign."""

LONGEST = 20
"""Letters of a word that is parted into names."""

RANKS = {"(": 0, "+": 1, "-": 1, "*": 2, "/": 2, "negative": 3, "**": 4}
"""Which operator is done first: the higher; -x^2 is -(x^2)."""

TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:_[0-9]+)*(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    rf"|(?P<name>[^\W\d{RAISED}][^\W{RAISED}]*)|(?P<raised>[{RAISED}]+)|(?P<sign>\*\*|==|[<>!:]=|\S)"
)


@dataclass(frozen=True)
class Token:
    """A number, name, raised number or sign, and where in the user's text it stands (from 0)."""

    kind: str
    text: str
    start: int
    end: int


@dataclass(frozen=True)
class Step:
    """One step of the machine: `action` is "number", "name", "negative", "call" or a sign."""

    action: str
    text: str
    source: str
    start: int
    end: int
    value: fmpq = ZERO

    @property
    def written(self) -> str:
        """The part of the user's text that this step completes, shortened, in quotes."""
        return shown(self.source[self.start : self.end])


class Values(Protocol[V]):
    """Values of one kind, in which an expression is worked out; `ValueError` says what a kind cannot do."""

    def number(self, value: fmpq) -> V: ...
    def name(self, name: str, /) -> V: ...
    def negative(self, value: V) -> V: ...
    def combine(self, step: Step, left: V, right: V) -> V:
        """left + - * / ** right; `step.action` is the sign."""

    def call(self, name: str, argument: V) -> V: ...


def steps(
    text: str, names: Collection[str], functions: Collection[str] = (), *, equation: bool = False
) -> tuple[Step, ...]:
    """The steps of an expression in known names, functions, numbers, + - * / ^ and brackets.

    With `equation`, `f = g` is `f - (g)`.  Raises `ValueError` saying what is wrong and in which column.
    """
    reader = _ShuntingYard(check_text(text), functions, equation)
    for token in _tokens(text, tuple(names), tuple(functions)):
        reader.take(token)
    return reader.end()


def run(program: Sequence[Step], values: Values[V]) -> V:
    """The value of an expression."""
    stack: list[V] = []
    for step in program:
        if step.action == "number":
            stack.append(values.number(step.value))
        elif step.action == "name":
            stack.append(values.name(step.text))
        elif step.action == "negative":
            stack.append(values.negative(stack.pop()))
        elif step.action == "call":
            stack.append(values.call(step.text, stack.pop()))
        else:
            right = stack.pop()
            stack.append(values.combine(step, stack.pop(), right))
    return stack.pop()


@dataclass
class _Bracket:
    """An open bracket, side of an equation or whole text; where it is, and which function it belongs to."""

    start: int
    function: Token | None = None
    divided: bool = False
    terms: int = 1


class _ShuntingYard:
    """Takes tokens in order; `waiting` holds signs whose right side is being read, `spans` where operands stand."""

    def __init__(self, text: str, functions: Collection[str], equation: bool) -> None:
        self.text, self.functions, self.equation = text, functions, equation
        self.program: list[Step] = []
        self.waiting: list[tuple[str, int]] = []
        self.spans: list[tuple[int, int]] = []
        self.opened = [_Bracket(0)]
        self.operand = True
        self.called: Token | None = None
        self.equal = False

    def take(self, token: Token) -> None:
        column = token.start + 1
        if self.called and token.text != "(":
            raise ValueError(f"the function {self.called.text!r} needs its argument in brackets, at column {column}")
        if not self.operand and (token.kind == "name" or token.text == "("):
            self._product(token.start)
        if token.kind == "raised":
            self._sign("**", token.start)
            self._operand("number", "".join(str(RAISED.index(digit)) for digit in token.text), token)
        elif token.text in self.functions:
            self.called = token
        elif token.kind in ("number", "name"):
            self._operand(token.kind, token.text, token)
        elif token.text == "(":
            self._open(token.start)
        elif token.text == ")":
            self._close(token.start)
        elif token.text == "=" and self.equation:
            self._equals(token.start)
        else:
            self._sign(token.text, token.start)

    def end(self) -> tuple[Step, ...]:
        """The steps, all brackets closed."""
        if len(self.opened) > 1:
            raise ValueError(f"the bracket at column {self.opened[-1].start + 1} is never closed")
        if self.operand:
            raise ValueError(f"it ends too early, after {self.text.rstrip()[-1]!r}")
        self._finish(0)
        if self.equal:
            self.waiting[-1] = ("-", 0)
            self._finish(0)
        return tuple(self.program)

    def _operand(self, kind: str, text: str, token: Token) -> None:
        if not self.operand:
            raise ValueError(f"unexpected {text!r} at column {token.start + 1}")
        self.operand = False
        self._step(kind, text, token.start, token.end)

    def _step(self, action: str, text: str, start: int, end: int) -> None:
        self.spans.append((start, end))
        try:
            value = read_number(text) if action == "number" else ZERO
        except ValueError as error:
            raise ValueError(f"the number {shown(text)} {error}") from None
        self.program.append(Step(action, text, self.text, start, end, value))

    def _sign(self, text: str, start: int) -> None:
        if text not in RANKS or (self.operand and text not in "+-"):
            raise ValueError(f"unexpected {'^' if text == '**' else text!r} at column {start + 1}")
        if self.operand:
            if text == "-":
                self.waiting.append(("negative", start))
            return
        if text in "+-":
            self.opened[-1].terms += 1
            if self.opened[-1].terms > MOST_SUMMANDS:
                raise ValueError(f"a sum has more than {MOST_SUMMANDS} terms")
        if text != "**":
            self.opened[-1].divided = text == "/"
            self._finish(RANKS[text])
        self.waiting.append((text, start))
        self.operand = True

    def _finish(self, rank: int) -> None:
        """Complete waiting operations in this bracket that bind before a sign of this rank to their right."""
        while self.waiting and RANKS[self.waiting[-1][0]] >= max(rank, 1):
            sign, start = self.waiting.pop()
            _, end = self.spans.pop()
            if sign != "negative":
                start, _ = self.spans.pop()
            self._step(sign, sign, start, end)

    def _product(self, start: int) -> None:
        if self.opened[-1].divided:
            raise ValueError(
                f"the product without a sign at column {start + 1} can be read in two ways, since 1/2x may be (1/2)*x "
                "or 1/(2*x); write one of these"
            )
        self._finish(RANKS["*"])
        self.waiting.append(("*", start))
        self.operand = True

    def _open(self, start: int) -> None:
        if len(self.opened) > DEEPEST:
            raise ValueError(f"brackets are nested more than {DEEPEST} deep at column {start + 1}")
        self.opened.append(_Bracket(start, self.called))
        self.waiting.append(("(", start))
        self.operand, self.called = True, None

    def _close(self, start: int) -> None:
        if len(self.opened) == 1:
            raise ValueError(f"the bracket closed at column {start + 1} was never opened")
        if self.operand:
            raise ValueError(f"unexpected ')' at column {start + 1}")
        self._finish(0)
        self.waiting.pop()
        self.spans.pop()
        bracket = self.opened.pop()
        if bracket.function is None:
            self.spans.append((bracket.start, start + 1))
        else:
            self._step("call", bracket.function.text, bracket.function.start, start + 1)

    def _equals(self, start: int) -> None:
        if self.equal or len(self.opened) > 1 or self.operand:
            raise ValueError(f"unexpected '=' at column {start + 1}")
        self._finish(0)
        self.waiting.append(("(", start))
        self.opened = [_Bracket(0)]
        self.equal = self.operand = True


def _tokens(text: str, names: tuple[str, ...], functions: tuple[str, ...]) -> Iterator[Token]:
    for match in TOKEN.finditer(text):
        kind, word = match.lastgroup or "sign", match.group()
        if kind != "name" or word in names or word in functions:
            yield Token(kind, SAME.get(word, word), match.start(), match.end())
            continue
        start = match.start()
        for part in _letters(word, names) or _refuse(word, text[match.end() :], names, functions):
            yield Token("name", part, start, start + len(part))
            start += len(part)


def _refuse(word: str, after: str, names: tuple[str, ...], functions: tuple[str, ...]) -> NoReturn:
    """Raise for a name that is not known, with a guess at what was meant."""
    called = bool(functions) and after.lstrip().startswith("(")
    known = functions if called else names
    hint = meant(word, known)
    if called:
        raise ValueError(f"there is no function {word!r}" + (hint or f"; there are {', '.join(sorted(functions))}"))
    raise ValueError(f"the variable {shown(word)} is not one of {short(', '.join(names))}{hint}")


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
