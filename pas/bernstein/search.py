"""Branch and bound: cells are judged many at once, and those that stay open are split until none is left.

This is the one such loop of the package.  It is given cells, a function that judges them and one that splits them:

    found = search(cells, judge, split, Limits(depth=48, cells=20_000), "proving signs")

- `cells` is a batch of a class derived from `Cells`: a frozen dataclass whose arrays have one row a cell, such as
  simplices with Bernstein forms on them (`pas.bernstein.simplices.Simplices`) or `Boxes`.  What else is in it holds for
  all cells of the batch, such as a bound on rounding, which `split` brings up to date;
- `judge(cells, depth)` gives each cell a `Fate` (N,): settled, to be split, kept, a refutation, or left as it is;
- `split(cells)` gives the parts of all cells, which are judged next;
- the result has the cells that were kept, those that refute and those that stay open, where the limits were met
  first.  Its `status` is PROVED where nothing is open, REFUTED at the first refutation, and UNDECIDED else.

Cells are split breadth first, so all that are open have been split equally often, but for those that waited.  How long
it may take is said by `pas.limits.limit` around it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from itertools import product
from typing import Generic, Self, TypeVar

import numpy as np

from pas.arrays import AnyArray, Bools, Floats, Integers
from pas.limits import checkpoint
from pas.verdicts import Status


class Fate(IntEnum):
    """What becomes of a cell.

    It is settled and forgotten; it is split; it stays open as it is, and is judged again when others have been split;
    it is settled and kept for the result; or the claim fails in it.
    """

    SETTLED, SPLIT, WAIT, KEEP, REFUTE = range(5)


Fates = Integers


@dataclass(frozen=True)
class Cells:
    """A batch of cells: arrays in its fields have one row a cell, other fields hold for all."""

    @property
    def _arrays(self) -> dict[str, AnyArray]:
        return {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}

    def __len__(self) -> int:
        return len(next(value for value in vars(self).values() if isinstance(value, np.ndarray)))

    def select(self, rows: AnyArray) -> Self:
        """Some of the cells, by a mask (N,) or their numbers."""
        return replace(self, **{name: array[rows] for name, array in self._arrays.items()})

    def joined(self, others: Sequence[Self]) -> Self:
        """These cells and then others; fields that hold for all are these cells'."""
        if not any(map(len, others)):
            return self
        arrays = self._arrays
        return replace(self, **{n: np.concatenate([a, *(getattr(o, n) for o in others)]) for n, a in arrays.items()})


Batch = TypeVar("Batch", bound=Cells)


@dataclass(frozen=True)
class Boxes(Cells):
    """Boxes by their centres (N, 3) and half edges (N, 3)."""

    centers: Floats
    halves: Floats

    @classmethod
    def of(cls, box: Floats, larger: float = 0.0) -> Boxes:
        """One box from a corner to the opposite one, (2, 3), its edges longer by a share."""
        return cls(box.mean(axis=0)[None], np.ptp(box, axis=0)[None] / 2 * (1 + larger))

    def eighths(self) -> Boxes:
        """The eight parts of each, one octant after the other."""
        halves = self.halves / 2
        centers = [self.centers + halves * np.array(side) for side in product((-1, 1), repeat=3)]
        return Boxes(np.concatenate(centers), np.tile(halves, (8, 1)))

    def halved(self, along: Bools) -> Boxes:
        """Each halved along those of its sides (N, 3) that are marked."""
        centers, halves = self.centers, self.halves
        for axis in range(3):
            cut = along[:, axis]
            step = np.where(cut, halves[:, axis] / 2, 0.0)[:, None] * np.eye(3)[axis]
            halves = halves - step
            centers = np.concatenate([centers - step, (centers + step)[cut]])
            halves, along = np.concatenate([halves, halves[cut]]), np.concatenate([along, along[cut]])
        return Boxes(centers, halves)


@dataclass(frozen=True)
class Limits:
    """The limits at which a search gives up: `depth` rounds of splitting, and more than `cells` open ones."""

    depth: int = 48
    cells: int = 20_000


@dataclass(frozen=True)
class Searched(Generic[Batch]):
    """The result of a search: the cells that were `kept`, those in which the claim fails, and those left `open`.

    `examined` counts all cells.  Fields that hold for all of a batch are as they were at the end.
    """

    kept: Batch
    refuted: Batch
    open: Batch
    examined: int

    @property
    def status(self) -> Status:
        """PROVED where no cell is open or refutes the claim."""
        return Status.REFUTED if len(self.refuted) else Status.UNDECIDED if len(self.open) else Status.PROVED


def search(
    cells: Batch, judge: Callable[[Batch, int], Fates], split: Callable[[Batch], Batch], limits: Limits, task: str
) -> Searched[Batch]:
    """Judge cells and split those that are open, until none is, the claim is refuted, or the limits are met."""
    kept: list[Batch] = []
    examined, nothing = 0, cells.select(np.arange(0))
    waiting = nothing
    for depth in range(limits.depth + 1):
        checkpoint(f"{task} ({examined} cells examined)")
        examined += len(cells) - len(waiting)
        fates = judge(cells, depth)
        found = {fate: cells.select(fates == fate) for fate in np.flatnonzero(np.bincount(fates)).tolist() if fate}
        cut, waiting, refuted = (found.get(fate, nothing) for fate in (Fate.SPLIT, Fate.WAIT, Fate.REFUTE))
        kept += [found[Fate.KEEP]] if Fate.KEEP in found else []
        if len(refuted) or not len(cut) or depth == limits.depth or len(cut) + len(waiting) > limits.cells:
            break
        cells = split(cut).joined([waiting])
    return Searched(kept[-1].joined(kept[:-1]) if kept else nothing, refuted, cut.joined([waiting]), examined)
