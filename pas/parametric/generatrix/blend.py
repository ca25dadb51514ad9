"""The blend of two surfaces by a Bezier generatrix: one cubic (or quartic) segment for each s (see `form`).

What is proved and what only measured of it is said by its `certificate`.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, Unpack

import numpy as np

from pas.algebra.inputs import shown
from pas.algebra.polynomial import PolynomialLike
from pas.algebra.rational import Exact
from pas.errors import GeometryError, NotProvedError
from pas.limits import WorkLimits, checkpoint, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.parametric.generatrix.align import Alignment, aligned, alignment, require_apart, sides
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.form import Frames, GeneratrixForm, with_lengths
from pas.parametric.generatrix.paths import CurveLike, closes, space_curve, value_at
from pas.parametric.generatrix.sections import plane_section
from pas.parametric.generatrix.shape import GeneratrixShape, ShapeLike
from pas.parametric.generatrix.verdicts import GeneratrixCertificate, certify, is_safe
from pas.parametric.surface import ParametricSurface
from pas.shape import Shape


class GeneratrixBlend(GeneratrixForm, Shape):
    """A blend P(s, t): t = 0 is the first boundary, t = 1 the second.

    `frames` holds the boundaries, turned to fit, `shape` the shape functions, `alignment` how the second was turned.
    """

    kind = "generatrix blend"

    @classmethod
    def of_turned(
        cls,
        boundaries: tuple[Boundary, Boundary],
        signs: tuple[int, int],
        shape: GeneratrixShape,
        alignment: Alignment,
        unit: bool = True,
    ) -> GeneratrixBlend:
        """The blend of boundaries that are turned to fit already; `signs` are those of N x C' (or V) towards it.

        Lengths that `shape` leaves open are filled in.  Raises as `generatrix_blend` does for shapes.
        """
        frames = Frames(boundaries, signs, unit, _middle(shape, boundaries[0]))
        return _checked(cls(frames, with_lengths(shape, frames), alignment))

    @limited("meshing a blend", "a coarser tolerance or a smaller size")
    def mesh(
        self,
        tolerance: Exact | None = None,
        *,
        size: tuple[int, int] | None = None,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """Triangles within `tolerance` (the model's units) of the blend, or on a grid of `size` points in s and t.

        With a tolerance, or a `quality`, it is the mesh of `surface`, see `ParametricSurface.mesh`; else the grid has
        `size`, by default 100 x 100, and no deviation is known: connectivity and all that does not depend on the
        shape values are kept, so that a blend of changed shape costs milliseconds.  The seam of closed curves is
        welded.  Where the first boundary knows its surface's normal, the mesh's agree with it.
        Raises `ValueError` for both and for grids of fewer than 3 x 2 points.
        """
        how = Quality.of(quality)
        if tolerance is not None or how is not Quality.BALANCED:
            refuse_both(tolerance, size)
            mesh = self.surface.mesh(tolerance, quality=how)
            return mesh.flipped if self.frames.inward else mesh
        n, m = size or (100, 100)
        if n < 3 or m < 2:
            raise ValueError(f"size must be at least (3, 2), not {size}")
        return self.gridded((n, m))

    def with_shape(self, **changes: ShapeLike | CurveLike | None) -> GeneratrixBlend:
        """The blend with some of l1, l2, lambda1, lambda2, middle replaced; cheap unless middle is.

        Raises `ValueError` as `GeneratrixShape` does.
        """
        shape, frames = self.shape.changed(**changes), self.frames
        if "middle" in changes:
            frames = Frames(frames.boundaries, frames.signs, frames.unit, _middle(shape, frames.boundaries[0]))
        return _checked(GeneratrixBlend(frames, with_lengths(shape, frames), self.alignment))

    @cached_property
    def certificate(self) -> GeneratrixCertificate:
        """Contact with both surfaces, sense of the curves, regularity, and whether the blend crosses itself."""
        return certify(self)

    def require(self) -> GeneratrixBlend:
        """The blend itself; raises `NotProvedError` where a claim of its certificate is refuted or measured to fail."""
        failed = self.certificate.failed
        if failed:
            raise NotProvedError("; ".join(map(str, failed)), self)
        return self

    @limited("looking for the largest safe length", "a smaller size")
    def largest_safe(
        self, number: int | None = None, size: tuple[int, int] = (96, 24), **limits: Unpack[WorkLimits]
    ) -> float:
        """The largest constant l1 (`number` 0), l2 (1) or both (None) up to which the blend is sound.

        Sound: on the mesh of this size no triangles cross and no normal turns by a right angle between
        neighbours.  Measured: lengths are tried upwards in steps of 30%, then the first failure is bisected to
        0.1%.  Infinite where there is none up to eight times the mean distance of the curves.
        Raises `GeometryError` where even a short length is not sound.
        """
        names = {0: ("l1",), 1: ("l2",), None: ("l1", "l2")}
        if number not in names:
            raise ValueError(f"number must be 0, 1 or None for both, not {shown(number)}")

        def safe(length: float) -> bool:
            checkpoint("looking for the largest safe length")
            return is_safe(self.with_shape(**dict.fromkeys(names[number], length)), size)

        low = 0.05 * self.alignment.distance
        if not safe(low):
            raise GeometryError(f"the blend is not sound even with {' = '.join(names[number])} = {low:.4g}")
        high = low * 1.3
        while safe(high):
            low, high = high, high * 1.3
            if low > 8.0 * self.alignment.distance:
                return float(np.inf)
        for _ in range(10):
            middle = (low + high) / 2
            low, high = (middle, high) if safe(middle) else (low, middle)
        return low

    def __str__(self) -> str:
        first, second = self.boundaries
        done = ["reversed"] if self.alignment.reversed else []
        done += [f"shifted by {self.alignment.shift:.4g}"] if self.alignment.shift else []
        turned = f", the second {' and '.join(done)}" if done else ""
        turned += ", both by their lengths" if self.alignment.by_length else ""
        return f"a generatrix blend of degree {self.degree} from {first.name} to {second.name}{turned}"


@limited("finding a blend by a generatrix", "lengths l1 and l2")
def generatrix_blend(
    first: Boundary,
    second: Boundary,
    shape: GeneratrixShape | None = None,
    align: bool = True,
    unit: bool = True,
    **limits: Unpack[WorkLimits],
) -> GeneratrixBlend:
    """The blend from one boundary to another.

    Lengths that `shape` leaves open are a third of the distance of the curves (the mean one, on closed curves with a
    cosine that follows it; constant where `unit` is false), halved until the blend does not cross itself (up to six
    times; else as they were: see its certificate).

    With `align` the second curve is run through the other way, started elsewhere, and numeric curves run through by
    their lengths, so that corresponding points fit; without, both are left as they are, and curves that run against
    each other are found by the certificate.

    `unit=False` leaves the vectors W, E as long as they are, which keeps rational data rational; lengths are then
    multiples of them.

    Raises `GeometryError` for an open and a closed curve, curves that touch, or an unclear side, `ValueError` for
    shape functions that do not close up on closed curves, `TypeError` for what is no boundary or shape.
    """
    for boundary, name in ((first, "first"), (second, "second")):
        if not isinstance(boundary, Boundary):
            raise TypeError(
                f"{name} must be a Boundary (see plane_section and Boundary.on_implicit), not {shown(boundary)}"
            )
    shape = GeneratrixShape() if shape is None else shape
    if not isinstance(shape, GeneratrixShape):
        raise TypeError(f"shape must be a GeneratrixShape, such as GeneratrixShape(l1=1, l2='1/2'), not {shown(shape)}")
    if first.closed != second.closed:
        alignment(first, second, (1, 1))  # says so
    require_apart(first, second)
    signs = sides(first, second)
    first, second, found = aligned(first, second, signs, align)
    blend = GeneratrixBlend.of_turned((first, second), signs, shape, found, unit)
    open_lengths = [name for name in ("l1", "l2") if getattr(shape, name) is None]
    return _shortened(blend, open_lengths) if open_lengths and align else blend


def refuse_both(tolerance: Any, size: Any) -> None:
    """Raise `ValueError` where a mesh is asked for by its size and by its tolerance, or its quality where that is None.

    Raises `TypeError` for a size as tolerance.
    """
    if size is not None and tolerance is None:
        raise ValueError("of a mesh with a given size no quality can be chosen; give a tolerance, or nothing, instead")
    if size is not None:
        raise ValueError("tolerance and size are two ways to say how fine the mesh is; give one of them")
    if isinstance(tolerance, tuple):
        raise TypeError(f"tolerance must be a positive number; a grid is given as size={tolerance}")


def _shortened(blend: GeneratrixBlend, names: list[str]) -> GeneratrixBlend:
    """The blend with the lengths of these names halved up to six times until it is sound; else as it is."""
    trial = blend
    for _ in range(7):
        if is_safe(trial, (64, 16)):
            return trial
        trial = trial.with_shape(**{name: getattr(trial.shape, name).scaled(0.5) for name in names})
    return blend


def _checked(blend: GeneratrixBlend) -> GeneratrixBlend:
    """A blend whose shape fits its curves, and whose control points doubles hold."""
    if blend.closed:
        blend.shape.require_periodic()
    with np.errstate(all="ignore"):
        controls, slopes = blend.frames.grid(16).controls(blend.shape)
    if not (np.isfinite(controls).all() and np.isfinite(slopes).all()):
        raise GeometryError("the control points are beyond the range of doubles (1.8e308); give shorter l1, l2")
    return blend


def _middle(shape: GeneratrixShape, first: Boundary) -> ParametricSurface | None:
    if shape.middle is None:
        return None
    curve = space_curve(shape.middle, "the middle curve")
    points = value_at(curve, np.linspace(0.0, 1.0, 65))
    if not np.isfinite(points).all():
        raise GeometryError("the middle curve is not finite on all of [0, 1]")
    if first.closed and not closes(points):
        raise GeometryError("the boundaries are closed but the middle curve is not: it must end where it starts")
    return curve


@limited("finding a blend by a generatrix", "lengths l1 and l2")
def blend_quadrics(
    quadric1: PolynomialLike,
    plane1: PolynomialLike,
    quadric2: PolynomialLike,
    plane2: PolynomialLike,
    shape: GeneratrixShape | None = None,
    sides: tuple[int | None, int | None] = (None, None),
    **limits: Unpack[WorkLimits],
) -> GeneratrixBlend:
    """The blend of two quadrics in any position, each ending at a plane that cuts it in an ellipse.

    `shape` holds the four shape values (by default they are chosen), `sides` where each blend lies (see `Boundary`)
    if that is not clear.  Raises `GeometryError` for sections that are no closed curves, and as `generatrix_blend`.
    """
    boundaries = []
    for quadric, plane, side, name in zip((quadric1, quadric2), (plane1, plane2), sides, ("1", "2"), strict=True):
        try:
            boundaries.append(plane_section(quadric, plane, side=side))
        except (GeometryError, ValueError, TypeError) as error:
            raise type(error)(f"quadric{name} and plane{name}: {error}") from None
    return generatrix_blend(boundaries[0], boundaries[1], shape)
