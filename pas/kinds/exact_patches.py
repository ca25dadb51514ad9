"""The exact rational patches of shapes with parameters, for files that hold such."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pas.parametric.conversion import bezier_patches
from pas.parametric.patches import RationalPatch
from pas.parametric.surface import ParametricSurface


def exact_patches(surface: ParametricSurface, domain: Any) -> Sequence[RationalPatch]:
    """Bezier patches that are the surface over a domain; raises `ValueError` for a surface that is not exact."""
    if not surface.is_exact:
        raise ValueError("the surface is not exact; write fit_patch(surface, tolerance) in its place")
    return bezier_patches(surface, domain)


def blend_patches(blend: Any, domain: Any) -> Sequence[RationalPatch]:
    """Those of a blend's surface."""
    return exact_patches(blend.surface, domain)
