"""Parameters of charts on planes, quadrics of revolution and tori, as CAD programs have them.

Angles are counted from a direction that the chart does not reach, so that they are continuous on it; a chart that goes
all the way around is divided through the axis first, and the halves are joined again once all is made.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pas.algebra.lengths import across, spiral
from pas.arrays import Floats
from pas.exchange.step.carriers import Carrier, CarrierKind, Plane
from pas.exchange.step.charts import ON_PLANE
from pas.exchange.step.parametrized import PlacedSurface

GAP = 0.5
"""The angle, in radians, that a chart must leave free around an axis, so that they do not close; half of it is
how far the poles of a sphere are kept away."""


@dataclass(frozen=True)
class CarrierParameters:
    """The parameters of a surface from `axis` (3,) and `start` (3,), unit and orthogonal; both angles from 0.

    Of planes they are lengths, of cylinders angle and height, of cones angle and distance from the apex along the
    surface, of spheres azimuth and latitude, of tori the angles around the axis and around the tube.  `height` is where
    a cone's circle of reference is, along the axis.
    """

    carrier: Carrier
    axis: Floats
    start: Floats
    tube: float = 0.0
    height: float = 1.0

    def uv(self, points: Floats) -> Floats:
        """The parameters (N, 2) of points (N, 3)."""
        moved = points - self.carrier.place
        x, y, z = moved @ self.start, moved @ np.cross(self.axis, self.start), moved @ self.axis
        kind = self.carrier.kind
        if kind is CarrierKind.PLANE:
            return np.stack([x, y], axis=1)
        angle, radius = np.arctan2(y, x) % math.tau, np.hypot(x, y)
        if kind is CarrierKind.CYLINDER:
            return np.stack([angle, z], axis=1)
        if kind is CarrierKind.SPHERE:
            return np.stack([angle, np.arctan2(z, radius)], axis=1)
        if kind is CarrierKind.CONE:
            slope = np.hypot(1.0, self.carrier.radius)
            return np.stack([angle, (z - self.height) * slope], axis=1)
        around = (np.arctan2(z, radius - self.carrier.radius) - self.tube) % math.tau + self.tube
        return np.stack([angle, around], axis=1)


def carrier_parameters(carrier: Carrier, points: Floats, corners: Floats) -> CarrierParameters | Plane:
    """Parameters for a chart with points (N, 3), or the plane that divides it where it goes all the way around.

    The plane keeps away from `corners` (K, 3), those points of it where several charts meet.
    """
    axis, moved = carrier.axis, points - carrier.place
    if carrier.kind is CarrierKind.PLANE:
        return CarrierParameters(carrier, axis, across(axis)[0])
    if carrier.kind is CarrierKind.SPHERE:
        return _on_sphere(carrier, moved)
    first, second = across(axis)
    gap, start = free(_angles(moved, axis, first))
    height = moved @ axis
    if gap < GAP:
        _, turn = free(_angles(corners - carrier.place, axis, first), math.tau / 2)
        normal = np.cos(turn) * second - np.sin(turn) * first
        return Plane.of(normal, normal @ carrier.place)
    begin = np.cos(start) * first + np.sin(start) * second
    if carrier.kind is CarrierKind.TORUS:
        radii = np.linalg.norm(moved - height[:, None] * axis, axis=1) - carrier.radius
        gap, tube = free(np.arctan2(height, radii))
        if gap < GAP:
            return Plane.of(
                axis, float(axis @ carrier.place) + 0.0371 * carrier.minor
            )  # where nothing else is expected
        return CarrierParameters(carrier, axis, begin, tube)
    if carrier.kind is CarrierKind.CONE and height.mean() < 0:
        axis, height = -axis, -height
    return CarrierParameters(carrier, axis, begin, height=float(height.max()))


def _on_sphere(carrier: Carrier, moved: Floats) -> CarrierParameters | Plane:
    """Parameters with poles that a chart is away from, or a plane through the centre."""
    directions = spiral(120)[:60]  # half of the sphere
    units = moved / np.linalg.norm(moved, axis=1, keepdims=True)
    cosines = np.abs(units @ directions.T)
    for pole in np.argsort(np.round(cosines.max(axis=0), 6), kind="stable"):
        if cosines[:, pole].max() > np.cos(GAP / 2):
            break
        axis = directions[pole]
        first, second = across(axis)
        gap, start = free(_angles(moved, axis, first))
        if gap >= GAP:
            begin = np.cos(start) * first + np.sin(start) * second
            return CarrierParameters(carrier, axis, begin)
    heights = units @ directions.T
    spread = np.minimum((heights > 0).mean(axis=0), (heights < 0).mean(axis=0)) + heights.std(axis=0)
    normal = directions[int(np.argmax(np.round(spread, 3)))]
    return Plane.of(normal, normal @ carrier.place)


def _angles(moved: Floats, axis: Floats, first: Floats) -> Floats:
    """Angles (N,) around an axis of points that are not on it."""
    x, y = moved @ first, moved @ np.cross(axis, first)
    return np.arctan2(y, x)[np.hypot(x, y) > ON_PLANE]


def free(angles: Floats, period: float = math.tau) -> tuple[float, float]:
    """The largest angle that is free of given ones (N,), and its middle."""
    if not len(angles):
        return period, 0.3183  # any will do; a round one could be that of something else
    ordered = np.sort(angles % period)
    gaps = np.diff(ordered, append=ordered[0] + period)
    most = int(np.argmax(np.round(gaps, 9)))
    return float(gaps[most]), float((ordered[most] + gaps[most] / 2) % period)


_FROM_VALUES = np.array([[0.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [0.5, -1.0, 0.5]])
"""Coefficients of a parabola, constant first, from its values at -1, 0 and 1."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SplinePatch:
    """A spline of a `degree` on a chart: `knots` are those of the two directions, `poles` (m, n, 3) the control points,
    with `weights` (m, n) where it is rational and exact.

    Of what is not exact `distance` is the largest from the function's zeros, in local coordinates, at many points.
    """

    degree: int
    knots: tuple[Floats, Floats]
    poles: Floats
    weights: Floats | None = None
    distance: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class SeenPatch(SplinePatch):
    """One over what is seen of a chart along the last row of `frame` (3, 3), with the others as axes.

    Rational patches of quadrics are seen from the point `origin` (3,), graphs of heights over the plane through it from
    far away.
    """

    origin: Floats
    frame: Floats

    def uv(self, points: Floats) -> Floats:
        """The parameters (N, 2) of points (N, 3)."""
        seen = (points - self.origin) @ self.frame.T
        return np.asarray(seen[:, :2] if self.weights is None else seen[:, :2] / seen[:, 2:])


