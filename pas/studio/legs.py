"""What the page needs to draw a blend by a generatrix for other shape values by itself.

Control points are C + l (sqrt(1 - lambda^2) W + lambda E): only l and lambda change while they are dragged, so that the
curves, their vectors and the derivatives of these are sent once (see `pas.parametric.generatrix.frames`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pas.shape import Shape, kind_of
from pas.studio.controls import SHAPE

if TYPE_CHECKING:
    from pas.parametric.generatrix.blend import GeneratrixBlend

SIZE = (120, 40)
"""Points in s and t of what is drawn while a value is dragged."""


def legs(shape: Shape) -> tuple[dict[str, Any], dict[str, Any]]:
    """An entry for the head and an array; empty for other kinds of shapes and where shape values are functions of s.

    The array has, in rows of `SIZE[0]` points, for both curves C, C', W, W', E, E', then the middle curve and
    its derivative where there is one.
    """
    find = kind_of(shape).generatrix
    if find is None:
        return {}, {}
    blend: GeneratrixBlend = find(shape)
    functions = {name: getattr(blend.shape, name) for name in SHAPE}
    values = {name: function.value for name, function in functions.items() if function is not None}
    if len(values) < len(SHAPE) or None in values.values():
        return {}, {}
    _, edges, middles = blend.frames.grid(SIZE[0])
    rows = [part for e in edges for part in (e.point, e.velocity, *e.across, *e.along)] + list(middles or ())
    head = {
        "size": SIZE,
        "closed": blend.closed,
        "inward": blend.frames.inward,
        "values": {name: float(value) for name, value in values.items()},
    }
    return {"legs": head}, {"legs": np.stack(rows).astype(np.float64)}
