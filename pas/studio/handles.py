"""The handles of a blend beside points: of single cells, members' coefficients and B-coefficients.

Where all is one polynomial, the members of the basis are classical blends themselves, and their coefficients are what
such families are shaped by.  B-coefficients are handles by which the surface is pulled.  Both belong to one degree and
one region: a document that holds some has to say its degree.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from scipy.optimize import linprog

from pas.algebra.inputs import short, shown
from pas.algebra.rational import to_float, to_floats
from pas.arrays import Floats
from pas.blending.shaping import handles
from pas.errors import InfeasibleError, InputError
from pas.fairing.basis import to_doubles
from pas.fairing.constraints import Inequalities
from pas.fairing.functionals import Handle, b_coefficient
from pas.fairing.prepared import SLIM, SampledConditions
from pas.fairing.programme import MemberProgramme
from pas.fairing.refit import compliance
from pas.fairing.wishes import Wishes
from pas.pipeline.result import Blend
from pas.studio import Data
from pas.studio.controls import Control, rounded


def free_handle(blend: Blend, point: Floats) -> tuple[Handle, float]:
    """Of a single cell, the B-coefficient by which the surface is pulled next to a point, and its value.

    It is one that nothing wished has settled and with which the surface goes along, whatever else follows by energy.
    Raises `InputError` where none is free.
    """
    candidates = handles(blend.space)
    places, correlation, share = _grips(blend, blend.wishes, candidates)
    local = (point - to_floats(blend.surface.partition.frame.origin)) / to_float(blend.surface.partition.frame.scale)
    size = float(np.linalg.norm(blend.surface.local.points, axis=1).max())
    # a handle near by is six times as good as one at the end of the region with which the surface goes along as well;
    # where a good one takes hold, the function changes by a hundredth of the coefficient at least
    near = 1 / (1 + 5.0 * np.linalg.norm(places - local, axis=1) / size)
    good = np.where(share > 0.01, correlation * near, 0.0)
    if not good.max() > 0:
        raise InputError("no handle is free: what is held settles the surface, or it goes along with none")
    handle = candidates[int(good.argmax())]
    return handle, float(blend.surface.cells[handle[0]].b_coefficients[handle[1]])


def _grips(blend: Blend, wishes: Wishes, candidates: Sequence[Handle]) -> tuple[Floats, Floats, Floats]:
    """Where B-coefficients take hold of the surface, in local coordinates (N, 3), and how it goes along with each
    there: the correlation (N,), 0 where one is settled or the surface is not met, and how much the function changes
    with the coefficient (N,).

    A place is where the ray from the centre through the domain point meets the surface.
    """
    surface, prepared = blend.surface, blend.space.prepared
    local, frame, degree = surface.local, surface.partition.frame, surface.degree
    domains = np.array([np.array(index) / degree @ local.points[list(local.cells[cell])] for cell, index in candidates])
    seen = np.linalg.norm(domains, axis=1) > 1e-9  # from the centre no ray goes through it
    distances = np.full(len(domains), np.inf)
    distances[seen] = surface.intersect_rays(to_floats(frame.origin), domains[seen]) / to_float(frame.scale)
    met = np.isfinite(distances)
    places = np.where(met, distances, 1.0)[:, None] * domains
    basis = prepared.basis
    columns = np.hstack([to_doubles(b_coefficient(surface.partition, handle, degree).column) for handle in candidates])
    rows, values = (basis.coefficients[0] @ columns).T, basis.values(0, places)
    follows = compliance(prepared, surface, blend.choice, wishes)
    own, there = (np.einsum("ij,jk,ik->i", a, follows, a) for a in (rows, values))
    both = np.einsum("ij,jk,ik->i", rows, follows, values)
    free = met & (own > 1e-6 * own.max()) & (there > 0)  # it gives way, so it is not settled
    own, there = np.where(free, own, 1.0), np.where(free, there, 1.0)
    return places, np.where(free, np.abs(both) / np.sqrt(own * there), 0.0), np.where(free, both / own, 0.0)


def shares_of(blend: Any) -> list[float | None]:
    """For each handle that is held, how much the function changes at its place with the coefficient, if all else
    follows; None where that cannot be told."""
    held = blend.wishes.handles if pulled_by_coefficients(blend) else ()
    return [_share(blend, number) for number in range(len(held))]


def _share(blend: Blend, number: int) -> float | None:
    handle, _ = blend.wishes.handles[number]
    try:
        _, _, share = _grips(blend, blend.wishes.without([("handles", number)]), [handle])
    except InfeasibleError:
        return None
    return float(share[0]) or None


def with_handle(document: Data, blend: Any, point: Any) -> Data:
    """A document of a blend's degree that holds one handle more, at its value; see `free_handle`."""
    if not isinstance(point, list) or len(point) != 3 or not all(isinstance(c, int | float) for c in point):
        raise InputError(f"a place must be three numbers, not {shown(point)}")
    (cell, index), value = free_handle(blend, np.array(point, dtype=float))
    table, points, name = path_of(document, "handles")
    held = document.get(table, {})
    there = held.get(points, {})
    handles = [*there.get(name, []), [[cell, list(index)], f"{value:.6g}"]]
    return {**document, table: {**held, points: {**there, name: handles}}}


