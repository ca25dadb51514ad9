"""Kinds of layouts by name, what is tried of each, and partitions and layouts as tables of problem files have them.

A new kind of layouts is a file with the function that makes one, and an entry of `LAYOUTS`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from pas.algebra.rational import Vector
from pas.layouts.discs import Disc
from pas.layouts.fan import fan
from pas.layouts.planes import ORBITS, planes
from pas.layouts.region import WALLS
from pas.layouts.strips import strips
from pas.partition.cells import PARTITIONS, Partition, read_partition
from pas.partition.layout import Layout
from pas.registry import Registry, keys_of, read_as

Maker = Callable[[Sequence[Disc], Vector], Layout]
"""A function that makes a layout for discs around a centre; it raises `GeometryError` where none fits."""

NEAR_WALLS, FAR_WALLS = 1.15, 1.6
"""How far out walls are, other than the usual ones (see `region.WALLS`)."""


@dataclass(frozen=True)
class LayoutTrial:
    """One way to lay out a node: what makes the layout, and how far out its walls are."""

    make: Maker
    walls: float = WALLS


@dataclass(frozen=True)
class LayoutKind:
    """A kind of layouts: what is tried for contacts of an order (1; 2 for higher ones too), the likeliest first."""

    name: str
    trials: Mapping[int, tuple[LayoutTrial, ...]]


_two, _three, _orbits = partial(fan, each=2), partial(fan, each=3), [partial(planes, orbit=orbit) for orbit in ORBITS]
_KINDS = (
    LayoutKind("planes", dict.fromkeys((1, 2), tuple(map(LayoutTrial, _orbits)))),
    LayoutKind(
        "fan",
        {
            1: (LayoutTrial(_two), LayoutTrial(_three)),
            2: (LayoutTrial(_two), LayoutTrial(_two, NEAR_WALLS), LayoutTrial(_three)),
        },
    ),
    LayoutKind("strips", {1: (LayoutTrial(strips), LayoutTrial(strips, FAR_WALLS))}),
)

LAYOUTS: Registry[LayoutKind] = Registry("kind of layouts", {kind.name: kind for kind in _KINDS})
"""The layouts that may be asked for by name, in the order in which they are tried: full planes where those of an orbit
have room, then fans; strips where no fan has room, as around five and six contacts with near clips.  Strips have too
few members of higher order: they are tried there only where they are asked for."""


def trials(order: int, kind: str | None = None) -> tuple[LayoutTrial, ...]:
    """The trials for an order, of all kinds; of one `kind` if it is given, those of a lower order where it has none."""
    level = min(max(order, 1), 2)
    if kind is None:
        return tuple(trial for one in LAYOUTS.values() for trial in one.trials.get(level, ()))
    own = LAYOUTS[kind].trials
    return own[max(n for n in own if n <= level)]


def partition_keys() -> set[str]:
    """All keys that a table may have, with those of partitions that were registered since."""
    return keys_of(PARTITIONS) | set(Layout.keys())


def read_partition_like(record: Mapping[str, Any]) -> Partition | Layout | str:
    """What a table describes: `kind = "fan"` or another kind of layouts by name, `kind = "layout"` with rays and
    pieces, or a partition (see `pas.partition.cells.read_partition`).

    Raises `ValueError`, `TypeError` or `GeometryError`; sentences begin with the key at fault where there is one.
    """
    kind = record.get("kind")
    if kind in LAYOUTS and kind not in PARTITIONS:  # a user's own partition may have such a name
        if rest := [key for key in record if key != "kind"]:
            raise ValueError(f"{rest[0]!r} does not belong to the layout {kind!r}, which is chosen by the program")
        return str(kind)
    return read_as(Layout, "partition 'layout'", record) if kind == Layout.kind else read_partition(record)
