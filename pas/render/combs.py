"""Curvature combs in pictures: hairs on a curve, as long as the normal curvature along it, and their envelope.

All hairs stand on the outside, where the surface does not hide them; colours tell convex from concave.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pas.algebra.monomials import Floats
from pas.errors import optional
from pas.render.scene import Comb, Layer

CONVEX, CONCAVE, NEARBY = "#b2182b", "#2166ac", "#22303c"
"""Colours of hairs by sign, as in the colours by curvature, and that of the curves they stand on."""


def hair_length(layers: Sequence[Layer]) -> float:
    """The length of a hair of curvature 1, the same for all of a scene; 0 where all curvatures are.

    95 per cent of the hairs have up to 0.16 of the surface's extent, and none more than 0.4.  Concave hairs longer than
    the radius of curvature, to whose centre they point, would cross: they have up to 0.8 of it, unless hairs would then
    be shorter than 0.4 of the usual length.
    """
    sizes = np.abs(np.concatenate([np.zeros(1), *(comb.curvatures for layer in layers for comb in layer.combs)]))
    if sizes.max() == 0:
        return 0.0
    extent = max(_extent(layer) for layer in layers if layer.combs)
    nearly = float(np.percentile(sizes, 95))
    usual = min(0.16 / nearly if nearly > 0 else np.inf, 0.4 / float(sizes.max())) * extent
    hollow = max(0.0, *(-float(comb.curvatures.min()) for layer in layers for comb in layer.combs))
    return usual if hollow == 0 else max(0.4 * usual, min(usual, 0.8 / hollow**2))


def tips(layer: Layer, factor: float) -> Floats:
    """The ends (n, 3) of a layer's hairs, which a picture must have room for."""
    return np.concatenate([np.empty((0, 3)), *(c.points + _hairs(c, factor) for c in layer.combs)])


def add_combs(plotter: Any, layer: Layer, factor: float, shift: Floats) -> None:
    """Draw a layer's combs, moved by `shift` (3,)."""
    pyvista = optional("pyvista")
    for comb in layer.combs:
        # lifted, so that the surface's triangles do not hide them
        base = comb.points + 0.002 * _extent(layer) * comb.normals + shift
        _add(plotter, pyvista.lines_from_points(base), NEARBY, 2.5)
        for sign, color in ((1, CONVEX), (-1, CONCAVE)):
            for run in _runs(comb.curvatures * sign > 0):
                places, ends = _ends(comb, base, factor, run)
                cells = np.stack([np.full(len(run), 2), np.arange(len(run)), np.arange(len(run)) + len(run)], axis=1)
                hairs = pyvista.PolyData(np.concatenate([base[run], ends[places]]), lines=cells.ravel())
                _add(plotter, hairs, color, 1.2)
                _add(plotter, pyvista.lines_from_points(ends), color, 2.5)


def _ends(comb: Comb, base: Floats, factor: float, run: Floats) -> tuple[slice, Floats]:
    """The envelope (m, 3) of a run of hairs of one sign, down to the curve where the sign changes; where they are."""
    ends = list(base[run] + _hairs(comb, factor)[run])
    first, last = int(run[0]), int(run[-1])
    before, after = (_crossing(comb, base, a, b) for a, b in ((first - 1, first), (last, last + 1)))
    places = slice(len(before), len(before) + len(ends))
    return places, np.array(before + ends + after)


def _crossing(comb: Comb, base: Floats, first: int, second: int) -> list[Floats]:
    """The point between two neighbours of other signs where the curvature vanishes, as if it were linear between."""
    if first < 0 or second >= len(base):
        return []
    a, b = comb.curvatures[[first, second]]
    return [base[first] + a / (a - b) * (base[second] - base[first])]


def _hairs(comb: Comb, factor: float) -> Floats:
    return factor * np.abs(comb.curvatures)[:, None] * comb.normals


def _runs(there: Any) -> list[Any]:
    """Runs of True, as index arrays."""
    places = np.flatnonzero(there)
    return [run for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(run)]


def _extent(layer: Layer) -> float:
    return float(np.ptp(layer.mesh.points, axis=0).max())


def _add(plotter: Any, data: Any, color: str, width: float) -> None:
    if data.n_points:
        plotter.add_mesh(data, color=color, line_width=width, lighting=False)
