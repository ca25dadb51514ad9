"""Boundaries of blends: a curve C(s), 0 <= s <= 1, with the tangent plane of a surface along it.

The plane is given by the surface's normal N(s) or by a vector V(s) that spans it together with C'(s); the curve
and its surface may come from anywhere: implicit, parametric, transcendental, sampled.  Where curve and field are
rational functions over Q they are kept exactly, so that a blend's contact can be proved.

Guaranteed: C' and the field are checked not to vanish, the curve to lie on its surface and, if closed, to close
with one sense of the normal: by exact identities and roots for exact data, else at samples.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.callables import texts_of
from pas.algebra.expressions import as_text
from pas.algebra.inputs import short, shown
from pas.algebra.lengths import lengths, unit
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, cross, plain, rational
from pas.algebra.rational_function import PARAMETERS, RationalFunction
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.parametric.generatrix.paths import (
    CHECKED,
    NAMES,
    Curve,
    CurveLike,
    ExactCurve,
    by_length,
    closes,
    on_unit_interval,
    read_path,
    require_boundary,
    require_on,
    splined,
    value_at,
)
from pas.parametric.generatrix.quadric import within_reach
from pas.parametric.series import composed
from pas.parametric.surface import ParametricSurface, SurfaceCurve


@dataclass(frozen=True)
class ContactBounds:
    """Bounds for all s of a curve in closed form: of the `angle` (radians) between C' and the surface's tangent plane,
    and of the `distance` |f| / |grad f| from the surface."""

    angle: float
    distance: float


@dataclass(frozen=True, eq=False)
class Boundary:
    """A curve with the tangent planes of its surface.

    `curve`, `velocity` (C') and `direction` (N where `has_normal`, else V) take parameters (n,) in [0, 1] and
    return (n, 3).  `side` (1 or -1) says on which side of the curve the blend lies, N x C' (or V) times
    `side` pointing there; None leaves it to the blend.  `name` stands in messages, `exact` holds the rational
    curve and field where there are such, `bounds` makes what is known of a curve in closed form.  The blend's
    parameter s is brought to the curve's own by `phase + s`, or `phase - s` where `backwards`, modulo 1 for closed
    curves.  `surface` is what the curve lies on, where that is known; for a parametric one `parameters` are the pairs
    (n, 2) along the curve.  `source` is the table from which `pas.boundary_from` makes it, without its side; None for
    callables and samples, which no file keeps.

    Raises `GeometryError` where the curve stops, the field vanishes or is along the curve, or a curve called
    closed is not.
    """

    curve: Curve
    velocity: Curve
    direction: Curve
    has_normal: bool
    closed: bool
    name: str = "the boundary"
    exact: ExactCurve | None = None
    side: int | None = None
    bounds: Callable[[], ContactBounds] | None = None
    phase: float = 0.0
    backwards: bool = False
    surface: Polynomial | ParametricSurface | None = None
    parameters: Curve | None = None
    source: Mapping[str, Any] | None = field(default=None, repr=False)
    checked: bool = field(default=False, repr=False)

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.side not in (None, 1, -1):
            raise ValueError(f"side of {self.name} must be 1, -1 or None, not {shown(self.side)}")
        if not self.closed and (self.phase, self.backwards) not in ((0.0, False), (1.0, True)):
            raise ValueError(
                f"{self.name} is open: it starts at 0, or at 1 and runs backwards, not at {shown(self.phase)}"
            )
        if not self.checked:
            if self.exact is not None:
                self.exact.require_regular(self.name)
            require_boundary(self.name, self.curve, self.velocity, self.direction, self.has_normal, self.closed)
            object.__setattr__(self, "checked", True)

    @classmethod
    def along(
        cls,
        curve: CurveLike,
        normal: CurveLike | None = None,
        tangent: CurveLike | None = None,
        interval: Sequence[Exact] = (0, 1),
        closed: bool | None = None,
        name: str | None = None,
        side: int | None = None,
    ) -> Boundary:
        """Any curve with the normal of its surface, or with a tangent vector of it that is not along the curve.

        Each of the three is a triple of expressions in s, or one callable from (n,) to (n, 3); `interval` is that
        of s.  `closed` None: as it is found to be.
        """
        given, told, name = normal if tangent is None else tangent, name, name or "the boundary"
        if given is None or (normal is not None and tangent is not None):
            raise ValueError(f"{name}: give exactly one of normal and tangent")
        path, vectors = read_path(curve, interval, name), read_path(given, interval, f"{name}, its vectors")
        exact = None
        if path.is_exact and vectors.is_exact:
            exact = ExactCurve(path.components, vectors.components, tangent is None)
        field: Curve = lambda s: value_at(vectors, s)  # noqa: E731
        needs = {"curve": texts_of(curve, NAMES), "normal" if tangent is None else "tangent": texts_of(given, NAMES)}
        known: dict[str, Any] = {"exact": exact, "source": source_of(needs, interval, closed=closed, name=told)}
        return part(*_along(path), field, closed=closed, name=name, has_normal=tangent is None, side=side, **known)

    @classmethod
    def on_implicit(
        cls,
        polynomial: PolynomialLike,
        curve: CurveLike,
        interval: Sequence[Exact] = (0, 1),
        closed: bool | None = None,
        name: str | None = None,
        side: int | None = None,
    ) -> Boundary:
        """A curve on the surface `polynomial` = 0, given as for `along`.

        Raises `GeometryError` where it does not lie on it: exactly for rational curves.
        """
        f = within_reach(Polynomial(polynomial))
        needs = {"implicit": as_text(polynomial) or str(f), "curve": texts_of(curve, NAMES)}
        source = source_of(needs, interval, closed=closed, name=name)
        name = f"the boundary on {short(str(f))} = 0" if name is None else name
        path = read_path(curve, interval, name)
        exact = None
        if path.is_exact:
            residual = composed(f, path.components)
            if not residual.is_zero:
                raise GeometryError(f"{name}: the curve does not lie on the surface; there {f} is {residual}")
            x, y, z = (composed(f.diff(i), path.components) for i in range(3))
            exact = ExactCurve(path.components, (x, y, z), True)
        else:
            require_on(f, path, name)
        field: Curve = lambda s: f.gradient(value_at(path, s))  # noqa: E731
        return part(*_along(path), field, closed=closed, name=name, exact=exact, side=side, surface=f, source=source)

    @classmethod
    def on_parametric(
        cls,
        curve: SurfaceCurve,
        interval: Sequence[Exact] = (0, 1),
        closed: bool | None = None,
        name: str | None = None,
        side: int | None = None,
    ) -> Boundary:
        """A curve on a parametric surface, such as `iso_curve(surface, h=1)`, over an interval of its parameter."""
        if not isinstance(curve, SurfaceCurve):
            raise TypeError(f"curve must be a SurfaceCurve, made by iso_curve or SurfaceCurve, not {shown(curve)}")
        told, name = name, name or "the boundary on a parametric surface"
        ends, line = on_unit_interval(interval, name)
        low, high = ends
        curve.surface(curve.parameters(low + (high - low) * CHECKED))  # speaks up outside the domain
        exact = None
        if curve.surface.is_exact and curve.exact_path is not None:
            t, h = (RationalFunction(p, NAMES).substitute(line, line) for p in curve.exact_path)
            first, second = ([c.diff(*o).substitute(t, h) for c in curve.surface.components] for o in ((1, 0), (0, 1)))
            x, y, z = (c.substitute(t, h) for c in curve.surface.components)
            exact = ExactCurve((x, y, z), cross(first, second), True)

        def field(s: Floats) -> Floats:
            tangents = curve.surface.tangents(curve.parameters(s))
            return np.cross(tangents[..., 0, :], tangents[..., 1, :])

        parameters: Curve = lambda s: curve.parameters(low + (high - low) * s)  # noqa: E731
        source = source_of(_on_surface(curve), interval, closed=closed, name=told)
        known: dict[str, Any] = {"exact": exact, "surface": curve.surface, "parameters": parameters, "source": source}
        return part(curve, curve.derivative, field, ends, closed=closed, name=name, side=side, **known)

    @classmethod
    def from_points(
        cls,
        points: ArrayLike,
        normals: ArrayLike,
        closed: bool = False,
        name: str = "the sampled boundary",
        side: int | None = None,
    ) -> Boundary:
        """A curve through points (n, 3) with the surface's normals (n, 3) there.

        Both are interpolated by cubic splines (periodic for closed curves, whose first point is not to be
        repeated, else natural) over the chords' lengths; the normals between are then made perpendicular to the curve.
        """
        return cls(*splined(points, normals, closed, name), True, closed, name, None, side)

    def own(self, s: ArrayLike) -> Floats:
        """The curve's own parameters at the blend's `s` (...)."""
        values = np.asarray(s, dtype=float)
        moved = self.phase - values if self.backwards else self.phase + values
        return moved % 1.0 if self.closed else np.clip(moved, 0.0, 1.0)

    def __call__(self, s: ArrayLike) -> Floats:
        """Points at `s` (...): (..., 3)."""
        return self._shaped(self.curve, s)

    def derivative(self, s: ArrayLike) -> Floats:
        """C'(s) at `s` (...): (..., 3)."""
        return self._shaped(self.velocity, s) * (-1.0 if self.backwards else 1.0)

    def field(self, s: ArrayLike) -> Floats:
        """N(s) or V(s) as given, at `s` (...): (..., 3)."""
        return self._shaped(self.direction, s)

    def normals(self, s: ArrayLike) -> Floats:
        """Unit normals of the surface at `s` (...): (..., 3)."""
        given = self.field(s)
        return unit(given if self.has_normal else np.cross(given, self._shaped(self.velocity, s)))

    def across(self, s: ArrayLike) -> Floats:
        """Tangent vectors across the curve, N x C' or V, at `s` (...): (..., 3); not unit vectors.

        They do not turn over with the direction of the curve.
        """
        given = self.field(s)
        return np.cross(given, self._shaped(self.velocity, s)) if self.has_normal else given

    def turned(self, backwards: bool, shift: float) -> Boundary:
        """The curve run through the other way and, if closed, from another start, `shift` of a turn on."""
        if shift and not self.closed:
            raise ValueError(f"{self.name} is not closed, so its start cannot be moved")
        start = self.phase + (-shift if self.backwards else shift)
        if backwards and not self.closed:
            start = 0.0 if self.backwards else 1.0
        return replace(self, phase=start, backwards=self.backwards != backwards)

    def by_length(self) -> Boundary:
        """The curve with s the share of its length (to about 1e-6; smooth).  It is not kept exactly.

        The curve and its tangent planes stay as they are, so bounds on them hold on.
        """
        if self.source is not None and self.source.get("by_length"):
            return self  # it is already
        place, speed = by_length(lambda s: lengths(self.velocity(s)), self.closed)
        parameters = self.parameters
        return replace(
            self,
            curve=lambda s: self.curve(place(s)),
            velocity=lambda s: self.velocity(place(s)) * speed(s)[:, None],
            direction=lambda s: self.direction(place(s)),
            exact=None,
            parameters=None if parameters is None else lambda s: parameters(place(s)),
            source=None if self.source is None else {**self.source, "by_length": True},
        )

    def _shaped(self, function: Curve, s: ArrayLike) -> Floats:
        own = self.own(s)
        return np.asarray(function(own.ravel()), dtype=float).reshape(*own.shape, 3)


def part(
    curve: Curve,
    velocity: Curve,
    direction: Curve,
    ends: tuple[float, float] = (0.0, 1.0),
    closed: bool | None = None,
    has_normal: bool = True,
    **others: Any,
) -> Boundary:
    """The part of a curve between two of its parameters; `closed` None: as it is found to be."""
    low, width = ends[0], ends[1] - ends[0]
    shut = closes(curve(low + width * CHECKED)) if closed is None else closed
    return Boundary(
        lambda s: curve(low + width * s),
        lambda s: width * velocity(low + width * s),
        lambda s: direction(low + width * s),
        has_normal,
        shut,
        **others,
    )


def _along(path: ParametricSurface) -> tuple[Curve, Curve]:
    """C and C' of a path."""
    return lambda s: value_at(path, s), lambda s: value_at(path, s, 1)


def source_of(needs: Mapping[str, Any], interval: Sequence[Exact] | None, **more: Any) -> dict[str, Any] | None:
    """The table of a boundary, with what is not as usual; None where something that it needs has no text."""
    part_of = () if interval is None or tuple(interval) == (0, 1) else interval
    ends = [plain(rational(end)) for end in part_of] or None
    given = {key: value for key, value in {"interval": ends, **more}.items() if value is not None}
    return None if None in needs.values() else {**needs, **given}


def _on_surface(curve: SurfaceCurve) -> dict[str, Any]:
    """The entries of a table for a curve on a surface, in t, h and s whatever its parameters are called if exact."""
    surface = curve.surface
    formulas = surface.text if surface.parameters == PARAMETERS else None
    texts: Any = texts_of(surface.components if surface.is_exact else formulas, PARAMETERS) or [None] * 3
    path = texts_of(curve.exact_path or (curve.texts if curve.parameter == NAMES[0] else None), NAMES)
    domain = [[None if end is None else str(end) for end in ends] for ends in surface.ends]
    return {**dict(zip("xyz", texts, strict=True)), "path": path, "domain": domain}
