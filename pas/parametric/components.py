"""Three components of a surface: their evaluation, and as expressions that can be saved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pas.algebra.callables import Values
from pas.algebra.expressions import as_text
from pas.algebra.horner import Bundle
from pas.algebra.rational import Vector, plain
from pas.algebra.rational_function import RationalFunction

Components = tuple[RationalFunction, RationalFunction, RationalFunction]


def bundle_values(components: Callable[[], Components]) -> Values:
    """Evaluation of exact components as they stand, prepared when first asked for."""
    made: list[Bundle] = []

    def values(t: Any, h: Any) -> tuple[Any, ...]:
        if not made:
            made.append(Bundle.of_pairs([(c.numerator, c.denominator) for c in components()]))
        return made[0].quotients(t, h)

    return values


def text_of(expressions: Sequence[Any]) -> tuple[str, str, str] | None:
    """The expressions as strings; None where one is a callable."""
    found: list[Any] = [as_text(e) if hasattr(e, "free_symbols") or isinstance(e, str) else e for e in expressions]
    if any(callable(e) and not isinstance(e, RationalFunction) for e in found):
        return None
    x, y, z = (e if isinstance(e, str) else str(RationalFunction(e)) for e in found)
    return x, y, z


def moved_text(text: Sequence[str], rows: Sequence[Vector], shift: Vector) -> tuple[str, str, str]:
    """The expressions after p -> rows p + shift."""
    x, y, z = (
        " + ".join([*(f"({plain(c)})*({e})" for c, e in zip(row, text, strict=True)), f"({plain(s)})"])
        for row, s in zip(rows, shift, strict=True)
    )
    return x, y, z
