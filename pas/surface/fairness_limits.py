"""The limits up to which a surface counts as fair beside its neighbours, and the neighbours' measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from math import ceil, inf
from typing import Any

import numpy as np

from pas.algebra.inputs import check_order, set_fields, shown
from pas.algebra.lengths import unit
from pas.algebra.rational import amount, to_float
from pas.arrays import Floats
from pas.contacts.joins import Join
from pas.surface.geometry import Geometry, derivative_batch

NODE_SHARPNESS = 1.15
"""Limit of the sharpness of nodes in any directions, where arcs leave room for it."""

WAIST = 0.03
"""Limit of the waist, at every order: up to it no waist is seen in reflections."""

LOOSE = 1000.0
"""A limit that is none."""

WEDGE = np.radians(150)
"""The largest angle between two neighbours between which a fillet is looked for; beyond, they nearly run through."""


@dataclass(frozen=True)
class Neighbour:
    """A contact as the measures see it, in the user's units and relative to the centre.

    `mean` is the mean point of its curve, `radius` the largest distance from that, `curvature` the largest principal
    curvature of its surface on the curve, `across` the largest of the other one in size, `curve`
    (m, 3) points of it, `normals` (m, 3) the unit normals of its surface there.  `normal` (3,) is that of a surface
    through which the region is open, as of a plate, in the mean over its curve; None for others.
    """

    mean: Floats
    radius: float
    curvature: float
    across: float
    curve: Floats
    normals: Floats
    normal: Floats | None = None

    @property
    def distance(self) -> float:
        """From the centre to the mean point of the curve."""
        return float(np.linalg.norm(self.mean))


@dataclass(frozen=True)
class FairnessLimits:
    """The measures up to which a surface counts as fair; see `Fairness`."""

    sharpness: float = 1.02
    hollowness: float = 1.5
    bulge: float = 0.05
    wrong_sign: float = 0.2
    waist: float = WAIST

    def __post_init__(self) -> None:
        set_fields(self, **{name: to_float(amount(value, name)) for name, value in vars(self).items()})

    @property
    def told(self) -> str:
        """The limits in words, those that are none left out."""
        names = {name: name.replace("_", " ") for name in vars(self)}
        return ", ".join(f"{names[n]} {most:.4g}" for n, most in vars(self).items() if most < LOOSE) or "there are none"

    @classmethod
    def of_order(cls, order: int) -> FairnessLimits:
        """The usual ones for contact GC^order: what the best members of the lowest degrees reach."""
        order = check_order(order)
        return cls(1.02 if order < 3 else 1.05, {1: 1.6, 2: 1.5}.get(order, 1.8))

    @classmethod
    def of_node(cls, order: int, neighbours: Sequence[Neighbour]) -> FairnessLimits:
        """The usual ones around neighbours in any directions.

        They leave room for arcs of the radius `largest_arc` only, beside which no fillet can be flatter; where walls
        meet beyond their clips they leave none, and only the bulge is limited, as where all nearly run through.
        Sections across no plane of symmetry may bend either way.
        """
        fillet, hollowness, bulge = 1.5, 1.6, 0.1  # the first over the sharpness of the tightest arc
        usual = cls.of_order(order)
        arc = largest_arc(neighbours)
        if not arc:
            return cls(LOOSE, LOOSE, bulge, LOOSE)
        tightest = 1 / (arc * sharpest_of(neighbours))
        sharp = max(NODE_SHARPNESS, fillet * tightest)
        return cls(sharp, max(usual.hollowness, hollowness), bulge, LOOSE)


def check_limits(limits: Any) -> FairnessLimits:
    """The limits, checked; raises `TypeError` for anything else."""
    if not isinstance(limits, FairnessLimits):
        raise TypeError(f"limits must be pas.FairnessLimits(...), not {shown(limits)}")
    return limits


@lru_cache(maxsize=32)
def neighbour(join: Join, scale: float) -> Neighbour:
    """A contact as the measures see it; `join` is in local coordinates, a unit of which is `scale` of the user's."""
    shared = 192  # subdivisions of all clip faces together: chords of a coarser curve would look like bulges
    subdivisions = ceil(shared / max(2, len(join.faces)))
    sizes = [np.ptp(join.partition.points[list(face.vertices)], axis=0).max() for face in join.faces] or [1.0]
    measured = zip(sizes, join.measured_curves(subdivisions), strict=True)
    parts = [(points, weights * size) for size, (points, weights) in measured]
    curve, weights = (np.concatenate(p) for p in zip(*parts, strict=True))
    contact = join.contact.surface
    jets = derivative_batch([contact.dense(contact.degree)], range(4))
    found = Geometry(jets(curve, np.zeros(len(curve), dtype=np.intp)))
    mean = weights @ curve / weights.sum()
    return Neighbour(
        mean * scale,
        float(np.linalg.norm(curve - mean, axis=1).max()) * scale,
        float(np.abs(found.principal).max()) / scale,
        float(np.abs(found.principal).min(axis=1).max()) / scale,
        curve * scale,
        found.normals,
        unit(found.normals.mean(axis=0)) if join.opening else None,
    )


