"""Piecewise surfaces for pictures: the surface, and the neighbours that it continues."""

from __future__ import annotations

import numpy as np

from pas.algebra.monomials import Floats
from pas.algebra.rational import to_float
from pas.piecewise import PiecewiseSurface
from pas.render.neighbours import neighbours
from pas.render.scene import BLEND_COLOR, PIPE_COLOR, Layer, Scene
from pas.render.sections import combs, geometry_at
from pas.surface.fairness_limits import neighbour

VIEW = (0.62, -0.62, 0.48)
"""From where one looks, in the frame of the contact directions: past the pipes, from above."""


def layers(surface: PiecewiseSurface, scene: Scene) -> None:
    """Add the surface and its neighbours; raises `MeshError` where it has no region."""
    extent = float(np.ptp(surface.partition.points, axis=0).max()) if len(surface.partition.points) else 1.0
    tolerance = scene.picture.tolerance or extent * scene.coloring.tolerance
    mesh = scene.mesh(lambda: surface.mesh(tolerance))
    scene.look(VIEW, _frame(surface))
    scene.layers.append(
        Layer(
            mesh,
            BLEND_COLOR,
            principal=lambda: principal_curvatures(surface, mesh.points),
            unit=sharpest_neighbour(surface) if scene.picture.curved else None,
            combs=combs(surface, mesh) if scene.picture.combs else (),
            outlined=True,
        )
    )
    scene.layers += [Layer(other, PIPE_COLOR, aside=True) for other in neighbours(surface, mesh, extent / 4)]


def principal_curvatures(surface: PiecewiseSurface, points: Floats) -> Floats:
    """Principal curvatures (N, 2) at surface points (N, 3), the larger first: those of the polynomials."""
    return geometry_at(surface, points)[1].principal / to_float(surface.partition.frame.scale)


def sharpest_neighbour(surface: PiecewiseSurface) -> float | None:
    """The largest |principal curvature| of the contacts' surfaces on their curves; None where all are flat there."""
    scale = to_float(surface.partition.frame.scale)
    found = [neighbour(join, scale).curvature for join in surface.joins if np.isfinite(join.radius)]
    most = max(found, default=0.0)
    return most if most * scale > 1e-9 else None  # which rounding alone would make


def _frame(surface: PiecewiseSurface) -> Floats:
    """Unit directions towards the first contacts, completed to a frame by the axes."""
    rows = [c.scaled.clip.gradient(np.zeros(3)) for c in surface.contacts] + list(np.eye(3))
    frame: list[Floats] = []
    for row in rows:
        rest = np.array(row, dtype=float)
        for known in frame:
            rest = rest - (rest @ known) * known
        if np.linalg.norm(rest) > 1e-6 * max(float(np.linalg.norm(row)), 1e-300) and len(frame) < 3:
            frame.append(rest / np.linalg.norm(rest))
    return np.array(frame)
