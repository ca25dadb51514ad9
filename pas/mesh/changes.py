"""Where along the edges of a lattice a set's side changes, and on which face."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pas.algebra.bracket import sign_change
from pas.limits import checkpoint
from pas.mesh.field import FaceField
from pas.mesh.rows import Floats, Integers, dots

NEAR, BISECTIONS = 1e-6, 40
"""How far before and after a crossing, over the edge's length, the side is checked; and how often an
edge is halved where it is not what it should be."""


def side_changes(
    field: FaceField, points: Floats, edges: Integers, signs: NDArray[np.bool_], inside: NDArray[np.bool_]
) -> tuple[Floats, Integers]:
    """Where along each edge the side changes (E,), and the label of the face there (E,)."""
    a, b = edges.T
    start, changes = signs[:, a], signs[:, a] != signs[:, b]
    columns, rows = np.nonzero(changes)
    roots = _roots(field, 2 * columns, points[a[rows]], points[b[rows]])
    result, label = np.full(len(edges), 0.5), np.full(len(edges), -1)
    times = np.bincount(rows, minlength=len(edges))
    alone = times[rows] == 1
    ordinary, column = rows[alone], columns[alone]
    result[ordinary], label[ordinary] = roots[alone], 2 * column + (start[column, ordinary] != inside[a[ordinary]])
    several = np.flatnonzero(times > 1)
    if len(several):
        table = np.full((len(several), len(signs)), 2.0)
        table[np.searchsorted(several, rows[~alone]), columns[~alone]] = roots[~alone]
        result[several], label[several] = _first_turn(field, table, start[:, several], inside[a[several]])
    _check_crossings(field, points[a], points[b], inside[a], result, label)
    return np.clip(result, 1e-6, 1 - 1e-6), label


def _first_turn(
    field: FaceField, roots: Floats, start: NDArray[np.bool_], inside: NDArray[np.bool_]
) -> tuple[Floats, Integers]:
    """Where along edges with several changes of sign the side changes first (E,), and the label of the face there (E,).

    `roots` (E, M) are the places of these changes, 2 of columns whose signs `start` (M, E) do not change.
    """
    order = np.argsort(roots, axis=1, kind="stable")
    result, label = np.full(len(roots), 0.5), np.full(len(roots), -1)
    state, open_edges = start.copy(), np.arange(len(roots))
    most_changes = 12  # functions that may change sign along one lattice edge and still be told apart
    for place in range(min(len(start), most_changes)):
        checkpoint()
        column = order[open_edges, place]
        state[column, open_edges] ^= roots[open_edges, column] < 2.0
        turned = field.inside(state[:, open_edges]) != inside[open_edges]
        found, column = open_edges[turned], column[turned]
        result[found] = roots[found, column]
        label[found] = 2 * column + (start[column, found] != inside[found])
        open_edges = open_edges[~turned]
        if not len(open_edges):
            break
    return result, label


def _check_crossings(
    field: FaceField, a: Floats, b: Floats, start: NDArray[np.bool_], t: Floats, label: Integers
) -> None:
    """Correct, in place, the crossings where the side does not change: a function vanished twice."""

    def signs(rows: Integers, at: Floats) -> NDArray[np.bool_]:
        return field.signs(a[rows] + at[:, None] * (b[rows] - a[rows]))

    everything = np.arange(len(t))
    before = field.inside(signs(everything, np.maximum(t - NEAR, 0.0))) == start
    after = field.inside(signs(everything, np.minimum(t + NEAR, 1.0))) != start
    rows = np.flatnonzero(~(before & after) | (label < 0))
    if not len(rows):
        return
    low, high = np.zeros(len(rows)), np.ones(len(rows))
    for _ in range(BISECTIONS):
        checkpoint()
        middle = (low + high) / 2
        same = field.inside(signs(rows, middle)) == start[rows]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    first, last = signs(rows, low), signs(rows, high)
    changes = first != last
    found = np.full(len(rows), -1)
    for column in range(len(changes)):
        alone = last.copy()
        alone[column] = first[column]
        decides = changes[column] & (found < 0) & (field.inside(alone) == start[rows])
        inner_sign = np.where(start[rows], first[column], last[column])
        found = np.where(decides, 2 * column + ~inner_sign, found)
    t[rows], label[rows] = (low + high) / 2, found


def _roots(field: FaceField, labels: Integers, a: Floats, b: Floats) -> Floats:
    """Parameters in [0, 1] where functions (N,) that change sign from a to b vanish."""
    first, last = field.jets(a, labels)[:, 0], field.jets(b, labels)[:, 0]
    turned = np.where(first <= 0, 1.0, -1.0)
    start = np.clip(first / np.where(first != last, first - last, 1.0), 0.0, 1.0)

    def jets(at: Floats, rows: Integers) -> tuple[Floats, Floats]:
        along = b[rows] - a[rows]
        found = field.jets(a[rows] + at[:, None] * along, labels[rows])
        return turned[rows] * found[:, 0], turned[rows] * dots(found[:, 1:], along)

    root_still = 1e-10  # the step of Newton's method along a lattice edge, over the edge's length, where it ends
    return sign_change(jets, np.zeros(len(a)), np.ones(len(a)), start, root_still)
