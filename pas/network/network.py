"""Networks as scripts have them: graphs of struts that are looked into, mended, and made a body."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal, Unpack

import numpy as np

from pas.algebra.rational import Exact
from pas.limits import WorkLimits, limited
from pas.network import files, nodes, problems
from pas.network.classes import NodeClass, kinds_of
from pas.network.graph import NetworkError, NetworkProblem, StrutGraph
from pas.network.part import NetworkPart


class Network(StrutGraph):
    """A graph of struts that becomes a body of proved nodes.

    See `StrutGraph` for its arguments.

        net = pas.network.Network([(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)], [(0, 1), (0, 2), (0, 3)], "1/10")
        net.blend().mesh()
    """

    @classmethod
    def read(cls, path: str | Path, radius: Exact | None = None, grid: Exact = "1/1024") -> Network:
        """The network of a file: .npz, .csv, .obj or .3mf (see `pas.network.files`).

        The `radius` is for files that have none.  Raises `ValueError` and `ProblemFileError` naming the line.
        """
        return cls(*files.read(path, radius), grid)

    @classmethod
    def of_graph(cls, graph: Any, radius: Exact | None = None, grid: Exact = "1/1024") -> Network:
        """The network of a networkx graph: the `pos` of its nodes, the `radius` of its edges or the one that is given.

        Raises `ValueError` for a node without a place or an edge without a radius.
        """
        numbers = {node: number for number, node in enumerate(graph.nodes)}
        places = [_attribute(data, "pos", f"node {node!r}", None) for node, data in graph.nodes(data=True)]
        edges = [(numbers[a], numbers[b]) for a, b in graph.edges()]
        radii = [_attribute(data, "radius", f"edge {a!r}, {b!r}", radius) for a, b, data in graph.edges(data=True)]
        return cls(np.array(places, dtype=float).reshape(-1, 3), np.array(edges).reshape(-1, 2), radii, grid)

    def with_radius(self, radius: Exact | Sequence[Exact]) -> Network:
        """This graph with another radius, or one for each strut."""
        return Network(self.points, self.edges, radius, self.grid)

    def check(self, *, whole: bool = False) -> tuple[NetworkProblem, ...]:
        """All that is wrong with it, with the numbers of points and struts; empty where nothing is.

        Struts from a point to itself, several between two points, points in one place or without struts, angles of
        less than 10 degrees, struts too short for any blend at their ends, struts that meet no common point and come
        nearer than their radii (those of cones where they are widest); with `whole` also ends that meet nothing, and
        several pieces.
        """
        return problems.check(self, whole)

    def repair(self, *, collapse: bool | Sequence[int] = False, join: bool = False) -> tuple[Network, tuple[str, ...]]:
        """The network without what is surely a mistake, and a sentence on each change with the numbers before it.

        Struts from a point to itself go, of several between two points the thickest stays, points in one place become
        one, points without struts go.  With `collapse` struts too short for any blend at their ends become a point
        in their middle, until there are none; then the shortest between the ends of two at too small an angle, or of
        two that cross and are thicker than it is long.  Numbers of struts, such as those that `NetworkError.struts`
        offers where nodes have no blend, become points before all others.  With `join` struts that still cross end in
        a point between them, or where one of them ends, unless they would meet there at less than 10 degrees.  Raises
        `ValueError` for the number of no strut, `TypeError` for what is neither numbers nor a truth value.
        """
        return problems.repair(self, collapse, join)

    def classes(self) -> tuple[NodeClass, ...]:
        """The classes of congruent nodes, the most frequent first: struts, radii, symmetries, numbers of points."""
        return kinds_of(self).by_frequency

    @limited("blending a network", "fewer cells, or a lower order")
    def blend(
        self,
        order: int = 1,
        degree: int | Literal["lowest"] | None = None,
        *,
        wall: Exact | None = None,
        cache: str | Path | None = None,
        map: Callable[..., Any] = map,
        **limits: Unpack[WorkLimits],
    ) -> NetworkPart:
        """The body of it: a proved blend of this order for each class of nodes, and exact struts between them.

        `degree` is that of `pas.blend`.  With a `wall` (the model's units, across the struts) struts and nodes are
        hollow, and it is proved that the cavity is inside; struts that end are open tubes.  In the folder `cache`
        blends are kept as they are found, and found again by any network that has such nodes: a run that was ended goes
        on where it was.  `map(function, items)` may be the `map` of another engine, which gives results or futures in
        the order of the items, such as that of a `concurrent.futures.Executor` or of a client of Dask.

        Raises `NetworkError` for a network that `check` finds at fault, and with the points of every node for which
        there is no proved blend, `ValueError` for a wall that is not positive or not below every radius,
        `EngineLostError` where the engine ends before the work.
        """
        thick = None if wall is None else self.wall_of(wall)
        if wrong := self.check():
            raise NetworkError(wrong)
        kinds = nodes.placed_ends(self, order)
        steps = None if thick is None else thick / self.grid
        return NetworkPart.of(order, kinds, nodes.blends(kinds, order, degree, steps, cache, map), thick)

    def write(self, path: str | Path, *, unit: str | None = None) -> Path:
        """Write the graph itself: as beams (.3mf), arrays (.npz) or a table (.csv); returns the path."""
        return files.write(self, path, unit)


def _attribute(data: Any, name: str, owner: str, usual: Any) -> Any:
    value = data.get(name, usual)
    if value is None:
        raise ValueError(f"{owner} has no {name!r}; give it one" + (", or radius=" if name == "radius" else ""))
    return value