def at_degree(document: Data, degree: int) -> Data:
    """A document that says its degree, where that was left to be found."""
    if document["kind"] != "problem" or isinstance(document["problem"].get("degree"), int):
        return document
    return {**document, "problem": {**document["problem"], "degree": degree}}


def handle_controls(document: Data, shape: Any) -> Iterator[Control]:
    """The controls of handles and of members' coefficients, where a shape has some; see `pas.studio.controls`.

    Of "coefficients", `names` are the members as polynomials and `ends` the least and the greatest values that any
    surface with clean contacts and walls has, as far as samples tell, whatever else is wished.
    """
    if not can_follow(shape) or shape.dimension < 2:
        return
    if coefficients_of(shape):
        yield {"kind": "coefficients", "path": path_of(document, "coefficients"), "label": "coefficients",
               "group": "Coefficients", **_members(shape)}  # fmt: skip
    if shape.surface.partition.cells:
        yield {"kind": "handles", "path": path_of(document, "handles"), "label": "handles", "group": "Handles",
               "through": not pulled_by_coefficients(shape)}  # fmt: skip


def pulled_by_coefficients(shape: Any) -> bool:
    """Whether B-coefficients are good handles: of single polynomials.

    On many cells they are not: what the surface does correlates with a single one by 0.1 or so, since all others
    follow by energy.  There points to pass through take hold of the surface.
    """
    return can_follow(shape) and bool(shape.surface.partition.cells) and len(shape.surface.partition.pieces) == 1


def can_follow(shape: Any) -> bool:
    """Whether other sliders can be followed from it."""
    return getattr(shape, "kind", "") == "blend"


def path_of(document: Data, name: str) -> list[Any]:
    """Where a document holds what is wished under a name."""
    return ["problem" if document["kind"] == "problem" else "sliders", "points", name]


def coefficients_of(shape: Any) -> list[float]:
    """The coefficients of a single cell's members, where a shape has few enough to show them."""
    single = can_follow(shape) and len(shape.surface.partition.pieces) == 1
    most_members = 40  # coefficients that are offered: more are no family that anybody shapes by hand
    return [float(value) for value in shape.coefficients] if single and shape.dimension <= most_members else []


def _members(blend: Blend) -> dict[str, Any]:
    found = [member for (member,) in blend.space.basis]
    whole = np.linalg.norm(blend.surface.polynomials[0].dense(blend.surface.degree))
    sizes = [float(whole / np.linalg.norm(member.dense(blend.surface.degree))) for member in found]
    wide = [4.0 * max(abs(value), size) for value, size in zip(coefficients_of(blend), sizes, strict=True)]
    wishes = blend.wishes.without(list(blend.wishes.hard()))
    prepared = blend.space.prepared
    slim = SampledConditions(prepared, SLIM)
    rows = slim.first if wishes.guard else Inequalities.none(blend.dimension)
    equations = MemberProgramme(prepared, wishes).equations
    among = {"A_ub": -rows.rows, "b_ub": -rows.at_least, "A_eq": equations[:, :-1], "b_eq": equations[:, -1]}
    ends = [
        [_least(column, among, -rounded(end)), -_least(-column, among, -rounded(end))]
        for column, end in zip(to_doubles(prepared.basis.transform).T, wide, strict=True)
    ]
    return {"names": [short(str(member)) for member in found], "ends": ends}


def _least(cost: Floats, among: dict[str, Floats], otherwise: float) -> float:
    """The least value of a linear form under linear conditions, to four digits; where there is none, what is said."""
    found = linprog(cost, **among, bounds=(None, None))
    return float(f"{found.fun:.4g}") if found.status == 0 else otherwise
