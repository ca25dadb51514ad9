"""Nodes for scripts: directions and radii in, a proved blend out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, Unpack

from pas.algebra.inputs import check_order, shown
from pas.algebra.rational import Exact, VectorLike, rational, vector
from pas.blending.place import PartitionLike
from pas.contacts.endless import AUTO
from pas.contacts.pipe import Pipe
from pas.fairing.wishes import Options, Wishes
from pas.layouts.clips import with_clips
from pas.limits import Report, limited
from pas.pipeline.blend import blend
from pas.pipeline.result import Blend
from pas.pipeline.stages import OnStage

Strut: TypeAlias = "tuple[VectorLike, Exact] | tuple[VectorLike, Exact, Exact]"
"""A direction and a radius, and where the pipe is clipped if that is given (in lengths of the direction)."""


def struts(items: Sequence[Strut], order: int, center: VectorLike = (0, 0, 0)) -> list[Pipe]:
    """The pipes of a node: from `center` along directions, each (direction, radius) or (direction, radius, clip).

    Pipes without a clip, or with the clip "auto", end as near as a fair blend of this order leaves room for: no two
    circles take up more than 0.6 of the angle between their directions, an arc of 0.6 of the wider radius fits between
    any two, and from order 2 or four pipes on a fan of half-planes keeps them apart.  Clips that are given stay, and
    the others keep apart from them.  Lengths are in the model's units, `clip` in lengths of the direction.

    Raises `GeometryError` for directions less than 10 degrees apart, `ValueError` and `TypeError` for wrong items.
    """
    check_order(order)
    place = vector(center, "center")
    pipes: list[Pipe] = []
    if isinstance(items, str) or not hasattr(items, "__iter__"):
        raise TypeError(f"struts must be pairs (direction, radius), not {shown(items)}")
    for number, item in enumerate(items):
        if not isinstance(item, tuple | list) or len(item) not in (2, 3):
            raise TypeError(
                f"struts[{number}] must be (direction, radius) or (direction, radius, clip), not {shown(item)}"
            )
        axis = vector(item[0], f"direction of struts[{number}]")
        radius = rational(item[1], f"radius of struts[{number}]")
        clip = item[2] if len(item) == 3 else AUTO
        clip = clip if clip == AUTO else rational(clip, f"clip of struts[{number}]")
        pipes.append(Pipe(axis, radius, clip, place))
    if len(pipes) < 2:
        raise ValueError(f"a node joins two struts or more, not {len(pipes)}")
    return with_clips(pipes, order)


@limited("making a node", "a lower order")
def node(
    items: Sequence[Strut],
    order: int = 1,
    *,
    center: VectorLike = (0, 0, 0),
    degree: int | Literal["lowest"] | None = None,
    partition: PartitionLike | None = None,
    wishes: Wishes | None = None,
    on_stage: OnStage | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[Options],
) -> Blend:
    """The blend of pipes that meet in `center`: see `pas.struts` for the items, `pas.blend` for all else.

        pas.node([((1, 0, 0), 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], order=2)

    Raises what both raise.
    """
    return blend(
        struts(items, order, center),
        order,
        degree,
        partition,
        wishes=wishes,
        on_stage=on_stage,
        **options,
    )
