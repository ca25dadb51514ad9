"""Verdicts on joints, carried from a solid to what is made of it, so that they are not proved again.

A verdict rests on what the solid is beside the joint's part of its curve, nowhere else.  So it stays where something is
added or taken away that certainly has no point there: boxes in which that is so, or in which the curve is not, cover
the set in which the change lies.

Guaranteed: a verdict is used for the tree alone for which it was proved, or for one that differs from it in such a set.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from pas.algebra.monomials import Floats
from pas.solid.bounds import misses
from pas.solid.joints import Joint, prove
from pas.solid.tree import Atom, Tree, combined
from pas.verdicts import Verdict


class Judged(Protocol):
    """A solid of which a verdict is asked."""

    @property
    def tree(self) -> Tree:
        """Its inequalities."""

    @property
    def joints(self) -> tuple[Joint, ...]:
        """What is claimed of it."""

    @property
    def known(self) -> Known | None:
        """What is known of its joints."""

    @property
    def box(self) -> Floats:
        """Two corners (2, 3) between which it lies."""


@dataclass(frozen=True, eq=False)
class Change:
    """A solid before it was changed, and a set outside of which it was not."""

    before: Judged
    where: Tree

    def passes(self, joint: Joint) -> bool:
        """Whether the change is certainly away from the part of its curve of which a joint was claimed."""
        walls = (Atom(-wall, "") for wall in joint.within)
        return joint in self.before.joints and misses(combined(False, self.where, *walls), joint.along)


@dataclass(frozen=True, eq=False)
class Known:
    """Verdicts on joints of the solid with one tree, and what it was before changes."""

    tree: Tree
    changes: tuple[Change, ...] = ()
    verdicts: Mapping[Joint, Verdict] = field(default_factory=dict)

    @classmethod
    def of(cls, tree: Tree, *changes: tuple[Any, Tree]) -> Known:
        """That of what changes made, each of a solid in a set; of that no more is kept than it takes."""
        return cls(tree, tuple(Change(replace(solid, sheets=None), where) for solid, where in changes if solid.joints))


def verdict(solid: Judged, joint: Joint) -> Verdict:
    """The exact verdict on a joint of a solid: that which is known, or that of what it was before, or a new one."""
    while (known := solid.known) is not None and known.tree is solid.tree:
        if joint in known.verdicts:
            return known.verdicts[joint]
        change = next((change for change in known.changes if change.passes(joint)), None)
        if change is None:
            break
        solid = change.before
    judged = solid
    return prove(joint, judged.tree, lambda: judged.box)
