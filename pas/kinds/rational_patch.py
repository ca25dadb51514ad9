"""Rational patches as a kind of shape: control points, weights and knots, and what they stand for exactly."""

from __future__ import annotations

from typing import Any

import numpy as np

from pas.algebra.rational import plain, rational, to_fraction
from pas.exchange.schema import NUMBER, REAL, List, Maybe, Table
from pas.exchange.shapes import POINT
from pas.mesh.mesh import Mesh
from pas.parametric.patches import ExactControl, RationalPatch
from pas.render.parametric import surface_layers
from pas.render.scene import Scene
from pas.shape import Kind
from pas.verdicts import Verdicts

EXACT = Table({"points": List(List(POINT)), "weights": List(List(NUMBER)), "rectangle": List(List(NUMBER, 2), 2)})
CONTENT = Table(
    {
        "points": List(List(List(REAL, 3))),
        "weights": List(List(REAL)),
        "knots": List(List(REAL), 2),
        "exact": Maybe(EXACT),
    }
)


def record(patch: RationalPatch, _: Verdicts | None = None) -> dict[str, Any]:
    """Everything that defines a patch: doubles and, where they are known, the fractions that they stand for."""
    exact = patch.exact
    names = ("points", "weights", "rectangle")
    return {
        "points": patch.points.tolist(),
        "weights": patch.weights.tolist(),
        "knots": [knots.tolist() for knots in patch.knots],
        "exact": None if exact is None else {n: _texts(getattr(exact, n)) for n in names},
    }


def read(content: dict[str, Any]) -> RationalPatch:
    """The patch of `record`."""
    u, v = (np.array(knots, dtype=float) for knots in content["knots"])
    kept = content["exact"]
    exact = None if kept is None else ExactControl(*(_fractions(kept[n]) for n in ("points", "weights", "rectangle")))
    points, weights = (_array(content[name], name, float) for name in ("points", "weights"))
    patch = RationalPatch(points, weights, (u, v), exact)
    if exact is not None:
        _check_rounded(patch, exact)
    return patch


def _check_rounded(patch: RationalPatch, exact: ExactControl) -> None:
    """Raises `ValueError` unless the doubles of a patch are those nearest to its fractions."""
    if exact.points.shape != patch.points.shape or exact.weights.shape != patch.weights.shape:
        raise ValueError("the exact control points and weights must be as many as the rounded ones")
    pairs = {
        "points": (exact.points, patch.points),
        "weights": (exact.weights, patch.weights),
        "rectangle": (exact.rectangle, np.array(patch.domain)),
    }
    for name, (fractions, doubles) in pairs.items():
        if not np.array_equal(fractions.astype(float), doubles):
            ends = "ends of the knots" if name == "rectangle" else name
            raise ValueError(f"exact.{name} must be what the {ends} are rounded from, and they are others")


def _texts(numbers: Any) -> Any:
    if np.ndim(numbers):
        return [_texts(part) for part in numbers]
    return plain(rational(numbers))


def _fractions(texts: Any) -> Any:
    def read_all(part: Any) -> Any:
        return [read_all(p) for p in part] if isinstance(part, list) else to_fraction(rational(part))

    return _array(read_all(texts), "exact", object)


def _array(rows: Any, name: str, number: type) -> Any:
    if len({len(row) for row in rows}) != 1:
        raise ValueError(f"the rows of {name} must be equally long")
    return np.array(rows, dtype=number)


def _layers(patch: RationalPatch, scene: Scene) -> None:
    surface_layers(patch.surface(), scene)


def mesh(patch: RationalPatch, tolerance: Any, domain: Any) -> Mesh:
    """The mesh over a domain."""
    return patch.surface().mesh(tolerance, domain)


def patches(patch: RationalPatch, domain: Any) -> tuple[RationalPatch]:
    """The patch itself, whatever the domain of others."""
    return (patch,)


PATCH = Kind("rational patch", RationalPatch, CONTENT, record, read, _layers, mesh=mesh, patches=patches, curved=True)
