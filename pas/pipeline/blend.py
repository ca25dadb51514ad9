"""Blends as scripts ask for them: contacts and wishes in, a proved surface out; `pas.pipeline.find` has the method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Unpack

from pas.blending.place import PartitionLike
from pas.contacts.contact import ContactLike
from pas.fairing.wishes import Options, Wishes, as_wishes
from pas.limits import Report, limited
from pas.pipeline.find import find
from pas.pipeline.result import Blend, SolutionSpace
from pas.pipeline.stages import OnStage, Stages


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
    clip "auto" are ended as near as a fair blend leaves room for (see `pas.struts`).  Without a
    `partition`, layouts of pieces around the node are tried in turn; it may be a `pas.Partition`, a `pas.Layout`, or
    the name of a kind of layouts: "fan", "strips", "planes" or "six tetrahedra".  Without a
    `degree` it is raised until the proofs pass, and by default further while the surface is not fair (see
    `pas.FairnessLimits`): the fairest is returned.  With degree="lowest" the first that is proved is.  The search ends,
    and says where, when a few degrees with regular surfaces have failed, at twice the order at the earliest and at
    degree 12 at the latest.

    In a session (see `pas.Session`) contacts that were blended before, up to a similarity, get the same blend moved.

    What shapes the surface is in `wishes` (see `pas.Wishes`), or said by keywords, which go before
    these: `energy`, `tension`, `limits`, `inside`, `outside`, `through`, `near`, `near_weight`, `handles`,
    `coefficients`, `margin`, `normalize`, `prove`, `guard`, `basis`.  The energy is minimised over the members: by
    default `pas.CurvatureVariation()`, that of the surface, whose `tension` goes from 0 (full) over 23/5 (as usual) up
    (slim); for a quadratic form such as `pas.ThinPlate()` the lowest degree is taken.  Points are sequences of
    three exact numbers: `inside` ones get f <= -margin, `outside` ones f >= margin (by default 10^-4 of the
    region's radius), the surface passes `through` others exactly and `near` still others by least squares with
    weight `near_weight` (or one for each).  `handles` maps B-coefficients (cell, multi-index) to values that
    they get exactly, `coefficients` numbers of members of the space's basis.  `normalize` fixes the scale of f
    (`pas.MeanAlpha()` by default).  `basis` (members, each one polynomial a cell) restricts a given `degree` to the
    span of these members.

    With `prove` (the default) the surface returned is proved in every verdict.  Without, it is
    the optimum under sampled conditions, or with `guard=False` under the points alone, and its
    certificate is worked out when asked for.  `on_stage` is told the name and the seconds of each stage
    at its end.

    Raises `GeometryError` (contacts that do not fit), `NoSolutionError` (no usable surface),
    `InfeasibleError` (constraints that contradict), `NotProvedError`; `ValueError` and
    `TypeError` for wrong arguments.
    """
    wished = as_wishes(wishes).changed(**options)
    return find(SolutionSpace, contacts, order, degree, partition, wished, Stages(on_stage))
