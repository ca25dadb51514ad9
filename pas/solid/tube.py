"""Tubes: all points up to a radius from a curve given by formulas.

The distance from the curve is found by Newton's method from the nearest of many samples; it is accurate
to rounding as long as the radius is below the curve's radius of curvature, which is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from flint import fmpq
from scipy.interpolate import BSpline, make_interp_spline
from scipy.spatial import cKDTree

from pas.algebra.callables import component
from pas.algebra.inputs import check_count, whole
from pas.algebra.jets import Jet, variables
from pas.algebra.lengths import across, arc_lengths
from pas.algebra.rational import Exact, Symbolic, plain, positive, rational, to_float
from pas.arrays import Bools, Floats
from pas.errors import GeometryError
from pas.mesh.shading import unit_rows
from pas.solid.functions import Distance, Parametrized
from pas.solid.solid import Solid
from pas.solid.tree import Atom, combined

SAMPLES = 512
"""The least number of samples of a curve."""


class TubeCurve:
    """A curve `t -> (x(t), y(t), z(t))` on an interval, with its nearest points.

    `formulas` are three strings in t (sympy expressions, numbers).
    """

    def __init__(self, formulas: Sequence[Any], interval: Sequence[Any]) -> None:
        check_count(formulas, 3, "curve must be three formulas in t, such as ('cos(t)', 'sin(t)', 't/10')")
        self.formulas = tuple(str(f) for f in formulas)
        self._parts = [
            component(f, ("t", ""), f"the curve's {n}").formula for f, n in zip(formulas, "xyz", strict=True)
        ]
        check_count(interval, 2, "interval must be two rising numbers, such as (0, 1)")
        low, high = (rational(end, "an end of the interval") for end in interval)
        if low >= high:
            raise ValueError(f"interval must be two rising numbers, not {plain(low)} and {plain(high)}")
        self.exact_interval = (low, high)
        self.interval = (to_float(low), to_float(high))

    def jets(self, t: Floats) -> Floats:
        """Points, first and second derivatives at t (N,): (3, N, 3); beyond the interval those of parabolas."""
        inside = np.clip(t, *self.interval)
        point, slope, bend = self._jets(inside)
        beyond = (t - inside)[:, None]
        return np.stack([point + beyond * slope + beyond**2 / 2 * bend, slope + beyond * bend, bend])

    def _jets(self, t: Floats) -> Floats:
        line, _ = variables(t, np.zeros_like(t), (2, 0))
        result = np.zeros((3, len(t), 3))
        for axis, formula in enumerate(self._parts):
            with np.errstate(all="ignore"):
                part = formula(line, 0.0)
            for k in range(3 if isinstance(part, Jet) else 1):
                result[k, :, axis] = part.derivative(k, 0) if isinstance(part, Jet) else part
        if not np.isfinite(result).all():
            bad = float(t[~np.isfinite(result).all(axis=(0, 2))][0])
            raise GeometryError(f"the curve ({', '.join(self.formulas)}) is not defined or not smooth at t = {bad:.6g}")
        return result

    @cached_property
    def ends(self) -> tuple[Floats, Floats]:
        """Points (2, 3) and unit tangents (2, 3) at the two ends."""
        points, slopes, _ = self.jets(np.array(self.interval))
        return points, unit_rows(slopes)

    @cached_property
    def is_closed(self) -> bool:
        """Whether the curve ends where and in the direction in which it starts."""
        points, tangents = self.ends
        extent = float(np.ptp(self.jets(np.linspace(*self.interval, SAMPLES))[0], axis=0).max())
        apart = float(np.linalg.norm(points[1] - points[0]))
        return apart < 1e-9 * extent and float(tangents[0] @ tangents[1]) > 1 - 1e-9  # formulas are rounded

    def sampled(self, step: float) -> Floats:
        """Parameters (n,) whose points are about `step` apart, but no more than 131,072."""
        t = np.linspace(*self.interval, SAMPLES)
        speed = np.linalg.norm(self.jets(t)[1], axis=1)
        length = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(t))])
        count = int(np.clip(length[-1] / step, SAMPLES, 1 << 17))
        return np.interp(np.linspace(0, length[-1], count), length, t)


class Tube(Distance, Parametrized):
    """The distance from a curve less a radius; unless ends are `round` the curve is extended a little."""

    def __init__(self, curve: TubeCurve, radius: Any, round: bool = True) -> None:
        self.curve, self.exact_radius, self.round = curve, _radius(radius), round
        positive(self.exact_radius, "radius")
        self.radius = to_float(self.exact_radius)
        self.parameters = curve.sampled(self.radius / 16)
        if not round and not curve.is_closed:
            first, last = np.diff(self.parameters)[[0, -1]]
            (start, end), more = curve.interval, np.array([1, 2, 3, 4])
            self.parameters = np.concatenate([start - first * more[::-1], self.parameters, end + last * more])
        points, slopes, bends = curve.jets(self.parameters)
        speed = np.linalg.norm(slopes, axis=1)
        turned = (slopes[1:] * slopes[:-1]).sum(axis=1) <= 0
        if (speed < 1e-12 * speed.max()).any() or turned.any():
            at = self.parameters[turned.argmax() if turned.any() else speed.argmin()]
            raise GeometryError(f"the curve stops or turns back at t = {at:.6g}; its derivative must not vanish")
        curvature = np.linalg.norm(np.cross(slopes, bends), axis=1) / speed**3
        worst = int(curvature.argmax())
        if curvature[worst] * self.radius >= 1:
            raise GeometryError(
                f"the tube folds over at t = {self.parameters[worst]:.6g}: its radius {self.radius:.6g} must be below "
                f"the curve's radius of curvature there, {1 / curvature[worst]:.6g}"
            )
        self._table, self._tree = (points, slopes, bends), cKDTree(points)
        # parameters are that of the curve, and the angle around it
        self.domain = np.array([curve.interval, (0.0, 2 * np.pi)])
        self.periods = np.array([np.ptp(curve.interval) * curve.is_closed, 2 * np.pi])
        if round and not curve.is_closed:
            (start, end), ways = curve.ends
            self.caps = (start, -ways[0], self.radius), (end, ways[1], self.radius)

    def jets(self, points: Floats) -> Floats:
        _, nearest = self.nearest(points)
        away = points - nearest
        distance = np.linalg.norm(away, axis=1)
        gradient = away / np.maximum(distance, 1e-300)[:, None]
        return np.concatenate([(distance - self.radius)[:, None], gradient], axis=1)

    def nearest(self, points: Floats) -> tuple[Floats, Floats]:
        """The parameters (N,) of the nearest points of the curve, and these points (N, 3).

        By eight steps of Newton's method at most, from the nearest of samples a 16th of the radius apart.
        """
        _, index = self._tree.query(points)
        last = len(self.parameters) - 1
        low, high = self.parameters[np.maximum(index - 1, 0)], self.parameters[np.minimum(index + 1, last)]
        start, t = self.parameters[index], self.parameters[index]
        kept, d, d2 = (table[index] for table in self._table)
        p = kept
        for _ in range(8):
            away, square = p - points, (d * d).sum(axis=1)
            slope = np.maximum(square + (away * d2).sum(axis=1), square * 1e-3)
            before, t = t, np.clip(t - (away * d).sum(axis=1) / slope, low, high)
            p, d, d2 = self.curve.jets(t)
            if np.abs(t - before).max(initial=0.0) < 1e-12 * (self.parameters[-1] - self.parameters[0]):
                break
        worse = ((p - points) ** 2).sum(axis=1) > ((kept - points) ** 2).sum(axis=1)
        return np.where(worse, start, t), np.where(worse[:, None], kept, p)

    def places(self, points: Floats) -> Floats:
        """The parameters of the nearest points of the curve, and the angles there (N, 2)."""
        t, nearest = self.nearest(points)
        _, first, second = self._frames(t)
        x, y = (((points - nearest) * way).sum(axis=1) for way in (first, second))
        return np.stack([t, np.arctan2(y, x)], axis=1)

    def at(self, places: Floats) -> Floats:
        """Its points (N, 3) at parameters of the curve and angles (N, 2)."""
        center, first, second = self._frames(places[:, 0])
        x, y = self.radius * np.cos(places[:, 1:]), self.radius * np.sin(places[:, 1:])
        return np.asarray(center + x * first + y * second)

    def _frames(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Points of the curve and two unit vectors across it, each (N, 3), at parameters (N,)."""
        low, high = self.curve.interval
        t = low + (t - low) % (high - low) if self.curve.is_closed else t
        points, slopes, _ = self.curve.jets(t)
        tangents, normals = unit_rows(slopes), self._normals(t)
        first = unit_rows(normals - (normals * tangents).sum(axis=1, keepdims=True) * tangents)
        return points, first, np.cross(tangents, first)

    @cached_property
    def _normals(self) -> BSpline:
        """Vectors nearly across the curve, by its parameter, that turn around it as little as may be.

        Each is turned with the tangents from one sample to the next (Bishop 1975), on closed curves a little more.
        """
        t = np.linspace(*self.curve.interval, len(self.parameters))
        tangents = unit_rows(self.curve.jets(t)[1])
        sines = np.cross(tangents[:-1], tangents[1:])
        skew = np.cross(np.eye(3), sines[:, None])
        turns = np.eye(3) + skew + skew @ skew / (1 + (tangents[1:] * tangents[:-1]).sum(axis=1))[:, None, None]
        done = 1
        while done < len(turns):  # products of twice as many, until each has all before it
            turns[done:] = turns[done:] @ turns[:-done]
            done *= 2
        start = across(tangents[0])
        normals = np.concatenate([start[:1], turns @ start[0]])
        if not self.curve.is_closed:
            return make_interp_spline(t, normals, k=5)
        lag = np.arctan2(normals[-1] @ start[1], normals[-1] @ start[0]) * np.linspace(0, 1, len(t))[:, None]
        normals = np.cos(lag) * normals - np.sin(lag) * np.cross(tangents, normals)
        normals[-1] = normals[0]
        return make_interp_spline(t, normals, k=5, bc_type="periodic")

    def to_record(self) -> dict[str, Any]:
        return {
            "curve": list(self.curve.formulas),
            "interval": [plain(c) for c in self.curve.exact_interval],
            "radius": plain(self.exact_radius),
        } | ({} if self.round else {"round": False})

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Tube:
        return cls(TubeCurve(record["curve"], record["interval"]), record["radius"], record.get("round", True))


