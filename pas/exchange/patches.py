"""Rational patches of exact surfaces and blends: what files of surfaces with parameters hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import singledispatch
from typing import Any

from pas.exchange.formats.format import Content, Request
from pas.parametric.conversion import bezier_patches
from pas.parametric.patches import RationalPatch
from pas.parametric.surface import ParametricSurface
from pas.surface.piecewise import PiecewiseSurface

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
        found += _patches(item, request, number)
        if max(found[-1].degrees) > HIGHEST_DEGREE:
            raise ValueError(
                f"patches[{number}] has the degrees {found[-1].degrees}, but STEP is read up to {HIGHEST_DEGREE}; "
                "write fit_patch(surface, tolerance) in its place"
            )
    return found


@singledispatch
def _patches(thing: Any, request: Request, number: int) -> Sequence[RationalPatch]:
    """Of one thing, the item of that number: of the surface that it has, if it is none itself."""
    if hasattr(thing, "surface"):
        return _patches(thing.surface, request, number)
    raise TypeError(f"patches must be RationalPatch objects, parametric surfaces or parametric blends, not {thing!r}")


@_patches.register
def _(patch: RationalPatch, request: Request, number: int) -> Sequence[RationalPatch]:
    return (patch,)


@_patches.register
def _(surface: ParametricSurface, request: Request, number: int) -> Sequence[RationalPatch]:
    if not surface.is_exact:
        raise ValueError(f"patches[{number}] is not exact; write fit_patch(surface, tolerance) in its place")
    return bezier_patches(surface, request.domain)


@_patches.register
def _(surface: PiecewiseSurface, request: Request, number: int) -> Sequence[RationalPatch]:
    raise TypeError(
        "STEP has faces with parameters only, and a piecewise algebraic surface has none; write its triangles "
        "with pas.write(surface, 'name.stl') or pas.write(blend.solid(), 'name.3mf')"
    )


PATCHES: Content[list[RationalPatch]] = Content("patches", patches_of, ("domain", "sew"))
