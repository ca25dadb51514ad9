"""Joints: two faces of a solid that continue each other with GC^k along a curve, proved exactly.

Along a curve V(g, h) the surfaces f1 = 0 and f2 = 0 meet with GC^k iff both polynomials are members of
`<g, h^(k+1)>` (Warren 1989) with no singular point on the curve (Garrity and Warren 1991), and the
solid is on the same side of both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.real_points import count_real_points, has_real_curve, sign_sum
from pas.bernstein.signs import Status
from pas.errors import GeometryError
from pas.solid.tree import Bools
from pas.surface.certificate import Verdict

HIGHEST_ORDER = 12
"""Orders above are not told apart."""

SAMPLES, NEWTON_STEPS = 4000, 12
CLOSE, BESIDE = 1e-6, 1e-5
"""How far a sample of a curve may be off a region, and how far beside it the solid is looked for, over
the solid's extent."""

LINK = 0.01
"""How far neighbouring samples of a curve's component may be apart, over the solid's extent."""


@dataclass(frozen=True)
class Joint:
    """The claim that two faces, by name, meet with GC^`order` along the curve V(g, h)."""

    first: str
    second: str
    along: tuple[Polynomial, Polynomial]
    order: int

    def __init__(self, first: str, second: str, along: Any, order: int) -> None:
        if not isinstance(along, Sequence) or isinstance(along, str) or len(along) != 2:
            raise TypeError(f"along must be the two polynomials (g, h) of the joint's curve, not {along!r}")
        object.__setattr__(self, "first", first)
        object.__setattr__(self, "second", second)
        object.__setattr__(self, "along", (Polynomial(along[0]), Polynomial(along[1])))
        object.__setattr__(self, "order", check_order(order))

    @property
    def claim(self) -> str:
        """What is to be proved, in words."""
        return f"{self.first} meets {self.second} with GC^{self.order}"


@dataclass(frozen=True)
class Side:
    """One face at a joint: its polynomial (negative inside) and the regions (each `r >= 0`) it is used in."""

    polynomial: Polynomial
    regions: tuple[tuple[Polynomial, ...], ...]


def contact_order(polynomial: Polynomial, along: tuple[Polynomial, Polynomial]) -> int:
    """The largest k with a member of `<g, h^(k+1)>`; -1 for none, `HIGHEST_ORDER` from there on."""
    g, h = along
    for k in range(HIGHEST_ORDER):
        if not Ideal(g, h ** (k + 1)).contains(polynomial):
            return k - 1
    return HIGHEST_ORDER


def prove(
    joint: Joint, firsts: Sequence[Side], seconds: Sequence[Side], box: Floats, contains: Callable[[Floats], Bools]
) -> Verdict:
    """The verdict on a joint, given the polynomials that carry its two faces and the solid's membership.

    Exact but for the question how much of the curve the faces' regions cover, which is looked at in
    samples: the faces must go together along all of it that is on the solid's boundary.  Components
    of the curve where they never meet are not part of the joint.
    """
    orders = [{s: contact_order(s.polynomial, joint.along) for s in sides} for sides in (firsts, seconds)]
    order = min(max(found.values(), default=-1) for found in orders)
    if order < joint.order:
        found = f"they meet with GC^{order} there" if order >= 0 else "they do not meet there"
        return Verdict(Status.REFUTED, joint.claim, found)
    if has_real_curve(*joint.along) is False:
        return Verdict(Status.REFUTED, joint.claim, "the curve has no real point")
    points = curve_points(joint.along, box)
    carriers = [[s for s, o in found.items() if o >= joint.order] for found in orders]
    if any(len(sides) > 1 for sides in carriers):  # those that do not reach the curve have no say
        carriers = [[s for s in sides if _in_regions(s, points, box).any()] or sides for sides in carriers]
    for sides, name in zip(carriers, (joint.first, joint.second), strict=True):
        for side in sides:
            verdict = _regular(side, name, joint)
            if verdict is not None:
                return verdict
    near = [np.any([_in_regions(s, points, box) for s in sides], axis=0) for sides in carriers]
    if not (near[0] & near[1]).any():
        reason = "the regions of the two faces do not both reach the curve"
        return Verdict(Status.REFUTED, joint.claim, reason, _place(points[near[0] | near[1]]))
    for a in carriers[0]:
        for b in carriers[1]:
            common = points[_in_regions(a, points, box) & _in_regions(b, points, box)]
            slopes = [s.polynomial.gradient(common) for s in (a, b)]
            if joint.order > 0 and (np.einsum("ni,ni->n", *slopes) < 0).any():
                return Verdict(Status.REFUTED, joint.claim, "the solid is on opposite sides of the two faces")
    connected = _connected(points, near[0] & near[1], LINK * float(np.ptp(box, axis=0).max()))
    for here, there, sides, name in ((0, 1, carriers[0], joint.second), (1, 0, carriers[1], joint.first)):
        alone = points[near[here] & ~near[there] & connected]
        gap = alone[_on_boundary(alone, sides, contains, box)]
        if len(gap):
            reason = f"on a part of the curve {name} is missing: its region does not go there"
            return Verdict(Status.REFUTED, joint.claim, reason, _place(gap))
    order = min(min(found[s] for s in sides) for found, sides in zip(orders, carriers, strict=True))
    exactly = f"exactly GC^{order}" if order < HIGHEST_ORDER else "the same surface"
    g, h = joint.along
    return Verdict(Status.PROVED, joint.claim, f"both in <{_short(g)}, ({_short(h)})^{joint.order + 1}>, {exactly}")


