"""Rational patches of exact surfaces and blends: what files of surfaces with parameters hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pas.exchange.formats.format import Content, Request
from pas.parametric.domain import DomainLike
from pas.parametric.patches import RationalPatch
from pas.shape import kind_of

HIGHEST_DEGREE = 25
"""In each direction: what the common kernels take."""


def patches_of(patches: Any, request: Request) -> list[RationalPatch]:
    """The patches of a patch, an exact surface or blend, or of several of these.

    A surface or a blend gives its `bezier_patches` over the request's domain.  Errors name the item by its number:
    `ValueError` for none, one that is not exact, an infinite domain, a degree above HIGHEST_DEGREE and a distance to
    sew that is not positive, `TypeError` for other things, `GeometryError` for a pole.
    """
    if request.sew is not None and not 0 < request.sew < float("inf"):
        raise ValueError(f"sew must be a positive number, not {request.sew}")
    items = list(patches) if isinstance(patches, Iterable) else [patches]
    if not items:
        raise ValueError("there must be at least one patch")
    found: list[RationalPatch] = []
    for number, item in enumerate(items):
        made = _patches(item, number, request.domain)
        highest = max((patch.degrees for patch in made), key=max)
        if max(highest) > HIGHEST_DEGREE:
            raise ValueError(
                f"patches[{number}] has the degrees {highest}, but STEP is read up to {HIGHEST_DEGREE}; "
                "write fit_patch(surface, tolerance) in its place"
            )
        found += made
    return found


def _patches(item: Any, number: int, domain: DomainLike) -> Sequence[RationalPatch]:
    kind = kind_of(item, f"patches must be RationalPatch objects, parametric surfaces or blends; patches[{number}]")
    if kind.patches is None:
        raise TypeError(
            f"patches must be RationalPatch objects, parametric surfaces or blends, not {item!r}: STEP has faces with "
            "parameters only; a solid or a piecewise algebraic surface has none; write its triangles with pas.write"
        )
    try:
        return kind.patches(item, domain)
    except ValueError as error:
        raise ValueError(f"patches[{number}]: {error}") from None


PATCHES: Content[list[RationalPatch]] = Content("patches", patches_of, ("domain", "sew"))
