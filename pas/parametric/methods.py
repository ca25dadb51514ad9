"""Ways of blending by name, for files and the command line.

A new way needs an entry of METHODS and nothing else: a function that makes a `ParametricBlend`, best of a class of
its own that remembers the options, so that they can be told from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pas.algebra.inputs import shown
from pas.algebra.rational import plain
from pas.parametric.blends import ParametricBlend, hermite_blend, weighted_blend
from pas.parametric.data import BlendingData


@dataclass(frozen=True)
class Method:
    """`build(data, order, **options)` makes a blend; `options_of` finds the options of one, None for another's blend.

    `options` names those that there are, with their types (`Any` for exact numbers and lists of them).
    """

    build: Callable[..., ParametricBlend]
    options: Mapping[str, Any]
    options_of: Callable[[ParametricBlend], dict[str, Any] | None]


def _hermite(blend: ParametricBlend) -> dict[str, Any] | None:
    return {} if type(blend) is ParametricBlend and blend.weights is None else None


def _weights(blend: ParametricBlend) -> dict[str, Any] | None:
    w = blend.weights
    if type(blend) is not ParametricBlend or w is None:
        return None
    return {"balance": [plain(u) for u in w.balance], "normalized": w.normalized, "exponent": w.exponent}


METHODS: dict[str, Method] = {
    "hermite": Method(hermite_blend, {}, _hermite),
    "weighted": Method(weighted_blend, {"balance": Any, "normalized": bool, "exponent": int}, _weights),
}


def blend_by(method: str, data: BlendingData, order: int, options: Mapping[str, Any]) -> ParametricBlend:
    """The blend of a method by its name; raises `ValueError` for another name or option, and what the method raises."""
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(map(repr, METHODS))}, not {shown(method)}")
    for name in options:
        if name not in METHODS[method].options:
            known = ", ".join(METHODS[method].options) or "none"
            raise ValueError(f"{name!r} is no option of the method {method!r}; its options: {known}")
    return METHODS[method].build(data, order, **options)


def method_of(blend: ParametricBlend) -> tuple[str, dict[str, Any]]:
    """The name of the method that made a blend, and its options."""
    for name, method in METHODS.items():
        options = method.options_of(blend)
        if options is not None:
            return name, options
    raise ValueError(f"no method is known that makes {blend}")
