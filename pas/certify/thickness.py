"""The proof that a wall is thicker than a bound everywhere: no point of one surface is as near to one of the other.

On a tetrahedron the zeros of a polynomial lie in a *slice*, what is between two parallel planes in the tetrahedron (see
docs/theory/verdicts.md, under thickness): it is convex, its corners lie on the edges of the tetrahedron, and it is as
thin as the square of the size.

Any direction may part two slices; tried are the normals of both and from middle to middle, and before that some for
each slice and all of the other surface.  Tetrahedra with slices that are not parted from all that are still there of
the other surface are halved.  Those that are parted go, as parts of what is there are parted from them as well.  For
refutations each slice and the nearest one of the other surface are looked at, before other pairs, and of those only
such as hold one that is not to be halved already.

Guaranteed for all zeros of both functions in their regions, up to the clips of contacts, and where an opening has two
cones between these for the outer contact, as far out as twice the inner region.  Not promised: anything else beyond the
clips, where pipes go on, and bounds as near to the least distance as what rounding counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TypeAlias

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.inputs import shown_point
from pas.algebra.monomials import homogeneous_exponents
from pas.algebra.rational import Vector, plain, three, to_float
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import corner_points, nearby_forms
from pas.bernstein.search import Cells, Fate, Fates, Limits, Searched, search
from pas.bernstein.simplices import Simplices, at_vertices, edges
from pas.certify.certificate import Proposition
from pas.certify.nesting import in_frame_of
from pas.limits import checkpoint
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict

CLEAR = 1e-9
"""Over the reach of the regions: by how much distances are more than a bound, or less; corners, planes and sums are off
by some hundred 2^-53 of it."""

Pairs: TypeAlias = "tuple[Integers, Integers]"
"""The numbers (P,) of slices of the inner surface, and of one of the outer surface's for each."""

LIMITS = Limits(depth=120, cells=400_000)
"""Slices a quarter as large as the wall is thick are some ten thousand."""

LARGE = 2
"""Slices so many times as large as most are halved before pairs are looked for, which is done as far as the largest
reaches."""


@dataclass(frozen=True)
class Slices(Cells):
    """Where zeros in tetrahedra lie: the slices' corners (N, 12, 3), two on each edge of a tetrahedron, their middles
    (N, 3) and the radii (N,) of balls around these that hold them, and their normals (N, 3); `crossed` (N, 6) are the
    edges that hold a zero.

    An edge that does not meet the slice has another one's corners.
    """

    corners: Floats
    middles: Floats
    radii: Floats
    normals: Floats
    crossed: Bools


def slices(batch: Simplices) -> tuple[Slices, Bools]:
    """The slices of the first form's zeros in tetrahedra, and which there are, (N,): the others hold no zeros in use.

    A zero is in use where no other form, which is a clip's, is positive; `crossed` are edges with one that surely is.
    """
    # Edges along which L changes by less, over the largest |L|, are taken as a whole where they meet the slice:
    # along others where it has a value is known to 2^-30.
    unchanged = 2.0**-20
    form, size = batch.forms[0], len(batch)
    weights = np.array(homogeneous_exponents(batch.degrees[0], 4)) / batch.degrees[0]
    values = at_vertices(form, 4)
    off = values @ weights.T - form
    low, high = off.min(axis=1) - 2 * batch.bound, off.max(axis=1) + 2 * batch.bound
    first, second = np.array(edges(4)).T
    ends, change = values[:, first], values[:, second] - values[:, first]
    least, most = np.minimum(ends, values[:, second]), np.maximum(ends, values[:, second])
    met = (most >= low[:, None]) & (least <= high[:, None])
    flat = np.abs(change) <= unchanged * np.abs(values).max(axis=1)[:, None]
    with np.errstate(all="ignore"):
        shares = np.stack([(limit[:, None] - ends) / change for limit in (low, high)], axis=2)
    shares = np.where(flat[:, :, None], [0.0, 1.0], np.sort(shares, axis=2) + [-(2.0**-30), 2.0**-30])
    shares = np.clip(shares, 0, 1)[..., None]
    start, way = batch.corners[:, first, None], (batch.corners[:, second] - batch.corners[:, first])[:, :, None]
    corners = start + shares * way
    spare = corners[np.arange(size), met.argmax(axis=1)]
    corners = np.where(met[:, :, None, None], corners, spare[:, None])
    crossed = (least < -batch.bound) & (most > batch.bound)
    a, b, c = np.moveaxis(batch.corners[:, 1:] - batch.corners[:, :1], 1, 0)
    across, rise = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1), values[:, 1:] - values[:, :1]
    volumes = (a * across[:, 0]).sum(axis=1, keepdims=True)
    normals = np.einsum("nk,nki->ni", rise, across) / np.where(volumes, volumes, 1.0)
    none = (form.min(axis=1) > batch.bound) | (form.max(axis=1) < -batch.bound)
    for clip in batch.forms[1:]:
        none |= clip.min(axis=1) > batch.bound
        crossed &= (clip.max(axis=1) < -batch.bound)[:, None]
    corners = corners.reshape(size, 12, 3)
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1, initial=0.0)
    return Slices(corners, middles, radii, normals, crossed), met.any(axis=1) & ~none


