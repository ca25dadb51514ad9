"""The proof that a surface meets a contact whose curve lies inside the region, in none of its faces.

Where a clip is curved, or has a factor that is no face of the region, the curve V(f, d) is a space curve; d is the clip
without the planes of its clip faces.  What is proved of a single patch is said in docs/theory/verdicts.md, under curved
clips inside the region.  Refuted only at points of the curve that are proved to exist, with a sign that is proved
around them (see `Enclosure`).

The order is refuted with a derivation that is tangent to V(f), `D = ((grad f x grad d) x grad f) . grad`:
of a member of `<f, d^j>`, `g = alpha f + beta d^j`, it makes `D^j g = j! beta (D d)^j` on the curve,
and where that is not zero, g is no member of `<f, d^(j+1)>`.

Only the part `h <= 0` of the surface is used; which part of the region that is, is not examined.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from flint import fmpq_mpoly

from pas.algebra.curve import along, gradient
from pas.algebra.ideal import Ideal
from pas.algebra.lengths import unit
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Vector, cross, dot, exact_vector, moved, to_floats
from pas.algebra.scaling import scaled
from pas.arrays import Bools, Floats
from pas.bernstein.forms import b_form, on_simplex
from pas.bernstein.signs import alike, apart_on, positive_on
from pas.certify.certificate import Proposition
from pas.contacts.joins import Join
from pas.partition.cells import Partition
from pas.verdicts import Status, Verdict


def free_verdict(claim: Proposition, join: Join) -> Verdict:
    """Whether the surface meets a contact along the part of its curve that is in no clip face."""
    surface = claim.surface
    f, d, k = join.contact.surface, join.rest, surface.order
    if len(surface.patches) > 1 or d.degree < 1:
        what = f"{d} = 0" if d.degree > 0 else "the plane of a clip face"
        return claim.undecided(f"the clip cuts the surface inside the region as well, where {what}")
    patch, curve = surface.patches[0], RegionCurve(f, d, join.partition)
    achieved, obstacle = contact_order(patch, f, d, k)
    if obstacle is not None:
        found = next((e for e in curve.enclosures(obstacle * obstacle) if e.sign(obstacle.raw)), None)
        return claim.unmet(achieved, None if found is None else found.middle)
    exactly = f"in <f, h^{k + 1}> exactly"
    if not join.partition.cells:
        return claim.undecided(f"{exactly}; alpha is not examined, since there is no region")
    if not curve.closed():
        return claim.undecided(f"{exactly}; but the curve may reach the boundary of the region")
    if next(curve.enclosures(), None) is None:
        absent = join.elsewhere.status is Status.PROVED
        what = "the curve does not come into the region" if absent else "no point of it was found in the region"
        return claim.undecided(f"{exactly}; but {what}")
    transverse = transversality(patch, f, d)
    wrong = next((e for e in curve.enclosures(-transverse) if e.sign(transverse.raw) < 0), None)
    if wrong is not None:
        return claim.refuted("alpha is not positive on the curve", wrong.middle)
    if not curve.positive(transverse):
        return claim.undecided(f"{exactly}; but alpha > 0 on a regular curve is not proved")
    if join.faces:
        reason = f"{exactly}; but the curve is inside the region, too, where {d} = 0: one side of it only is in use"
        return claim.undecided(reason)
    return claim.proved(f"{exactly}, alpha > 0 on the curve, which is closed inside the region")


def contact_order(patch: Polynomial, f: Polynomial, d: Polynomial, highest: int) -> tuple[int, Polynomial | None]:
    """The largest j <= `highest` with the patch in `<f, d^(j+1)>` (-1 for none), and an obstacle.

    The obstacle is None for `highest`; elsewhere the patch has no higher order at points of the
    curve where the obstacle is not zero.
    """
    if Ideal.from_raw(f.raw, d.raw ** (highest + 1)).contains(patch):
        return highest, None
    remainders = (Ideal.from_raw(f.raw, d.raw ** (j + 1)).reduce(patch.raw) for j in range(highest + 1))
    lowest, remainder = next((j, r) for j, r in enumerate(remainders) if not r.is_zero())
    obstacle, field = Polynomial.from_raw(remainder), cross(cross(gradient(f), gradient(d)), gradient(f))
    for _ in range(lowest):
        obstacle = along(field, obstacle)
    return lowest - 1, obstacle


def transversality(g: Polynomial, f: Polynomial, d: Polynomial) -> Polynomial:
    """`(grad g x grad d) . (grad f x grad d)`."""
    return dot(cross(gradient(g), gradient(d)), cross(gradient(f), gradient(d)))


@dataclass(frozen=True)
class Enclosure:
    """A parallelogram (its corners in cyclic order) with a common zero of two polynomials in it.

    It is there as one of them has opposite signs on two opposite sides, the other on the other two (Miranda 1940), and
    a sign that a polynomial has on all of the parallelogram it has at that zero.  These signs are exact, by
    B-coefficients over the rationals; where the parallelogram is laid is found in doubles, by Newton's method.
    """

    middle: Floats
    corners: tuple[Vector, Vector, Vector, Vector]

    def sign(self, polynomial: fmpq_mpoly) -> int:
        """1 or -1 where a polynomial has that sign on all of it, else 0."""
        a, b, c, e = self.corners
        return _sign(polynomial, ((a, b, c), (a, c, e)))


class RegionCurve:
    """The curve V(f, d) in a region, or in all of space where there are no cells."""

    def __init__(self, f: Polynomial, d: Polynomial, partition: Partition) -> None:
        self.f, self.d, self.partition = f, d, partition

    def closed(self) -> bool:
        """Whether the curve is proved not to meet the region's boundary."""
        faces = [self.partition.corners(face.vertices) for face in self.partition.outer_faces]
        return apart_on(faces, (self.f.raw, self.d.raw)).status is Status.PROVED

    def positive(self, value: Polynomial) -> bool:
        """Whether a polynomial is proved positive on the curve."""
        cells = [self.partition.corners(cell) for cell in self.partition.cells]
        found = positive_on(cells, alike(value.raw, cells), [alike(p.raw, cells) for p in (self.f, self.d)])
        return found.status is Status.PROVED

    def enclosures(self, size: Polynomial | None = None) -> Iterator[Enclosure]:
        """Proved points of the curve in the region; those first where `size` is largest, if it is positive."""
        points = self.points
        if size is not None:
            values = scaled(size)(points)
            points = points[np.argsort(-values)][: np.count_nonzero(values > 0)]
        # signs must not change on the parallelograms, which are large against the 1e-15 that their middles are off
        for point in points[:12]:
            for half in (2.0**-20, 2.0**-28, 2.0**-12):
                enclosure = self.enclosure(point, half)
                if enclosure is not None:
                    yield enclosure

    def enclosure(self, point: Floats, half: float) -> Enclosure | None:
        """A parallelogram around a point with half sides `half`, if it is proved to be in the region and to hold
        a common zero of f and d."""
        along_f, along_d, _ = dual(scaled(self.f).gradient(point[None]), scaled(self.d).gradient(point[None]))
        p, u, w = (exact_vector(v.tolist()) for v in (point, *(half * unit(a[0]) for a in (along_f, along_d))))
        a, b, c, e = (moved(p, (s, u), (t, w)) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
        f, d = self.f.raw, self.d.raw
        met = _sign(f, [(a, e)]) < 0 < _sign(f, [(b, c)]) and _sign(d, [(a, b)]) < 0 < _sign(d, [(c, e)])
        return Enclosure(point, (a, b, c, e)) if met and self._holds((a, b, c, e)) else None

    @property
    def points(self) -> Floats:
        """Points (m, 3) on the curve and in the region, up to rounding, by Newton's method."""
        if self.partition.cells:
            corners = self.partition.points[np.array(self.partition.cells)]
        else:  # those of cubes around the origin
            corners = np.multiply.outer([1.0, 8.0, 64.0], list(product((-1.0, 1.0), repeat=3)))
        parts = 4  # of a cell's edge: a curve that is missed leaves the claim undecided
        weights = np.array(homogeneous_exponents(parts, corners.shape[1])) / parts
        points = np.unique((weights @ corners).reshape(-1, 3), axis=0)
        f, d = scaled(self.f), scaled(self.d)
        reach = 4 * float(np.abs(points).max())
        for _ in range(24):  # the number of right digits doubles with each
            along_f, along_d, regular = dual(f.gradient(points), d.gradient(points))
            step = f(points)[:, None] * along_f + d(points)[:, None] * along_d
            kept = regular & (np.abs(points - step).max(axis=1) < reach)
            points, step = (points - step)[kept], step[kept]
        points = points[np.linalg.norm(step, axis=1) < 1e-10]
        inside = self.partition.locate(points) >= 0 if self.partition.cells else np.full(len(points), True)
        return points[inside]

    def _holds(self, corners: tuple[Vector, ...]) -> bool:
        """Whether the hull of some points is proved to be in the region.

        It is if it is in one cell, or on the inner side of the planes of all outer faces.
        """
        if not self.partition.cells:
            return True
        near = self.partition.locate(np.array([to_floats(c) for c in corners]), tolerance=np.inf)
        around = [face.plane for face in self.partition.outer_faces]
        return any(
            all(plane.raw(*c) <= 0 for plane in planes for c in corners)
            for planes in (self.partition.planes(int(near[0])), around)
        )


def _sign(polynomial: fmpq_mpoly, simplices: Sequence[Sequence[Vector]]) -> int:
    """1 or -1 where all B-coefficients on some simplices have that sign, else 0."""
    degree = max(int(polynomial.total_degree()), 0)
    values = [v for s in simplices for v in b_form(on_simplex(polynomial, s), degree, len(s) - 1)]
    return 1 if min(values) > 0 else -1 if max(values) < 0 else 0


def dual(f: Floats, d: Floats) -> tuple[Floats, Floats, Bools]:
    """The vectors in the span of two gradients (N, 3) along which one function rises by 1 and the other stays.

    And where they exist, (N,): where the gradients are not parallel.
    """
    ff, fd, dd = ((a * b).sum(axis=1, keepdims=True) for a, b in ((f, f), (f, d), (d, d)))
    determinant = ff * dd - fd * fd
    regular = determinant > 1e-12 * ff * dd  # the squared sine of the angle between them
    scale = np.where(regular, determinant, 1.0)
    return (dd * f - fd * d) / scale, (ff * d - fd * f) / scale, regular[:, 0]
