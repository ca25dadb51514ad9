"""The curves in which two quadrics meet, branch by branch, as parametrisations.

Along the straight lines of a ruled member of the pencil (`pencil`; Levin 1976) the curve is given by square roots
of a trigonometric polynomial D(a).  Where D > 0 for all a there are two closed branches, one for each sign.  Else each
arc with D > 0 inside and simple zeros at its ends is one closed branch (`branch`).  Where the pencil has a pair of
planes, the branches are conics.

Guaranteed: whether the pencil has planes or definite members is decided exactly.  Branches that touch or cross,
which no regular curve can pass, are reported as such when D has a double zero to about 1e-10.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from flint import fmpq_mat

from pas.algebra.inputs import shown_point
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import PolynomialLike
from pas.algebra.rational import Vector, to_float
from pas.errors import GeometryError
from pas.parametric.generatrix.branch import QuadricBranch, QuadricPair, trigonometric
from pas.parametric.generatrix.quadric import (
    DEGREE,
    PLANES,
    Member,
    Quadric,
    Rulings,
    members,
    planes_of,
    rulings,
)
from pas.parametric.generatrix.sections import ConicKind, conic_section

SAMPLES = 2048
"""Parameters along a branch at which it is looked at."""

FAR = 1e-7
"""A homogeneous point of length one whose last coordinate is below counts as at infinity."""


def quadric_intersection(
    first: PolynomialLike | Quadric, second: PolynomialLike | Quadric
) -> tuple[QuadricBranch, ...]:
    """All branches of the intersection of two quadrics, given by polynomials of degree two in any position.

    Closed branches first; they follow the lines of a ruled quadric of the pencil (Levin 1976).

    Raises `GeometryError` where they do not meet, meet in single points only, have a straight line or a surface in
    common, or where branches touch or cross (and where).
    """
    given = Quadric(first, "first"), Quadric(second, "second")
    for quadric, name in zip(given, ("first", "second"), strict=True):
        quadric.require_curved(name)
    pair = QuadricPair.of(*given)
    if int(fmpq_mat([q.matrix.entries() for q in given]).rank()) < 2:
        raise GeometryError(f"{pair.text} are the same surface")
    found = members(*pair.local)
    if any(4 in member.inertia for member in found):  # a definite member: no real point in common
        raise GeometryError(f"{pair.text} do not meet: the intersection is empty (complex)")
    planes = next((m for m in found if m.inertia in PLANES), None)
    branches = _plane_branches(pair, planes) if planes is not None else _ruled_branches(pair, found)
    return tuple(sorted(branches, key=lambda b: not b.closed))


def _plane_branches(pair: QuadricPair, member: Member) -> list[QuadricBranch]:
    """The sections of the first quadric by the planes of a member of the pencil."""
    branches, reasons = list[QuadricBranch](), list[str]()
    planes = [p for p in planes_of(member) if any(c != 0 for c in p[:3])]  # not that at infinity
    for x, y, z, c in planes:
        normal: Vector = (x, y, z)
        try:
            conic = conic_section(pair.local[0], normal, -c)
        except GeometryError as error:
            reasons.append(str(error))
            continue
        size = max(np.abs(conic.first).max(), np.abs(conic.second).max())
        if conic.kind is ConicKind.ELLIPSE and size < 1e-7 * (1 + np.abs(conic.origin).max()):
            reasons.append(f"one of their planes meets them in one point, {shown_point(conic.origin, 6)}")
            continue
        signs = (1, -1) if conic.kind is ConicKind.HYPERBOLA else (1,)
        poles = () if conic.kind is ConicKind.ELLIPSE else (0.0, 1.0)
        branches += [QuadricBranch(pair, (0.0, 1.0), sign, conic=conic, poles=poles) for sign in signs]
    if not branches:
        raise GeometryError(f"{pair.text} have no curve in common; {pair.seen}" + "; ".join(reasons))
    for branch in branches:
        _require_uncut(branch, [np.array([to_float(c) for c in p]) for p in planes])
    return branches


def _require_uncut(branch: QuadricBranch, planes: list[Floats]) -> None:
    """Raise where the other plane of the pair cuts the conic: there the two sections cross, or touch."""
    s = (np.arange(2 * SAMPLES) + 0.5) / (2 * SAMPLES)
    points = branch.local(s)
    for plane in planes:
        heights = (points @ plane[:3] + plane[3]) / np.linalg.norm(plane[:3])
        size = 1.0 + np.abs(points).max(axis=1)
        if (np.abs(heights) <= 1e-9 * size).all():
            continue  # its own
        near = int((np.abs(heights) / size).argmin())
        if heights.min() < 0 < heights.max() or abs(heights[near]) <= 1e-7 * size[near]:
            raise GeometryError(
                f"the two plane curves in which {branch.pair.text} meet cross or touch each other near "
                f"{shown_point(points[near] + branch.pair.offset, 6)}; "
                "take plane_section for one of them, or move a quadric"
            )


def _ruled_branches(pair: QuadricPair, found: list[Member]) -> list[QuadricBranch]:
    lines = rulings(*pair.local, found)
    if lines is None:
        raise GeometryError(f"{pair.text} have no curve in common: the intersection is empty or single points")
    coefficients = _coefficients(lines)
    zeros = _zeros(lines, coefficients, pair)
    made = []
    if zeros:
        for low, high in zip(zeros, [*zeros[1:], zeros[0] + 2 * np.pi], strict=True):
            if lines.discriminant(low + (high - low) * np.array([0.3, 0.5, 0.6])).sum() > 0:
                factor = _divided(coefficients, low, high)
                made.append(QuadricBranch(pair, (low, high), 1, lines, factor))
    elif lines.discriminant(np.array([0.3, 2.1, 4.2])).sum() > 0:
        made = [QuadricBranch(pair, (0.0, 2 * np.pi), sign, lines) for sign in (1, -1)]
    branches = [_with_poles(branch) for branch in made if not _is_point(branch)]
    if not branches:
        raise GeometryError(f"{pair.text} do not meet in a curve: the intersection is empty (complex) or single points")
    return branches


def _is_point(branch: QuadricBranch) -> bool:
    """Whether the branch is the apex alone: it lies on both quadrics, and every straight line passes through it."""
    points = branch.homogeneous(np.array([0.05, 0.2, 0.45, 0.8]))
    return bool(np.abs(points[1:] @ points[0]).min() > 1 - 1e-12)


def _coefficients(lines: Rulings) -> Any:
    """c_k with D(a) = sum_k c_k e^(ika), k = -4..4."""
    size = 4 * DEGREE
    transform = np.fft.fft(lines.discriminant(2 * np.pi * np.arange(size) / size)) / size
    return np.array([transform[k] for k in range(-DEGREE, DEGREE + 1)])


def _divided(coefficients: Any, low: float, high: float) -> Any:
    """g with D = sin((a - low)/2) sin((high - a)/2) g: two linear factors in e^(ia) divided off."""
    ends = np.exp(1j * np.array([low, high]))
    quotient, _ = np.polynomial.polynomial.polydiv(coefficients, np.polynomial.polynomial.polyfromroots(ends))
    whole = np.zeros(len(coefficients) - 2, dtype=complex)  # leading zeros were trimmed
    whole[: len(quotient)] = quotient
    return whole * 4.0 * np.exp(0.5j * (low + high))


def _zeros(lines: Rulings, coefficients: Any, pair: QuadricPair) -> list[float]:
    """The simple zeros of D in [0, 2 pi), ascending; raises `GeometryError` for double ones.

    D is monotone between the real zeros of its derivative, found as eigenvalues.
    """
    from scipy.optimize import brentq

    def value(angle: float) -> float:
        return float(trigonometric(coefficients, np.array([angle]))[0])

    a, b, c = lines.equation(np.linspace(0, 2 * np.pi, 64))
    least = 1e-11 * float((b * b + np.abs(a * c)).max())  # an extremum below counts as zero: rounding makes 1e-14
    steep = np.roots((coefficients * np.arange(-DEGREE, DEGREE + 1))[::-1])
    knots = sorted(np.angle(steep[np.abs(np.abs(steep) - 1) < 1e-3]).tolist()) or [0.0]
    heights = [value(k) for k in knots]
    if max(map(abs, heights)) <= least:
        raise GeometryError(f"{pair.text} have straight lines in common, or touch along a curve; move one of them")
    for knot, height in zip(knots, heights, strict=True):
        point = lines.points(np.array([knot]), np.array([0.0]))[0]
        if abs(height) <= least and abs(point[3]) >= FAR**0.5:  # not at infinity
            where = shown_point(point[:3] / point[3] + pair.offset, 6)
            crossing = value(knot + 1e-3) > 0
            how = "their curves cross or have a straight line in common" if crossing else "they touch"
            raise GeometryError(f"{pair.text}: at {where} {how}; move one of them")
    ends = zip(knots, [*knots[1:], knots[0] + 2 * np.pi], heights, [*heights[1:], heights[0]], strict=True)
    zeros = [float(brentq(value, low, high, xtol=1e-15, rtol=1e-15)) for low, high, u, v in ends if u * v < 0]
    return sorted(z % (2 * np.pi) for z in zeros)


def _with_poles(branch: QuadricBranch) -> QuadricBranch:
    """The branch with the s at which it is at infinity."""
    s = np.linspace(0.0, 1.0, SAMPLES + 1)
    points = branch.homogeneous(s)
    turns = np.where((points[1:] * points[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    last = points[:, 3] * np.concatenate([[1.0], np.cumprod(turns)])
    crossings = np.flatnonzero(last[1:] * last[:-1] < 0)
    poles = [float((s[i] * last[i + 1] - s[i + 1] * last[i]) / (last[i + 1] - last[i])) for i in crossings]
    near = np.flatnonzero(np.abs(last) < FAR)
    for run in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1) if len(near) else ():
        poles.append(float(s[run[np.abs(last[run]).argmin()]]))
    poles = [p for i, p in enumerate(sorted(poles)) if i == 0 or p - sorted(poles)[i - 1] > 1e-3]
    return replace(branch, poles=tuple(sorted(poles)))
