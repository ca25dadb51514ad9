"""Combs on parametric surfaces: along lines of constant parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from pas.algebra.monomials import Floats
from pas.mesh.mesh import Mesh
from pas.parametric.curves import Forms
from pas.parametric.domain import Domain
from pas.parametric.surface import ParametricSurface
from pas.render.layers import Comb

SAMPLES = 90
"""Points of a curve."""

ACROSS, BETWEEN = 6, 3
"""Curves from one contact to the other, and curves each way of a surface that has no contacts."""

Line = tuple[Floats, Floats]
"""The parameters of a curve's first and last point, (2,) each."""


def surface_curves(domain: Domain) -> list[Line]:
    """The borders of a finite domain and the lines in their middle, each way."""
    (a, b), (c, d) = domain
    first = [(np.array([t, c]), np.array([t, d])) for t in np.linspace(a, b, BETWEEN)]
    return first + [(np.array([a, h]), np.array([b, h])) for h in np.linspace(c, d, BETWEEN)]


def blend_curves(domain: Domain, values: Sequence[float], closed: bool = False) -> list[Line]:
    """The contact curves, which are lines of the second parameter's `values`, and some lines across them.

    `closed`: the first and last line across are one.
    """
    (a, b), (c, d) = domain
    across = np.linspace(a, b, ACROSS, endpoint=not closed)
    contacts = [(np.array([a, h]), np.array([b, h])) for h in values if c <= h <= d]
    return contacts + [(np.array([t, c]), np.array([t, d])) for t in across]


def combs_on(surface: ParametricSurface, curves: Sequence[Line], mesh: Mesh) -> tuple[Comb, ...]:
    """Combs along curves that are straight in the parameters, without places where there is no curvature.

    They are on the side of the surface to which the normals of its `mesh` point.
    """
    combs, tree = [], cKDTree(mesh.points)
    for start, end in curves:
        places = start + np.linspace(0, 1, SAMPLES)[:, None] * (end - start)
        forms = Forms.at(surface, places)
        curvatures, points = forms.along(end - start), surface(places)
        known = np.isfinite(curvatures) & np.isfinite(points).all(axis=1)
        if known.sum() < 2:
            continue
        points, normals, curvatures = points[known], forms.normals[known], curvatures[known]
        side = 1.0 if (mesh.point_normals[tree.query(points)[1]] * normals).sum() >= 0 else -1.0
        combs.append(Comb(points, side * normals, side * curvatures))
    return tuple(combs)