def thicker_than(inner: PiecewisePolynomial, outer: PiecewisePolynomial, bound: fmpq) -> Verdict:
    """The verdict on all points of one surface being farther than `bound`, in the model's units, from all of the other.

    Refuted at a point of the inner surface.
    """
    claim = Proposition(outer, f"a wall thicker than {plain(bound)}")
    if not all(join.confined for surface in (inner, outer) for join in surface.joins):
        return claim.undecided("a clip passes through a region, so that a part of it only is in use")
    sides = _tetrahedra(inner, outer)
    reach = max(float(np.abs(side.corners).max()) for side in sides)
    distance = to_float(bound / outer.partition.frame.scale)
    result, witness = parted(*sides, distance, CLEAR * reach, LIMITS, np.eye(3))
    if result.status is Status.PROVED:
        return claim.proved(
            f"slices that hold the two surfaces are parted; {result.examined} tetrahedra", result.examined
        )
    if result.status is Status.REFUTED:
        return claim.refuted("the two surfaces are nearer to one another somewhere", witness, result.examined)
    place = shown_point(outer.partition.frame.place(result.open.corners.mean(axis=1)[0]))
    return claim.undecided(f"{len(result.open)} tetrahedra undecided, one around {place}")


def parted(
    first: Simplices, second: Simplices, distance: float, clear: float, limits: Limits, ways: Floats
) -> tuple[Searched[Simplices], Floats | None]:
    """The search for how all zeros of the first form in tetrahedra are farther than a distance from those in others,
    with room for rounding, and a place where they are nearer if it is refuted.

    Planes across `ways` (M, 3) are tried first, each for all of one side.  Forms are of the same degrees on both sides.
    One that is 0 has zeros everywhere: so a tetrahedron without volume stands for a segment.
    """
    error = max(first.error, second.error)
    sides = [replace(side, source=np.full(len(side), n), error=error) for n, side in enumerate((first, second))]
    witness: list[Floats] = []

    def judge(cells: Simplices, _: int) -> Fates:
        checkpoint("bounding how far surfaces are apart")
        found, there = slices(cells)
        there[there] = _facing(found.corners[there], cells.source[there], distance + clear, ways)
        fates = np.where(there, Fate.WAIT, Fate.SETTLED).astype(np.intp)
        large = there & (found.radii > LARGE * np.median(found.radii[there] if there.any() else found.radii))
        if large.any():
            fates[large] = Fate.SPLIT
            return fates
        numbers = [np.flatnonzero(there & (cells.source == side)) for side in (0, 1)]
        fates[there] = Fate.SETTLED
        if not all(map(len, numbers)):
            return fates
        one, other = found.select(numbers[0]), found.select(numbers[1])
        nearest = nearest_pairs(one, other)
        nearer = np.flatnonzero(_nearer(one, other, nearest, distance - clear)) if distance > clear else np.arange(0)
        if len(nearer):
            number = nearest[0][nearer[0]]
            fates[numbers[0][number]] = Fate.REFUTE
            witness.append(one.middles[number])
            return fates
        for some, left in zip(numbers, close(one, other, nearest, distance + clear), strict=True):
            fates[some[left]] = Fate.SPLIT
        return fates

    result = search(sides[0].joined(sides[1:]), judge, Simplices.halved, limits, "bounding how far surfaces are apart")
    return result, witness[0] if witness else None


def _facing(corners: Floats, side: Integers, distance: float, ways: Floats) -> Bools:
    """Which slices by their corners (N, 12, 3) no plane across one of some ways parts from all of the other side, 0 or
    1 (N,)."""
    rows = [side == n for n in (0, 1)]
    if not all(some.any() for some in rows):
        return np.zeros(len(side), dtype=bool)
    along, gap = corners @ ways.T, distance * np.linalg.norm(ways, axis=1)
    low, high = along.min(axis=1), along.max(axis=1)
    least, most = (
        np.stack([f(v[some], axis=0) for some in rows])[1 - side] for f, v in ((np.min, low), (np.max, high))
    )
    return np.asarray(~((least - high > gap) | (low - most > gap)).any(axis=1))


