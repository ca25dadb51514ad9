"""Blends: corners and nodes from contacts to the proved, fair surface, quadratic programmes, and steps of a slider."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import count, cycle
from typing import Any

import numpy as np
from measured import Prepare, Work, measured

import pas

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
STEP = Fraction(1, 5000)
"""By which a radius differs from run to run, so that nothing that was kept helps."""

BODIES = {"elbow": ("1/3", "1/3"), "equal corner": ("1/3",) * 3, "unequal corner": ("1/3", "1/4", "2/5")}
DIRECTIONS = {
    "T": ((1, 0, 0), (-1, 0, 0), (0, 1, 0)),
    "three skew directions": ((1, 0, 0), (-1, 2, 0), (0, -1, 3)),
    "tetrahedral": ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)),
    "six-way": ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)),
}
UNKNOWNS, ROWS = 60, 1500
"""The size of the quadratic programme: that of a GC^2 corner of degree 6."""

FOLLOWED = 5e-3
"""The tolerance of a mesh that follows a slider, over the region's longest side."""


def corner(radii: Sequence[str], order: int) -> Prepare:
    """A blend of pipes along the axes."""

    def prepare() -> Work:
        runs = count()

        def work() -> Any:
            more = STEP * next(runs)
            return pas.blend([pas.Pipe(a, Fraction(r) + more, 1) for a, r in zip(AXES, radii, strict=False)], order)

        return work

    return prepare


def node(name: str, order: int) -> Prepare:
    """A node with clips by the program."""

    def prepare() -> Work:
        (first, *others), runs = DIRECTIONS[name], count()
        return lambda: pas.node([(first, 1 + STEP * next(runs)), *((way, 1) for way in others)], order)

    return prepare


def again() -> Work:
    """A node that was made before."""
    node_again = lambda: pas.node([(way, "7/9") for way in DIRECTIONS["three skew directions"]], 1)  # noqa: E731
    node_again()
    return node_again


def programme() -> Any:
    """A quadratic programme with drawn numbers that has a solution."""
    from pas.fairing.qp import Programme

    rng = np.random.default_rng(0)
    factor, rows = rng.normal(size=(2 * UNKNOWNS, UNKNOWNS)), rng.normal(size=(ROWS, UNKNOWNS))
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    within, none = rng.normal(size=UNKNOWNS), np.empty((0, UNKNOWNS))
    return Programme(factor.T @ factor, rng.normal(size=UNKNOWNS), none, np.empty(0), rows, rows @ within - 0.5)


def solved() -> Work:
    """By pas."""
    from pas.fairing.qp import solve

    problem = programme()
    return lambda: solve(problem)


def stated() -> Work:
    """By cvxpy with Clarabel, its statement included."""
    import cvxpy

    problem = programme()

    def work() -> Any:
        unknowns = cvxpy.Variable(UNKNOWNS)
        cost = cvxpy.quad_form(unknowns, cvxpy.psd_wrap(problem.hessian)) / 2 + problem.linear @ unknowns
        stated = cvxpy.Problem(cvxpy.Minimize(cost), [problem.rows @ unknowns >= problem.at_least])
        return stated.solve(solver=cvxpy.CLARABEL)

    return work


def slider(order: int, degree: int, followed: bool = False) -> Prepare:
    """A step of the tension's slider, with the mesh that follows it or without."""

    def prepare() -> Work:
        found = pas.blend(
            [pas.Pipe(a, r, 1) for a, r in zip(AXES, BODIES["unequal corner"], strict=True)], order, degree
        )
        found, tensions = found.refit(tension=4.5), cycle([5.0, 4.0])
        if not followed:
            return lambda: found.refit(tension=next(tensions))
        mesh = found.surface.mesh(FOLLOWED * float(np.ptp(found.surface.partition.points, axis=0).max()))
        return lambda: mesh.follow(found.refit(tension=next(tensions)).surface)

    return prepare


test_fits = measured(
    {
        f"quadratic programme, {UNKNOWNS} unknowns, {ROWS} rows": {"pas": solved, "cvxpy": stated},
        "first step of a slider, GC^1, degree 4": {"pas": slider(1, 4)},
        "first step of a slider, GC^2, degree 6": {"pas": slider(2, 6)},
        f"step of a slider and its mesh, {FOLLOWED:g} of its size, GC^2": {"pas": slider(2, 6, True)},
    }
)
test_corners = measured(
    {f"{name}, GC^{order}": {"pas": corner(radii, order)} for name, radii in BODIES.items() for order in (1, 2, 3)}
)
test_nodes = measured(
    {
        **{f"{name}, GC^{order}": {"pas": node(name, order)} for name in DIRECTIONS for order in (1, 2)},
        "the same node again": {"pas": again},
    }
)
