"""The method as scripts ask for it: `blend`, `node` and `solutions`; `pas.pipeline.search` has how it is done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, Unpack

from pas.algebra.inputs import HIGHEST_DEGREE, check_degree, check_order, shown
from pas.algebra.rational import Exact, VectorLike, rational, vector
from pas.blending.place import PartitionLike, place
from pas.blending.regularity import is_regular
from pas.blending.solving import check_method, solve
from pas.contacts.contact import ContactLike
from pas.contacts.endless import AUTO, Pipe
from pas.fairing.wishes import Options, Wishes, as_wishes
from pas.layouts.clips import with_clips
from pas.limits import Report, WorkLimits, checkpoint, limited
from pas.pipeline.chosen import OnStage, Stages
from pas.pipeline.result import Blend, SolutionSpace
from pas.pipeline.search import find

Strut: TypeAlias = "tuple[VectorLike, Exact] | tuple[VectorLike, Exact, Exact]"
"""A direction and a radius, and where the pipe is clipped if that is given (in lengths of the direction)."""


class BlendOptions(Options, total=False):
    """The keywords of `blend` that what is made by it passes on, but for those of limits."""

    degree: int | Literal["lowest"] | None
    partition: PartitionLike | None
    wishes: Wishes | None
    on_stage: OnStage | None


@limited("finding a blend", "a lower order")
def blend(
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | Literal["lowest"] | None = None,
    partition: PartitionLike | None = None,
    *,
    wishes: Wishes | None = None,
    on_stage: OnStage | None = None,
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[Options],
) -> Blend:
    """Find, choose and prove the blend of two contacts or more.

    `contacts` are pipes or other primitives, contacts or pairs (surface, clip), `order` the k of GC^k.  Those with the
    clip "auto" are ended as near as a fair blend leaves room for (see `pas.struts`).  Without a `partition`, layouts of
    pieces around the node are tried in turn; it may be a `pas.Partition`, a `pas.Layout`, or the name of a kind of
    layouts: "fan", "strips", "planes" or "six tetrahedra".  Without a `degree` it is raised until the proofs pass, and
    by default further while the surface is not fair (see `pas.FairnessLimits`): the fairest is returned.  With
    degree="lowest" it is the first that is proved.  The search ends, and says where, when a few degrees with regular
    surfaces have failed, at twice the order at the earliest and at degree 12 at the latest.

    In a session (see `pas.Session`) contacts that were blended before, up to a similarity, get the same blend moved.

    The surface is shaped by `wishes` (see `pas.Wishes`) or by the same options as keywords, which take
    precedence: `energy`, `tension`, `limits`, `inside`, `outside`, `through`, `near`, `near_weight`, `handles`,
    `coefficients`, `margin`, `normalize`, `prove`, `guard`, `basis`.  The energy is minimised over the members: by
    default `pas.CurvatureVariation()`, that of the surface, whose `tension` goes from 0 (full) over 23/5 (as usual) up
    (slim); for a quadratic form such as `pas.ThinPlate()` the lowest degree is taken.  Points are sequences of
    three exact numbers: `inside` ones get f <= -margin, `outside` ones f >= margin (by default 10^-4 of the
    region's radius), the surface passes `through` others exactly and `near` still others by least squares with
    weight `near_weight` (or one for each).  `handles` maps B-coefficients (cell, multi-index) to values that
    they get exactly, `coefficients` numbers of members of the space's basis.  `normalize` fixes the scale of f
    (`pas.MeanAlpha()` by default).  `basis` (members, each one polynomial a cell) restricts a given `degree` to the
    span of these members.

    With `prove` (the default) the surface returned is proved in every verdict.  Without, it is the optimum under
    sampled conditions, or with `guard=False` under the points alone, and its certificate is worked out when asked for.
    `on_stage` is called with the name and the seconds of each stage at its end.

    Raises `GeometryError` (contacts that do not fit), `NoSolutionError` (no usable surface), `InfeasibleError`
    (constraints that contradict), `NotProvedError`; `ValueError` and `TypeError` for wrong arguments.
    """
    wished = as_wishes(wishes).changed(**options)
    return find(Blend, contacts, order, degree, partition, wished, Stages(on_stage))


def struts(items: Sequence[Strut], order: int, center: VectorLike = (0, 0, 0)) -> list[Pipe]:
    """The pipes of a node: from `center` along directions, each (direction, radius) or (direction, radius, clip).

    Pipes without a clip, or with the clip "auto", end as near as a fair blend of this order leaves room for: no two
    circles take up more than 0.6 of the angle between their directions, an arc of 0.6 of the wider radius fits between
    any two, and from order 2 or four pipes on a fan of half-planes keeps them apart.  Clips that are given stay, and
    the others keep apart from them.  Lengths are in the model's units, `clip` in lengths of the direction.
    `pas.ContactEnd.of(pipe, center)` says of each where it was put.  Warns (`UserWarning`) of ends that are far out for
    their radii, and of radii that differ much.

    Raises `GeometryError` for directions less than 10 degrees apart, `ValueError` and `TypeError` for wrong items.
    """
    return list(with_clips(pipes_of(items, order, center), order))


def pipes_of(items: Sequence[Strut], order: int, center: VectorLike) -> list[Pipe]:
    """The pipes of `struts` before those with the clip "auto" are ended; raises `ValueError` and `TypeError`."""
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
    return pipes


@limited("making a node", "a lower order")
def node(
    items: Sequence[Strut],
    order: int = 1,
    *,
    center: VectorLike = (0, 0, 0),
    seconds: float | None = None,
    progress: Report | None = None,
    **options: Unpack[BlendOptions],
) -> Blend:
    """The blend of pipes that meet in `center`: see `pas.struts` for the items, `pas.blend` for all else.

        pas.node([((1, 0, 0), 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], order=2)

    It is always one surface around the centre; `pas.junction` takes a foot on the run of a T where that is better.

    Raises what both raise.
    """
    return blend(struts(items, order, center), order, **options)


@limited("solving for all surfaces", "a lower degree")
def solutions(
    contacts: Sequence[ContactLike],
    order: int,
    degree: int | None = None,
    partition: PartitionLike | None = None,
    *,
    method: str = "linear",
    regular: bool = False,
    highest_degree: int = HIGHEST_DEGREE,
    **limits: Unpack[WorkLimits],
) -> SolutionSpace:
    """All surfaces that meet the contacts with GC^`order`, exact.

    `contacts` are pipes, contacts or pairs (surface, clip); clips that are "auto" are placed as by `pas.blend`.  The
    `partition` is a `pas.SingleCell(...)` for single polynomials, or several cells; without one, three perpendicular
    contacts get the six-tetrahedra corner.

    With a `degree`, all solutions of that degree (the dimension may be 0); without, those of the lowest degree that has
    any, or with `regular` a regular one (alpha not identically zero on the contact curves).  Where no degree up to
    `highest_degree` has any, the answer is the empty space of that degree; `degrees_tried` has the dimensions found.

    `method` is "linear", "syzygy", and for a single cell also "normal-form" and "intersection": the
    same space by different ways, with different bases.

    Raises `GeometryError` where the contacts do not fit, `ValueError` or `TypeError` for a wrong argument.
    """
    check_degree(highest_degree, "highest_degree")
    placed = place(contacts, order, partition)
    check_method(method, placed.partition)
    if degree is not None:
        return SolutionSpace.of(solve(placed, check_degree(degree), method))
    tried: dict[int, int] = {}
    for candidate in range(1, highest_degree + 1):
        checkpoint(f"solving for degree {candidate}")
        space = solve(placed, candidate, method)
        tried[candidate] = space.dimension
        if space.dimension and (not regular or is_regular(space)):
            break
    return SolutionSpace(placed, space.degree, space.source, degrees_tried=tried)
