"""Rational patches of exact surfaces and blends: what files of surfaces with parameters hold."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pas.exchange.formats.format import Content, Request
from pas.generatrix.blend import GeneratrixBlend
from pas.parametric.blends import ParametricBlend
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
        surface = item.surface if isinstance(item, ParametricBlend | GeneratrixBlend) else item
        if isinstance(surface, ParametricSurface) and not surface.is_exact:
            raise ValueError(f"patches[{number}] is not exact; write fit_patch(surface, tolerance) in its place")
        if isinstance(surface, ParametricSurface):
            found += bezier_patches(surface, request.domain)
        elif isinstance(surface, RationalPatch):
            found.append(surface)
        else:
            raise TypeError(_refusal(item))
        if max(found[-1].degrees) > HIGHEST_DEGREE:
            raise ValueError(
                f"patches[{number}] has the degrees {found[-1].degrees}, but STEP is read up to {HIGHEST_DEGREE}; "
                "write fit_patch(surface, tolerance) in its place"
            )
    return found


def _refusal(item: Any) -> str:
    if isinstance(getattr(item, "surface", item), PiecewiseSurface):
        return (
            "STEP has faces with parameters only, and a piecewise algebraic surface has none; write its triangles "
            "with pas.write_mesh(surface.mesh(), 'name.stl') or pas.write_solid(blend.solid(), 'name.3mf')"
        )
    return f"patches must be RationalPatch objects, parametric surfaces or parametric blends, not {item!r}"


PATCHES: Content[list[RationalPatch]] = Content("patches", patches_of, ("domain", "sew"))