def _connected(points: Floats, chosen: Bools, reach: float) -> Bools:
    """Which points (N, 3) chains of steps up to `reach` connect with a chosen one."""
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    component = connected_components(graph, directed=False)[1]
    return np.isin(component, component[chosen])


def _place(points: Floats) -> tuple[float, float, float] | None:
    """The first of points, for a verdict."""
    return (float(points[0, 0]), float(points[0, 1]), float(points[0, 2])) if len(points) else None


def _on_boundary(points: Floats, sides: Sequence[Side], contains: Callable[[Floats], Bools], box: Floats) -> Bools:
    """Which points (N, 3) have the solid on one side of one of the surfaces and not on the other."""
    result, step = np.zeros(len(points), dtype=bool), BESIDE * float(np.ptp(box, axis=0).max())
    for side in sides if len(points) else ():
        slope = side.polynomial.gradient(points)
        slope *= step / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-300)
        result |= contains(points - slope) & ~contains(points + slope)
    return result


def _short(polynomial: Polynomial) -> str:
    text = str(polynomial)
    return text if len(text) <= 40 else text[:37] + "..."


def _regular(side: Side, name: str, joint: Joint) -> Verdict | None:
    """None where the face has no singular point on the part of the curve in its regions; else the verdict."""
    singular = Ideal(*joint.along, *(side.polynomial.diff(i) for i in range(3)))
    number = count_real_points(singular)
    if number == 0:
        return None
    if number is None:
        return Verdict(Status.REFUTED, joint.claim, f"{name} is singular all along a part of the curve")
    for region in side.regions:
        if not any(sign_sum(singular, inequality) == -number for inequality in region):
            return Verdict(
                Status.UNDECIDED, joint.claim, f"{name} has {number} singular points on the curve, maybe in its region"
            )
    return None


def curve_points(along: tuple[Polynomial, Polynomial], box: Floats) -> Floats:
    """Points (m, 3) on the curve V(g, h) in and near a box (2, 3), by Newton's method from random ones."""
    points = np.random.default_rng(0).uniform(box[0], box[1], size=(SAMPLES, 3))
    for _ in range(NEWTON_STEPS):
        values = np.stack([p(points) for p in along], axis=1)
        matrix = np.stack([p.gradient(points) for p in along], axis=1)
        size = np.maximum(np.linalg.norm(matrix, axis=2), 1e-300)
        step = np.einsum("nij,nj->ni", np.linalg.pinv(matrix / size[..., None], rcond=1e-9), values / size)
        points = points - step
    extent = float(np.ptp(box, axis=0).max())
    good = np.isfinite(points).all(axis=1) & (np.linalg.norm(step, axis=1) < 1e-9 * extent)
    good &= (points >= box[0] - CLOSE * extent).all(axis=1) & (points <= box[1] + CLOSE * extent).all(axis=1)
    return points[good]


def _in_regions(side: Side, points: Floats, box: Floats) -> Bools:
    """Which points are in one of a face's regions, up to `CLOSE`."""
    margin = CLOSE * float(np.ptp(box, axis=0).max())
    result = np.zeros(len(points), dtype=bool)
    for region in side.regions:
        inside = np.ones(len(points), dtype=bool)
        for inequality in region:
            slope = np.linalg.norm(inequality.gradient(points), axis=1)
            inside &= inequality(points) >= -margin * np.maximum(slope, 1e-9)
        result |= inside
    return result


def refuse_unknown(joint: Joint, faces: Sequence[str]) -> None:
    """Raise `GeometryError` where a joint names a face that the solid does not have."""
    for name in (joint.first, joint.second):
        if name not in faces:
            raise GeometryError(f"the solid has no face {name!r} for the joint; its faces are {', '.join(faces)}")