def _radius(given: Any) -> fmpq:
    try:
        return rational(given, "radius")
    except (TypeError, ValueError) as error:
        hint = "a tube of a radius that varies is pas.tube(...).solid()"
        raise type(error)(f"{error}; {hint}") from None


class TubeEnd(Distance):
    """How far points of a tube are beyond its flat start (side 0) or end (1); negative along the tube."""

    def __init__(self, tube: Tube, side: int) -> None:
        self.tube, self.side = tube, side
        points, tangents = tube.curve.ends
        self._point, self._outwards = points[side], tangents[side] * (2 * side - 1)
        self.plane = self._point, self._outwards

    def jets(self, points: Floats) -> Floats:
        # another strand of the tube may pass this end; the plane cuts only its own
        far = 2 * self.tube.radius
        near = np.flatnonzero(np.linalg.norm(points - self._point, axis=1) < far)
        parameters = self.tube.nearest(points[near])[0]
        near = near[np.abs(np.interp(parameters, self.tube.parameters, self._lengths)) < far]  # along the curve
        result = np.concatenate([np.zeros((len(points), 1)), np.broadcast_to(self._outwards, points.shape)], axis=1)
        result[:, 0] = -self.tube.radius
        result[near, 0] = (points[near] - self._point) @ self._outwards
        return result

    @cached_property
    def _lengths(self) -> Floats:
        lengths = arc_lengths(self.tube.curve.jets(self.tube.parameters)[0])
        return lengths[-1] - lengths if self.side else lengths

    def decided(self, centers: Floats, halves: Floats) -> tuple[Bools, Bools]:
        """Certainly <= 0 in boxes far from the end; never certainly > 0."""
        reach = np.linalg.norm(halves, axis=1)
        away = np.linalg.norm(centers - self._point, axis=1) - reach
        return away > 2 * self.tube.radius, np.zeros(len(centers), dtype=bool)

    def to_record(self) -> dict[str, Any]:
        return {"tube": self.tube.to_record(), "side": self.side}

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> TubeEnd:
        return cls(Tube.from_record(record["tube"]), whole(record["side"], "side", 0, 1))


def tube(
    curve: Sequence[str | Symbolic | Exact],
    radius: Exact,
    interval: Sequence[Exact],
    face: str = "tube",
    ends: str = "flat",
) -> Solid:
    """The points up to `radius` (the model's units) from a curve: three formulas in t on an interval.

    `ends` are "flat" (faces "tube start" and "tube end") or "round"; a closed curve has none.  Raises
    `GeometryError` where the radius is not below the curve's radius of curvature or the curve stops, `ValueError` for a
    radius that is not positive or other ends.

        solid.tube(("cos(t)", "sin(t)", "t/10"), "1/8", (0, 20))
    """
    if ends not in ("flat", "round"):
        raise ValueError(f"ends must be 'flat' or 'round', not {ends!r}")
    shape = Tube(TubeCurve(curve, interval), radius, ends == "round")
    parts = [Atom(shape, face)]
    if ends == "flat" and not shape.curve.is_closed:
        parts += [Atom(TubeEnd(shape, side), f"{face} {name}") for side, name in enumerate(("start", "end"))]
    return Solid(combined(False, *parts))
