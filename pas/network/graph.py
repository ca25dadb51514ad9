"""Graphs of points and struts with radii, on an exact grid, and what is wrong with them.

Points are whole multiples of the grid, so that directions of struts are exact vectors: nodes are the same, up to a
rotation or reflection, where these are, which is decided exactly (`pas.network.classes`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np

from pas.algebra.inputs import shown, whole
from pas.algebra.monomials import Floats
from pas.algebra.rational import Exact, positive, to_fraction
from pas.errors import GeometryError
from pas.limits import WorkLimits, limited
from pas.mesh.rows import Integers
from pas.registry import loaded

if TYPE_CHECKING:
    from pas.network.nodes import NodeClass
    from pas.network.part import NetworkPart

LARGEST = 2**20
"""Components of a strut in the grid: their products in three factors fit into 64 bits with their sums."""

Table = np.ndarray


@dataclass(frozen=True)
class Problem:
    """What is wrong with a network: the kind in a word or two, the numbers of its points or struts, and a sentence."""

    kind: str
    ids: tuple[int, ...]
    sentence: str

    def __str__(self) -> str:
        return self.sentence


class NetworkError(GeometryError):
    """A network that cannot be made; `problems` has all that was found, with the numbers of points and struts."""

    MOST_TOLD = 5

    def __init__(self, problems: Sequence[Problem]) -> None:
        told = [str(problem) for problem in problems[: self.MOST_TOLD]]
        if more := len(problems) - len(told):
            told.append(f"and {more} more, see network.check()")
        super().__init__("; ".join(told))
        self.problems = tuple(problems)


@dataclass(frozen=True, eq=False, repr=False)
class Network:
    """Points, struts between them, and the radii of these.

    `points` (N, 3) are rounded to multiples of the `grid` (the model's units), `edges` (E, 2) are numbers of points,
    `radii` one exact number or one for each strut.  `places` (N, 3) are the points as whole numbers of the grid;
    `sizes` (E,) says which of the different radii `radii` each strut has.

    Raises `ValueError` for arrays of other shapes, numbers of points that do not exist, radii that are not positive,
    a grid that is not positive or so fine that a strut is longer than 2^20 of its steps; `TypeError` for what are no
    numbers.
    """

    points: Floats
    edges: Integers
    radii: Any
    grid: Any = "1/1024"

    def __post_init__(self) -> None:
        grid = to_fraction(positive(self.grid, "grid"))
        places, edges = _places(self.points, grid), _edges(self.edges)
        if len(edges) and not 0 <= edges.min() <= edges.max() < len(places):
            raise ValueError(f"edges must be numbers of the {len(places)} points, from 0 on; {edges.max()} is none")
        values, sizes = _radii(self.radii, len(edges))
        longest = int(np.abs(places[edges[:, 1]] - places[edges[:, 0]]).max(initial=0))
        if longest >= LARGEST:
            raise ValueError(f"the grid {grid} is too fine: a strut is {longest} steps long, and {LARGEST} is the most")
        own = {"grid": grid, "points": places * float(grid), "edges": edges, "radii": values}
        for name, value in {**own, "places": places, "sizes": sizes}.items():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
            object.__setattr__(self, name, value)

    if TYPE_CHECKING:
        places: Integers
        sizes: Integers

    @classmethod
    def read(cls, path: str | Path, radius: Exact | None = None, grid: Exact = "1/1024") -> Network:
        """The network of a file: .npz, .csv, .obj or .3mf (see `pas.exchange.networks`).

        The `radius` is for files that have none.  Raises `ValueError` and `ProblemFileError` naming the line.
        """
        return loaded("pas.exchange.networks:read")(path, radius, grid)

    @classmethod
    def of_graph(cls, graph: Any, radius: Exact | None = None, grid: Exact = "1/1024") -> Network:
        """That of a networkx graph: the `pos` of its nodes, the `radius` of its edges or the one that is given.

        Raises `ValueError` for a node without a place or an edge without a radius.
        """
        numbers = {node: number for number, node in enumerate(graph.nodes)}
        places = [_attribute(data, "pos", f"node {node!r}", None) for node, data in graph.nodes(data=True)]
        edges = [(numbers[a], numbers[b]) for a, b in graph.edges()]
        radii = [_attribute(data, "radius", f"edge {a!r}, {b!r}", radius) for a, b, data in graph.edges(data=True)]
        return cls(np.array(places, dtype=float).reshape(-1, 3), np.array(edges).reshape(-1, 2), radii, grid)

    def with_radius(self, radius: Exact | Sequence[Exact]) -> Network:
        """The same graph with another radius, or one for each strut."""
        return Network(self.points, self.edges, radius, self.grid)

    @cached_property
    def vectors(self) -> Integers:
        """Of each strut, from its first point to its second (E, 3), in steps of the grid."""
        return np.asarray(self.places[self.edges[:, 1]] - self.places[self.edges[:, 0]])

    @cached_property
    def lengths(self) -> Floats:
        """Of the struts (E,), in the model's units."""
        return np.asarray(np.linalg.norm(self.vectors, axis=1) * float(self.grid))

    @cached_property
    def thickness(self) -> Floats:
        """The radius of each strut (E,), in the model's units."""
        return np.array([float(r) for r in self.radii])[self.sizes] if len(self.edges) else np.zeros(0)

    @cached_property
    def valence(self) -> Integers:
        """The number of struts at each point (N,)."""
        return np.bincount(self.edges.ravel(), minlength=len(self.places))

    @property
    def pieces(self) -> int:
        """The number of connected pieces of the graph, points without struts left out."""
        return len(np.unique(self.components[self.edges[:, 0]]))

    @cached_property
    def components(self) -> Integers:
        """The number of the connected piece of each point (N,)."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        ones, count = np.ones(len(self.edges)), len(self.places)
        return np.asarray(connected_components(coo_array((ones, tuple(self.edges.T)), shape=(count, count)))[1])

    def check(self, *, whole: bool = False) -> tuple[Problem, ...]:
        """All that is wrong with it, with the numbers of points and struts; empty where nothing is.

        Struts from a point to itself, several between two points, points in one place or without struts, angles of
        less than 10 degrees, struts too short for any blend at their ends, struts that meet no common point and come
        nearer than their radii; with `whole` also ends that meet nothing, and several pieces.
        """
        found: tuple[Problem, ...] = loaded("pas.network.problems:check")(self, whole)
        return found

    def repair(self, *, collapse: bool = False) -> tuple[Network, tuple[str, ...]]:
        """The network without what is surely a mistake, and a sentence on each change with the numbers before it.

        Struts from a point to itself go, of several between two points the thickest stays, points in one place become
        one, points without struts go.  With `collapse` struts too short for any blend at their ends become a point
        in their middle, until there are none.
        """
        done: tuple[Network, tuple[str, ...]] = loaded("pas.network.problems:repair")(self, collapse)
        return done

    def classes(self) -> tuple[NodeClass, ...]:
        """The classes of congruent nodes, the most frequent first: struts, radii, symmetries, numbers of points."""
        found: tuple[NodeClass, ...] = loaded("pas.network.nodes:classes")(self)
        return found

    @limited("blending a network", "fewer cells, or a lower order")
    def blend(
        self,
        order: int = 1,
        degree: int | Literal["lowest"] | None = None,
        *,
        cache: str | Path | None = None,
        map: Callable[..., Any] = map,
        **limits: Unpack[WorkLimits],
    ) -> NetworkPart:
        """The body of it: a proved blend of this order for each class of nodes, an exact cylinder for each strut.

        `degree` is that of `pas.blend`.  In the folder `cache` blends are kept as they are found, and found again by
        any network that has such nodes: a run that was ended goes on where it was.  `map(function, items)` may be the
        `map` of another engine, such as that of a `concurrent.futures.Executor`, in the order of the items.

        Raises `NetworkError` for a network that `check` finds at fault, and with the points of every node for which
        there is no proved blend.
        """
        made: NetworkPart = loaded("pas.network.part:blend")(self, order, degree, cache, map)
        return made

    def write(self, path: str | Path, *, unit: str | None = None) -> Path:
        """Write the graph itself: as beams (.3mf), arrays (.npz) or a table (.csv); returns the path."""
        return Path(loaded("pas.exchange.networks:write")(self, path, unit))

    def __repr__(self) -> str:
        return f"<Network: {len(self.places)} points, {len(self.edges)} struts>"


def _places(points: Any, grid: Fraction) -> Integers:
    try:
        given = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"points must be numbers (N, 3), not {shown(points)}") from None
    if given.ndim != 2 or given.shape[1] != 3:
        raise ValueError(f"points must have the shape (N, 3), not {given.shape}")
    if not np.isfinite(given).all():
        number = int((~np.isfinite(given)).any(axis=1).argmax())
        raise ValueError(f"point {number} is not finite: {given[number].tolist()}")
    steps = given * grid.denominator / grid.numerator
    if np.abs(steps).max(initial=0) >= 2.0**52:
        raise ValueError(f"the grid {grid} is too fine for points as far out as {np.abs(given).max():.4g}")
    return np.rint(steps).astype(np.int64)


def _edges(edges: Any) -> Integers:
    given = np.asarray(edges)
    if given.size == 0:
        return np.zeros((0, 2), dtype=np.int64)
    if given.ndim != 2 or given.shape[1] != 2 or not np.issubdtype(given.dtype, np.integer):
        raise ValueError(f"edges must be whole numbers of points (E, 2), not {given.dtype} {given.shape}")
    return given.astype(np.int64)


def _radii(radii: Any, count: int) -> tuple[tuple[Fraction, ...], Integers]:
    """The different radii, the least first, and which of them each strut has (E,)."""
    if isinstance(radii, str) or not hasattr(radii, "__len__"):
        return (to_fraction(positive(radii, "radius")),), np.zeros(count, dtype=np.int64)
    if len(radii) != count:
        raise ValueError(f"radii must be one number, or one for each of the {count} struts, not {len(radii)}")
    known: dict[Any, Fraction] = {}
    for number, value in enumerate(radii):
        if value not in known:
            known[value] = to_fraction(positive(value, f"radii[{number}]"))
    values = tuple(sorted(set(known.values())))
    ranks = {value: number for number, value in enumerate(values)}
    return values, np.array([ranks[known[value]] for value in radii], dtype=np.int64)


def _attribute(data: Any, name: str, owner: str, usual: Any) -> Any:
    value = data.get(name, usual)
    if value is None:
        raise ValueError(f"{owner} has no {name!r}; give it one" + (", or radius=" if name == "radius" else ""))
    return value


def counted(cells: Any, what: str = "cells") -> tuple[int, int, int]:
    """Three whole numbers from 1 on: one number for all, or three; raises `ValueError` and `TypeError`."""
    given = (cells,) * 3 if isinstance(cells, int) else tuple(cells)
    if len(given) != 3:
        raise ValueError(f"{what} must be one whole number or three, not {shown(cells)}")
    most = 10_000
    x, y, z = (whole(n, what, 1, most) for n in given)
    return x, y, z