def _tetrahedra(inner: PiecewisePolynomial, outer: PiecewisePolynomial) -> tuple[Simplices, Simplices]:
    """The cells of both regions in the outer one's local coordinates with the forms of their functions, then those of
    the clips of openings, negative where a surface is in use.

    Where openings have two cones, also the inner cells twice as large with the outer contact, in use between these.
    """
    frame, degree = outer.partition.frame, max(inner.degree, outer.degree, 1)
    below = [frame.localise(p).raw for p in inner.polynomials]
    sides = (
        (inner, below, in_frame_of(inner.partition, outer.partition)),
        (outer, [p.raw for p in outer.patches], outer.local),
    )
    cells: list[tuple[Vector, ...]] = []
    raws: list[fmpq_mpoly] = []
    clips: list[list[fmpq_mpoly]] = []
    for surface, polynomials, local in sides:
        cells += [tuple(local.corners(cell)) for cell in local.cells]
        raws += [polynomials[piece] for piece in local.piece_of]
        open_at = [
            frame.localise(c.clip).raw for c, j in zip(surface.contacts, surface.joins, strict=True) if j.opening
        ]
        clips += [2 * open_at] * len(local.cells)
    for ours, theirs, join in zip(inner.contacts, outer.contacts, outer.joins, strict=True):
        if join.opening and ours.clip != theirs.clip:
            local = sides[0][2]
            cells += [tuple(three(2 * c for c in v) for v in local.corners(cell)) for cell in local.cells]
            raws += [join.contact.surface.raw] * len(local.cells)
            clips += [[-join.contact.clip.raw, frame.localise(ours.clip).raw]] * len(local.cells)
    made = [nearby_forms(raws, cells, degree)]
    for column in zip(*clips, strict=True):
        made.append(nearby_forms(column, cells, max(1, *(int(p.total_degree()) for p in column))))
    forms, error = [form for form, _ in made], max(off for _, off in made)
    found, start = Simplices.of(forms, corner_points(cells), error), len(inner.partition.cells)
    return found.select(np.arange(start)), found.select(np.arange(start, len(found)))


def nearest_pairs(first: Slices, second: Slices) -> Pairs:
    """Each slice with the one of the other side whose middle is the nearest."""
    from scipy.spatial import cKDTree

    there, here = cKDTree(second.middles).query(first.middles)[1], cKDTree(first.middles).query(second.middles)[1]
    return np.concatenate([np.arange(len(first)), here]), np.concatenate([there, np.arange(len(second))])


def close(first: Slices, second: Slices, nearest: Pairs, distance: float) -> list[Bools]:
    """Which slices of each of two surfaces are not parted by more than a distance from all of the other one; some
    pairs, which are likely not to be, are looked at before the others."""
    found = [np.zeros(len(side), dtype=bool) for side in (first, second)]
    for one, other in chain([nearest], _near(first, second, distance)):
        new = ~(found[0][one] & found[1][other])
        left = ~apart(first, second, (one[new], other[new]), distance)
        found[0][one[new][left]] = found[1][other[new][left]] = True
    return found


def _near(first: Slices, second: Slices, distance: float) -> Iterator[Pairs]:
    """The pairs of slices whose balls are not farther apart than a distance, some at once."""
    from scipy.spatial import cKDTree

    most = distance + float(first.radii.max() + second.radii.max())
    tree = cKDTree(second.middles)
    at_once = 64  # slices with some ten thousand pairs, whose corners a processor's cache holds
    for start in range(0, len(first), at_once):
        some = cKDTree(first.middles[start : start + at_once])
        pairs = some.sparse_distance_matrix(tree, most * (1 + CLEAR), output_type="ndarray")
        one, other = pairs["i"] + start, pairs["j"]
        near = pairs["v"] <= distance * (1 + CLEAR) + first.radii[one] + second.radii[other]
        yield one[near], other[near]


def apart(first: Slices, second: Slices, pairs: Pairs, distance: float) -> Bools:
    """Which pairs of slices are parted by more than a distance, (P,)."""
    result, rows = np.zeros(len(pairs[0]), dtype=bool), np.arange(len(pairs[0]))
    for way in range(3):
        one, other = (numbers[rows] for numbers in pairs)
        n = (second.middles[other] - first.middles[one], second.normals[other], first.normals[one])[way]
        below = np.einsum("pki,pi->pk", first.corners[one], n).max(axis=1, initial=-np.inf)
        above = np.einsum("pki,pi->pk", second.corners[other], n).min(axis=1, initial=np.inf)
        parted = above - below > distance * np.linalg.norm(n, axis=1)
        result[rows[parted]], rows = True, rows[~parted]
    return result


def _nearer(first: Slices, second: Slices, pairs: Pairs, distance: float) -> Bools:
    """Which pairs of slices have zeros on edges that are surely nearer than a distance, (P,)."""
    result = np.zeros(len(pairs[0]), dtype=bool)
    for i, j in np.ndindex(6, 6):
        rows = np.flatnonzero(first.crossed[pairs[0], i] & second.crossed[pairs[1], j] & ~result)
        one, other = (numbers[rows] for numbers in pairs)
        away = first.corners[one, 2 * i : 2 * i + 2, None] - second.corners[other, None, 2 * j : 2 * j + 2]
        result[rows] = np.linalg.norm(away, axis=3).max(axis=(1, 2), initial=0.0) < distance
    return result
