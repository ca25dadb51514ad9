"""How fair a shape is, as the page shows it: the measures beside their limits, and in words what is beyond them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pas.shape import Shape, kind_of
from pas.studio.messages import Message
from pas.surface.fairness_limits import LOOSE, NODE_SHARPNESS


def measures(shape: Shape | None) -> Message:
    """The measures of a shape, and what is not fair of it; of other kinds than blends, and of none, there are none."""
    told = {} if shape is None else kind_of(shape).facts(shape)
    limits = getattr(shape, "limits", None)
    facts = {"fairness": told.get("fairness"), "limits": {} if limits is None else vars(limits)}
    return Message({"kind": "measures", "facts": facts, "unfair": list(_unfair(shape))})


def _unfair(shape: Any) -> Iterator[str]:
    """What is not fair, each in some words.

    Where the neighbours leave no room for a fair surface there is no limit of sharpness: the usual one is looked at.
    """
    if getattr(shape, "kind", "") != "blend" or shape.fairness is None:
        return
    fairness = shape.fairness
    yield from fairness.beyond(shape.limits)
    if shape.limits.sharpness >= LOOSE and fairness.sharpness > NODE_SHARPNESS:
        times = f"{fairness.sharpness:.3g} times as sharp as its sharpest neighbour"
        yield f"{times}, for the neighbours leave no room for a fair surface"
