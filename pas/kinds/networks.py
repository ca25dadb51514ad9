"""Bodies of networks as a kind of shapes: the graph, where its clips are, and the blends of its classes of nodes.

On reading, kinds and classes of nodes and their ends are found anew; blends are those of the file, proved anew when
their verdicts are asked for.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pas.algebra.rational import rational, to_fraction
from pas.exchange.schema import NUMBER, WHOLE, Table, list_of
from pas.kinds.piecewise import BLEND
from pas.network.network import Network
from pas.network.nodes import matched, placed_ends
from pas.network.part import NetworkPart
from pas.pipeline.hollow import HollowBlend
from pas.render.scene import solid_layers
from pas.shape import Kind


def _graph(thing: NetworkPart) -> dict[str, Any]:
    network = thing.network
    return {
        "grid": network.grid,
        "points": network.places.tolist(),
        "edges": network.edges.tolist(),
        "radii": network.radii,
        "sizes": network.sizes[:, : 2 - network.even].ravel().tolist(),
        "order": thing.order,
        "blends": list(thing.blends.values()),
        **({} if thing.wall is None else {"wall": thing.wall, "inner": [h.inner for h in thing.hollow.values()]}),
    }


def _part(
    grid: str,
    points: Any,
    edges: Any,
    radii: Any,
    sizes: Any,
    order: int,
    blends: Any,
    wall: Any = None,
    inner: Any = (),
) -> NetworkPart:
    """The part of a file; raises `ValueError` where the blends are not those of its nodes."""
    if len(sizes) not in (len(edges), 2 * len(edges)) or not all(0 <= size < len(radii) for size in sizes):
        raise ValueError("sizes must say of each strut which of the radii it has, or which at both ends")
    both = np.array(sizes).reshape(len(edges), -1)[:, [0, -1]].tolist() if edges else []
    places = np.array(points, dtype=float).reshape(-1, 3) * float(to_fraction(rational(grid, "grid")))
    network = Network(places, np.array(edges).reshape(-1, 2), [(radii[a], radii[b]) for a, b in both], grid)
    kinds = placed_ends(network, order)
    thick = None if wall is None else network.wall_of(wall)
    if len(inner) != (0 if thick is None else len(blends)):
        raise ValueError("inner must have the cavity of each blend of a network with a wall, and none without one")
    found = blends if thick is None else [HollowBlend(a, b) for a, b in zip(blends, inner, strict=True)]
    steps = None if thick is None else thick / network.grid
    return NetworkPart.of(order, kinds, matched(kinds, order, found, steps), thick)


NETWORK = Kind(
    "network",
    NetworkPart,
    Table(
        {
            "grid": NUMBER,
            "points": list_of(list_of(WHOLE, 3)),
            "edges": list_of(list_of(WHOLE, 2)),
            "radii": list_of(NUMBER),
            "sizes": list_of(WHOLE),
            "order": WHOLE,
            "blends": list_of(BLEND.form),
        },
        {"wall": NUMBER, "inner": list_of(BLEND.form)},
        make=_part,
        entries=_graph,
    ),
    solid_layers,
    placed=NetworkPart.bodies,
)
