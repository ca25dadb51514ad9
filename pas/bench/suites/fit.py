"""Choosing members: quadratic programmes, and steps of a slider."""

from __future__ import annotations

from typing import Any

import numpy as np

from pas.bench.case import Case, Suite, Work

UNKNOWNS, ROWS = 60, 1500
"""The size of the programme: that of a GC^2 corner of degree 6."""

FOLLOWED = 5e-3
"""The tolerance of a mesh that follows a slider, over the region's longest side."""


def _programme() -> Any:
    from pas.fairing.qp import Programme

    rng = np.random.default_rng(0)
    factor, rows = rng.normal(size=(2 * UNKNOWNS, UNKNOWNS)), rng.normal(size=(ROWS, UNKNOWNS))
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    within = rng.normal(size=UNKNOWNS)
    return Programme(
        factor.T @ factor, rng.normal(size=UNKNOWNS), np.empty((0, UNKNOWNS)), np.empty(0), rows, rows @ within - 0.5
    )


def _solved() -> Work:
    from pas.fairing.qp import solve

    programme = _programme()
    return lambda: solve(programme)


def _stated() -> Work:
    from pas.fairing.qp import stated

    programme = _programme()

    def work() -> Any:
        problem, _ = stated(programme)
        return problem.solve(solver="CLARABEL")

    return work


def _live(order: int, degree: int) -> Work:
    from pas.contacts.pipe import Pipe
    from pas.pipeline.blend import blend

    axes = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    found = blend([Pipe(a, r, 1) for a, r in zip(axes, ("1/3", "1/4", "2/5"), strict=True)], order, degree)
    tensions = iter([5.0, 4.0] * 1000)
    found.refit(tension=4.5)
    return lambda: found.refit(tension=next(tensions))


def _followed(order: int, degree: int) -> Work:
    """A step of a slider and the mesh that follows it, together."""
    from pas.contacts.pipe import Pipe
    from pas.pipeline.blend import blend

    axes = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    found = blend([Pipe(a, r, 1) for a, r in zip(axes, ("1/3", "1/4", "2/5"), strict=True)], order, degree)
    found = found.refit(tension=4.5)
    mesh = found.surface.mesh(FOLLOWED * float(np.ptp(found.surface.partition.points, axis=0).max()))
    tensions = iter([5.0, 4.0] * 1000)
    return lambda: mesh.follow(found.refit(tension=next(tensions)).surface)


def cases() -> list[Case]:
    """Those of this suite."""
    size = f"quadratic programme, {UNKNOWNS} unknowns, {ROWS} rows"
    return [
        Case(size, _solved, {"cvxpy": _stated}, "the peer with Clarabel, its statement included"),
        Case("first step of a slider, GC^1, degree 4", lambda: _live(1, 4)),
        Case("first step of a slider, GC^2, degree 6", lambda: _live(2, 6)),
        Case(f"step of a slider and its mesh, {FOLLOWED:g} of its size, GC^2, degree 6", lambda: _followed(2, 6)),
    ]


FIT = Suite("fit", "quadratic programmes and live steps", cases)
