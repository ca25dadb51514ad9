"""Solids whose boundary is made of surfaces that do not meet, such as a hollow's inside and outside: one by one.

Where a wall is thin, a lattice that shows both its sides at once is as fine as the wall; each side by itself is as
coarse as it bends.  That two surfaces are apart is proved: of every cube that both may pass, either f - m g, with m
such that the gradients cancel, has one sign in it, so that f and g do not vanish together, or its eighths are apart.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.bernstein.search import Boxes, Fate, Fates, Limits, search
from pas.errors import GeometryError
from pas.solid.bounds import ORIGIN, bounding_box
from pas.solid.evaluator import TreeEvaluator
from pas.solid.functions import distances_from
from pas.solid.taylor import TaylorForms
from pas.solid.tree import Tree, complement, parts_of, splits_of
from pas.surface.evaluator import symmetric
from pas.surface.geometry import derivative_batch

LIMITS = Limits(depth=13, cells=20_000)
"""How often cubes are cut, and how many may be left on the way."""

MOST_CONTACTS, NEAR = 100, 40.0
"""Points in which boundaries may touch; how far around each cubes are left, over their half edge."""

BESIDE, FLATTEST = 1e-2, 1e-3
"""How far from a cube a contact may be; the least difference of curvatures there, both in local coordinates."""

MOST_PARTS = 8
"""Parts of an intersection whose boxes are looked for one by one."""


def cavities(tree: Tree, box: Floats) -> Iterator[tuple[Tree, Tree]]:
    """The parts of an intersection whose complements lie within a box (2, 3), each with the others' intersection.

    So does that of a shell's wall, which is within the others.
    """
    is_short = len(parts_of(tree, union=False)) <= MOST_PARTS
    for part, others in splits_of(tree, union=False):
        if is_shell(part, others) or (is_short and _is_within(complement(part), box)):
            yield part, others


def pieces(tree: Tree, box: Floats) -> Iterator[tuple[Tree, Tree]]:
    """The `cavities` in a box larger by a 16th, and each part of a union with the union of the others.

    Boxes of hollows that touch the sides are known no better.
    """
    yield from cavities(tree, box + np.ptp(box, axis=0) / 16 * np.array([[-1.0], [1.0]]))
    if len(parts_of(tree, union=True)) <= MOST_PARTS:
        yield from splits_of(tree, union=True)


def _is_within(tree: Tree, box: Floats) -> bool:
    """Whether a set lies in a box (2, 3), and is not empty."""
    evaluator = TreeEvaluator(tree, ORIGIN, fmpq(1))
    beyond = box.mean(axis=0) + np.array(list(product((-2.0, 2.0), repeat=3))) * np.ptp(box, axis=0)
    if evaluator.inside(
        evaluator.signs(beyond)
    ).any():  # as is the complement of most, whose box takes long to look for
        return False
    try:
        own = bounding_box(tree)
    except GeometryError:
        return False
    return bool((own[0] >= box[0]).all() and (own[1] <= box[1]).all())


def is_shell(wall: Tree, tree: Tree) -> bool:
    """Whether a set is what is within a thickness of any face of a tree, so that its boundary keeps that distance."""
    followed = [follows for _, follows in distances_from(tree, wall)]
    kept = {face for follows in followed for face in follows.faces}
    return bool(followed) and all(follows.all <= kept for follows in followed)


def apart(first: TreeEvaluator, second: TreeEvaluator, box: Floats) -> bool:
    """Whether the boundaries of two sets, compiled in the same coordinates, do not meet in a box (2, 3).

    False where that is not shown.
    """
    return not len(close(first, second, box)[0])


def close(first: TreeEvaluator, second: TreeEvaluator, box: Floats) -> tuple[Floats, float]:
    """The centres (N, 3) of the cubes in which two boundaries may meet, and their half edge: small, or many."""

    def judge(cubes: Boxes, _: int) -> Fates:
        return np.where(_may_meet(first, second, cubes.centers, cubes.halves[:1]), Fate.SPLIT, Fate.SETTLED)

    found = search(Boxes.of(box, larger=1e-9), judge, Boxes.eighths, LIMITS, "telling surfaces apart")
    return found.open.centers, float(found.open.halves.max(initial=0.0))


def contacts(first: TreeEvaluator, second: TreeEvaluator, box: Floats) -> Floats | None:
    """The points (N, 3) in which two boundaries touch and do not cross; None where they may meet elsewhere.

    That they meet nowhere else is proved, up to cubes of a 2^14th of the box around these points; in them, that the
    difference of the two functions is definite across the common normal, so that one boundary stays on one side of the
    other, is measured, as is the touching: it is so to rounding.
    """
    centers, half = close(first, second, box)
    result: list[Floats] = []
    while len(centers):
        too_many = len(result) == MOST_CONTACTS or len(centers) > LIMITS.cells
        point = None if too_many else _contact(first, second, centers[0])
        if point is None:
            return None
        around = np.abs(centers - point).max(axis=1) <= NEAR * half
        if not around[0]:
            return None
        result.append(point)
        centers = centers[~around]
    return np.array(result).reshape(-1, 3)


def _contact(first: TreeEvaluator, second: TreeEvaluator, start: Floats) -> Floats | None:
    """Where two functions touch near a point without crossing; None where no pair does, or more than one."""
    pairs = [
        (p, q) for i, j in product(_near(first, start), _near(second, start))
        if (p := first.polynomial(i)) is not None and (q := second.polynomial(j)) is not None
    ]  # fmt: skip
    found = [point for p, q in pairs if (point := _tangency(p, q, start)) is not None]
    return found[0] if len(pairs) == len(found) == 1 else None


def _near(evaluator: TreeEvaluator, point: Floats) -> list[int]:
    """The faces that pass near a point."""
    jets = evaluator.jets(np.repeat(point[None], evaluator.used, axis=0), np.arange(evaluator.used))
    return [i for i, (value, *slope) in enumerate(jets) if abs(value) <= BESIDE * np.linalg.norm(slope)]


def _tangency(p: Polynomial, q: Polynomial, start: Floats) -> Floats | None:
    """The point near another at which p = q = 0 and p - m q has no gradient, by Newton's method for (x, m).

    None where it is not found, or p - m q is not definite there across the normal.
    """
    if max(p.degree, q.degree) < 2:
        return None  # planes
    functions = derivative_batch([f.dense(f.degree) for f in (p, q)], (0, 1, 2))
    point, factor = start.copy(), None
    for _ in range(30):  # fewer where it converges; else there is no contact
        jets = functions(np.tile(point, (2, 1)), np.arange(2))
        values, hessians = jets[:, :4], symmetric(jets[:, 4:], 2)
        (_, *a), (_, *b) = values
        across = np.array(a), np.array(b)
        factor = across[0] @ across[1] / max(across[1] @ across[1], 1e-300) if factor is None else factor
        bend = hessians[0] - factor * hessians[1]
        matrix = np.block([[bend, -across[1][:, None]], [across[0][None], np.zeros((1, 1))]])
        rest = np.append(across[0] - factor * across[1], values[0, 0])
        step, *_ = np.linalg.lstsq(matrix, -rest, rcond=None)
        point, factor = point + step[:3], factor + step[3]
        if np.linalg.norm(step[:3]) < 1e-15:  # rounding, in local coordinates; so is 1e-12 of a distance
            break
    size = np.linalg.norm(values[:, 1:], axis=1)
    tangents = np.linalg.svd(across[0][None])[2][1:]
    curvatures = np.linalg.eigvalsh(tangents @ bend @ tangents.T) / max(size[0], 1e-300)
    met = (np.abs(values[:, 0]) <= 1e-12 * size).all() and np.linalg.norm(point - start) < BESIDE
    return point if met and curvatures.prod() > 0 and np.abs(curvatures).min() > FLATTEST else None


def _may_meet(first: TreeEvaluator, second: TreeEvaluator, centers: Floats, half: Floats) -> NDArray[np.bool_]:
    """Whether both boundaries may pass cubes, at points in common (N,)."""
    matters = []
    for evaluator in (first, second):
        yes, no = evaluator.taylor(centers, half)
        true, false = evaluator.decided(yes, no)
        matters.append(np.logical_or(*evaluator.relevant(yes, no)) & ~(true | false))
    result = np.zeros(len(centers), dtype=bool)
    for i, j in product(*(np.flatnonzero(m.any(axis=1)) for m in matters)):
        rows = np.flatnonzero(matters[0][i] & matters[1][j] & ~result)
        pair = [evaluator.polynomial(int(k)) for evaluator, k in ((first, i), (second, j))]
        if any(p is None for p in pair):
            result[rows] = True
        elif len(rows):
            result[rows] = ~TaylorForms([p for p in pair if p is not None]).never_both(centers[rows], half)
    return result
