"""Where triangles are measured, and what is said where a tolerance is not reached."""

from __future__ import annotations

import numpy as np

from pas.errors import MeshError
from pas.mesh.field import Field
from pas.mesh.rows import Floats

LARGEST = 4_000_000
"""Triangles; more would not fit into the memory of a small machine."""

INNER = 4
"""Points inside a triangle where its deviation is measured: the middle, and those halfway from it to the corners."""


def inner_points(corners: Floats) -> Floats:
    """The points (4 T, 3), triangle by triangle, at which triangles of corners (T, 3, 3) are compared."""
    total = corners[:, 0] + corners[:, 1] + corners[:, 2]
    result = np.empty((len(corners), INNER, 3))
    result[:, 0] = total / 3
    result[:, 1:] = (total[:, None] + 3 * corners) / 6
    return result.reshape(-1, 3)


def farthest_inside(distances: Floats) -> Floats:
    """The largest distance (T,) of each triangle, from those of its inner points (4 T,)."""
    return np.asarray(distances.reshape(-1, INNER).max(axis=1))


def too_many(field: Field, triangles: int, most: int, tolerance: float, reached: float) -> MeshError:
    """That a tolerance needs more than `most` triangles, and what is reached with some."""
    return MeshError(
        f"the tolerance {tolerance * field.scale:.3g} needs more than {most} triangles; "
        f"{reached * field.scale:.2g} is reached with {triangles}"
    )


def not_reached(field: Field, triangles: int, tolerance: float, reached: float, why: str) -> MeshError:
    """That a tolerance was not reached, and why."""
    return MeshError(
        f"the tolerance {tolerance * field.scale:g} was not reached with {triangles} triangles "
        f"({reached * field.scale:.2g} was){why}"
    )
