"""Curvatures of parametric surfaces at parameters, from their first and second derivatives.

With P_t, P_h and the normal N = P_t x P_h / |P_t x P_h|, the first form I = [P_i . P_j] and the second one
II = -[P_ij . N], whose sign is that of a ball with its normals outwards: the principal curvatures are the eigenvalues
of I^-1 II, and the normal curvature in a direction u is II(u, u) / I(u, u) (do Carmo 1976, chapter 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pas.algebra.monomials import Floats
from pas.parametric.surface import ParametricSurface

FLAT = 1e-12
"""Where the normal is shorter, over the tangents, there is no curvature."""


@dataclass(frozen=True)
class Forms:
    """First and second forms (N, 2, 2) and unit normals (N, 3) of a surface at N places; nan at poles."""

    first: Floats
    second: Floats
    normals: Floats

    @classmethod
    def at(cls, surface: ParametricSurface, parameters: Floats) -> Forms:
        """The forms at parameters (N, 2)."""
        p, q = (surface.derivative(parameters, *orders) for orders in ((1, 0), (0, 1)))
        bends = [surface.derivative(parameters, *orders) for orders in ((2, 0), (1, 1), (0, 2))]
        cross = np.cross(p, q)
        length = np.linalg.norm(cross, axis=-1)
        sizes = np.linalg.norm(p, axis=-1) * np.linalg.norm(q, axis=-1)
        with np.errstate(all="ignore"):
            normals = cross / np.where(length > FLAT * sizes, length, np.nan)[:, None]
        first = _symmetric(*((u * v).sum(axis=-1) for u, v in ((p, p), (p, q), (q, q))))
        return cls(first, _symmetric(*(-(b * normals).sum(axis=-1) for b in bends)), normals)

    @property
    def principal(self) -> Floats:
        """Principal curvatures (N, 2), the larger first, positive where it bends like a ball with normals outwards."""
        (a, b, c), (e, f, g) = ((m[:, 0, 0], m[:, 0, 1], m[:, 1, 1]) for m in (self.first, self.second))
        with np.errstate(all="ignore"):
            area = a * c - b * b
            mean = (e * c - 2 * f * b + g * a) / (2 * area)
            gauss = (e * g - f * f) / area
            half = np.sqrt(np.maximum(mean * mean - gauss, 0.0))
        return np.stack([mean + half, mean - half], axis=1)

    def along(self, directions: Floats) -> Floats:
        """Normal curvatures (N,) in directions (2,) or (N, 2) of the parameters."""
        ways = np.broadcast_to(directions, (len(self.normals), 2))
        with np.errstate(all="ignore"):
            above, below = (np.einsum("ni,nij,nj->n", ways, form, ways) for form in (self.second, self.first))
            return np.asarray(above / below)

    def principal_for(self, normals: Floats) -> Floats:
        """`principal` as seen from the side to which `normals` (N, 3) point."""
        turned = (self.normals * normals).sum(axis=1) < 0
        return np.where(turned[:, None], -self.principal[:, ::-1], self.principal)


def _symmetric(a: Floats, b: Floats, c: Floats) -> Floats:
    return np.stack([np.stack([a, b], axis=-1), np.stack([b, c], axis=-1)], axis=-2)