@dataclass(frozen=True, eq=False, kw_only=True)
class ParametrizedPatch(SplinePatch):
    """One by the parameters of a surface, of which those that return are from `start` (2,) on."""

    surface: PlacedSurface
    start: Floats

    def uv(self, points: Floats) -> Floats:
        """The parameters (N, 2) of points (N, 3)."""
        uv = self.surface.unwound(self.surface.places(points), self.start)
        return np.clip(uv, *np.stack([(k[0], k[-1]) for k in self.knots], axis=1))  # its ends, to rounding


Parameters = CarrierParameters | SeenPatch | ParametrizedPatch


def quadric_patch(matrix: Floats, points: Floats, middle: Floats, normal: Floats) -> SeenPatch | None:
    """The patch of a quadric with symmetric matrix (4, 4) that has points (N, 3) on it, seen from opposite a middle.

    That is through the quadric's centre; where it has none, against the mean unit normal (3,).  None where no point of
    the quadric is there, or not all of the points are seen from it.
    """
    form, slope = matrix[:3, :3], matrix[:3, 3]
    sizes = np.linalg.svd(form, compute_uv=False)
    way = normal if sizes[-1] <= 1e-9 * sizes[0] else middle + np.linalg.solve(form, slope)
    way = way / max(float(np.linalg.norm(way)), 1e-300)
    value = middle @ form @ middle + 2 * middle @ slope + matrix[3, 3]
    rise, bend = -2 * way @ (form @ middle + slope), way @ form @ way
    under = rise * rise - 4 * bend * value
    if under < 0 or abs(bend) * float(np.ptp(points, axis=0).max()) < 1e-6 * abs(rise):
        return None  # there is none, or further away than a million times the chart's size
    roots = (-rise + np.array([1.0, -1.0]) * np.sqrt(under)) / (2 * bend)
    eye = middle - float(roots[int(np.argmax(np.abs(roots)))]) * way
    for _ in range(3):  # the point to the last digit
        gradient = 2 * (form @ eye + slope)
        eye = eye - (eye @ form @ eye + 2 * eye @ slope + matrix[3, 3]) / (gradient @ gradient) * gradient
    axis = (middle - eye) / np.linalg.norm(middle - eye)
    frame = np.stack([*across(axis), axis])
    seen = (points - eye) @ frame.T
    if seen[:, 2].min() <= 0.01 * np.linalg.norm(seen, axis=1).max():
        return None
    uv = seen[:, :2] / seen[:, 2:]
    room = 0.02 * float(np.ptp(uv, axis=0).max())  # by which a patch is larger than its chart
    low, high = uv.min(axis=0) - room, uv.max(axis=0) + room
    center, half = (low + high) / 2, (high - low) / 2
    sides = [c + h * np.array([-1, 0, 1]) for c, h in zip(center, half, strict=True)]
    ways = np.stack(np.meshgrid(*sides, indexing="ij"), -1) @ frame[:2] + axis
    bends = np.einsum("ijx,xy,ijy->ij", ways, form, ways)
    turned = ways @ (form @ eye + slope)
    both = np.concatenate([bends[..., None] * eye - 2 * turned[..., None] * ways, bends[..., None]], axis=2)
    coefficients = np.einsum("ik,jl,klx->ijx", _FROM_VALUES, _FROM_VALUES, both) * np.sign(bends[1, 1])
    for parts in (1, 2, 4, 8):  # spans a side, until all weights are positive, as CAD programs want them
        knots = np.concatenate([[-1.0, -1.0], np.linspace(-1, 1, parts + 1), [1.0, 1.0]])
        a, b = knots[1:-2], knots[2:-1]
        blossoms = np.stack([np.ones_like(a), (a + b) / 2, a * b], axis=1)  # of 1, u and u^2
        control = np.einsum("mi,nj,ijx->mnx", blossoms, blossoms, coefficients)
        weights = control[..., 3]
        if weights.min() > 1e-3 * weights.max():
            both_knots = (center[0] + half[0] * knots, center[1] + half[1] * knots)
            poles = control[..., :3] / weights[..., None]
            return SeenPatch(
                degree=2, knots=both_knots, poles=poles, weights=weights / weights.max(), origin=eye, frame=frame
            )
    return None