def widest(neighbours: Sequence[Neighbour]) -> float:
    """The largest radius of neighbours, plates left out where there are others."""
    return max([n.radius for n in neighbours if n.normal is None] or [n.radius for n in neighbours])


def sharpest_of(neighbours: Sequence[Neighbour]) -> float:
    """The largest curvature of neighbours; where all are flat, that of the largest radius."""
    return max(n.curvature for n in neighbours) or 1 / widest(neighbours)


def largest_arc(neighbours: Sequence[Neighbour]) -> float:
    """The largest radius of an arc tangent to the walls of two neighbours within their clips: the least of all pairs.

    For pipes along directions at an angle t: the walls meet at (r_j + r_i cos t) / sin t along axis i, and an arc with
    tangents of length l has radius l tan(t / 2).  It is 0, for none, where no two are within `WEDGE`, and where two
    walls meet beyond their clips.  What the region is open through is taken for a plate, see `_out_of_plate`.
    """
    found = inf
    for a, b in combinations(neighbours, 2):
        if a.normal is not None or b.normal is not None:
            found = min(found, _out_of_plate(a, b) if a.normal is not None else _out_of_plate(b, a))
            continue
        cosine = float(a.mean @ b.mean) / (a.distance * b.distance)
        angle = float(np.arccos(np.clip(cosine, -1, 1)))
        if not 0.05 < angle < WEDGE:
            continue
        tangents = [
            one.distance - (other.radius + one.radius * cosine) / np.sin(angle) for one, other in ((a, b), (b, a))
        ]
        found = min(found, min(tangents) * float(np.tan(angle / 2)))
    return float(found) if 0 < found < inf else 0.0


def _out_of_plate(plate: Neighbour, pipe: Neighbour) -> float:
    """The radius of the largest arc tangent to a plate within its curve and to the wall of a pipe within its clip.

    On the side to which a pipe leans by t from the plate's normal the two make an angle of pi/2 - t: the wall meets the
    plate at r / cos t from the axis, and r tan t above the axis' end.
    """
    assert plate.normal is not None
    up = float((pipe.mean - plate.mean) @ plate.normal)
    away = pipe.mean - plate.mean - up * plate.normal
    axis = pipe.mean  # seen straight through the plate from the centre
    lean = float(np.arccos(np.clip(axis @ plate.normal / np.linalg.norm(axis), -1, 1)))
    part = axis - (axis @ plate.normal) * plate.normal
    length = float(np.linalg.norm(part))
    foot = away - (up * np.tan(lean) * (part / length) if length > 1e-12 else 0.0)
    least = float(np.linalg.norm(plate.curve - plate.mean, axis=1).min())
    tangent = min(
        least - float(np.linalg.norm(foot)) - pipe.radius / np.cos(lean), up / np.cos(lean) - pipe.radius * np.tan(lean)
    )
    return tangent * float(np.tan((np.pi / 2 - lean) / 2))
