"""Lattices as blocks of unit cells, and foams of random cells.

A block holds the cells' struts that have both ends in it, the far sides included.  Names are those of the literature
on architected materials (Deshpande, Fleck and Ashby 2001): octet is the octet truss, FCC only its struts from corners
to the middles of faces, Kelvin the edges of truncated octahedra.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations, product
from typing import Any

import numpy as np

from pas.algebra.inputs import shown, whole
from pas.algebra.rational import Exact, positive, to_fraction
from pas.arrays import Integers
from pas.network.network import Network
from pas.registry import Registry

Whole3 = tuple[int, int, int]


@dataclass(frozen=True)
class UnitCell:
    """A cell that repeats: its side in steps, the sites in it, and the struts of one cell.

    A strut (a, b, (x, y, z)) goes from site a to site b of the cell (x, y, z) cells away.  Each strut is given once.
    """

    period: int
    sites: tuple[Whole3, ...]
    struts: tuple[tuple[int, int, Whole3], ...]
    name: str = ""

    def __post_init__(self) -> None:
        whole(self.period, "period", 1, 2**16)
        for number, site in enumerate(self.sites):
            if len(site) != 3 or not all(0 <= c < self.period for c in site):
                raise ValueError(f"sites[{number}] must be three whole numbers from 0 to {self.period - 1}, not {site}")
        for number, (a, b, _) in enumerate(self.struts):
            if not 0 <= a < len(self.sites) > b >= 0:
                raise ValueError(f"struts[{number}] must join two of the {len(self.sites)} sites, not {a} and {b}")

    @classmethod
    def along(
        cls, period: int, sites: Iterable[Whole3], directions: Iterable[Whole3], starts: Sequence[Whole3] = ()
    ) -> UnitCell:
        """The cell whose struts go from all sites, or those of `starts`, along directions to where there is a site."""
        known = tuple(sorted(sites))
        struts = []
        for a in starts or known:
            for way in directions:
                end = [p + w for p, w in zip(a, way, strict=True)]
                site = tuple(c % period for c in end)
                if site in known:
                    x, y, z = (c // period for c in end)
                    struts.append((known.index(a), known.index(site), (x, y, z)))
        return cls(period, known, tuple(struts))


def _signed(values: Whole3) -> set[Whole3]:
    return {(x, y, z) for v in permutations(values) for x, y, z in product(*({c, -c} for c in v))}


def _half(values: Whole3) -> list[Whole3]:
    """One of each two opposite vectors."""
    return sorted(v for v in _signed(values) if v > (0, 0, 0))


def _kelvin() -> UnitCell:
    sites = {((x + s) % 4, (y + s) % 4, (z + s) % 4) for x, y, z in _signed((0, 1, 2)) for s in (0, 2)}
    return UnitCell.along(4, sites, _half((0, 1, 1)))


def _faces(step: int = 1) -> list[Whole3]:
    """The corner of a cell and the middles of its faces, which are so many steps from it along two axes."""
    return [(0, 0, 0), (step, step, 0), (step, 0, step), (0, step, step)]


UNIT_CELLS: Registry[UnitCell] = Registry(
    "unit cell",
    {
        "cubic": UnitCell.along(1, [(0, 0, 0)], _half((0, 0, 1))),
        "BCC": UnitCell.along(2, [(0, 0, 0), (1, 1, 1)], _half((1, 1, 1))),
        "FCC": UnitCell.along(2, _faces(), _signed((0, 1, 1)), [(0, 0, 0)]),
        "octet": UnitCell.along(2, _faces(), _half((0, 1, 1))),
        "diamond": UnitCell.along(
            4,
            [*_faces(2), *((x + 1, y + 1, z + 1) for x, y, z in _faces(2))],
            [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)],
            _faces(2),
        ),
        "Kelvin": _kelvin(),
    },
)
"""Unit cells by name; one's own is added by `UNIT_CELLS.register` or given as it is."""


def lattice(unit: str | UnitCell, cells: int | Sequence[int] = 1, radius: Exact = "1/20", size: Exact = 1) -> Network:
    """A block of `cells` unit cells of an exact `size` (the model's units), with struts of one `radius`.

        pas.network.lattice("octet", cells=(20, 20, 20), radius="1/20")

    `unit` is "cubic", "BCC", "FCC", "octet", "Kelvin" or "diamond", or a `UnitCell`.  Raises `ValueError` for another
    name, numbers of cells that are not positive, a radius or size that is not.
    """
    names = {known.lower(): known for known in UNIT_CELLS}
    cell = unit if isinstance(unit, UnitCell) else UNIT_CELLS[names.get(str(unit).lower(), str(unit))]
    given, most = (cells,) * 3 if isinstance(cells, int) else tuple(cells), 10_000
    if len(given) != 3:
        raise ValueError(f"cells must be one whole number or three, not {shown(cells)}")
    counts = np.array([whole(n, "cells", 1, most) for n in given])
    step = to_fraction(positive(size, "size")) / cell.period
    places, edges = _block(cell, counts)
    return Network(places * float(step), edges, radius, step)


def _block(cell: UnitCell, counts: Any) -> tuple[Integers, Integers]:
    """Places in steps (N, 3), in the order of their coordinates, and struts (E, 2) of a block of cells."""
    sizes = counts * cell.period
    origins = np.stack(np.meshgrid(*(np.arange(-1, n + 1) for n in counts), indexing="ij"), axis=-1).reshape(-1, 3)
    sites = np.array(cell.sites)
    ends = []
    for a, b, offset in cell.struts:
        first = origins * cell.period + sites[a]
        second = (origins + offset) * cell.period + sites[b]
        inside = ((np.minimum(first, second) >= 0) & (np.maximum(first, second) <= sizes)).all(axis=1)
        ends.append(np.stack([np.ravel_multi_index(end[inside].T, sizes + 1) for end in (first, second)], axis=1))
    used, edges = np.unique(np.concatenate(ends), return_inverse=True)
    return np.stack(np.unravel_index(used, sizes + 1), axis=1), edges.reshape(-1, 2)


def voronoi(seeds: int, radius: Exact = "1/100", size: Exact = 1, *, seed: int = 0, grid: Exact = "1/4096") -> Network:
    """The edges of the Voronoi cells of `seeds` random points in a cube of side `size`: an open foam.

    The points are those of numpy's default generator for the number `seed`, mirrored in the sides of the cube, so that
    these are sides of cells.  Many edges are short: `repair(collapse=True)` makes points of those that no blends fit.
    Raises `ValueError` for fewer than 2 seeds.
    """
    from scipy.spatial import Voronoi

    inside = np.random.default_rng(seed).random((whole(seeds, "seeds", 2, 1_000_000), 3))
    mirrored = [np.where(np.arange(3) == axis, 2 * side - inside, inside) for axis in range(3) for side in (0, 1)]
    found = Voronoi(np.concatenate([inside, *mirrored]))
    rounds = [np.array(ridge) for ridge in found.ridge_vertices]
    pairs = np.concatenate([np.stack([ridge, np.roll(ridge, -1)], axis=1) for ridge in rounds])
    edge = 1e-9
    bounded = ((found.vertices > -edge) & (found.vertices < 1 + edge)).all(axis=1)
    kept = np.unique(np.sort(pairs[(pairs >= 0).all(axis=1) & bounded[pairs].all(axis=1)], axis=1), axis=0)
    used, edges = np.unique(kept, return_inverse=True)
    cube = to_fraction(positive(size, "size"))
    step = cube * to_fraction(positive(grid, "grid"))
    return Network(found.vertices[used] * float(cube), edges.reshape(-1, 2), radius, step).repair()[0]
