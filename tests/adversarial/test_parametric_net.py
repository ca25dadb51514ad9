"""Verdicts on parametric surfaces and blends whose truth is known: none that is exact may be false."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise
from random import Random

import pytest
from exact_distances import off_mesh, off_spline
from parametric_cases import ONE, POWERS, Case, H, T, case, number
from parametric_contacts import contact_case

import pas
from pas.parametric.data import contact_verdicts
from pas.parametric.nets import extent
from pas.parametric.regularity import base_points, regularity
from pas.parametric.surface import ParametricSurface
from pas.verdicts import Status

QUICK, MANY = 240, 1400
"""Surfaces whose regularity is judged; the others come after them."""

CONTACTS, MORE_CONTACTS = 40, 300
MESHES, MORE_MESHES = 8, 100
BLOCK = 40
EFFORT = 2000


def require_right(made: Case) -> Status:
    """That the verdict on regularity is not false, and its place is one."""
    verdict = regularity(made.surface, EFFORT)
    wrong = Status.REFUTED if made.regular else Status.PROVED
    assert verdict.status is not wrong, f"{made.kind}: {verdict}"
    assert not verdict.measured or "too high for a proof" in verdict.reason
    if verdict.status is Status.REFUTED and " at " in verdict.reason:
        require_singular(made.surface, verdict.reason)
    return verdict.status


def require_singular(surface: ParametricSurface, reason: str) -> None:
    """That at the place named, in the domain, a component has a pole or the tangents are parallel."""
    place = [Fraction(x) for x in re.findall(r"[th] = (-?\d+(?:/\d+)?)", reason)]
    for x, (low, high) in zip(place, surface.ends, strict=True):
        assert (low is None or low <= x) and (high is None or x <= high), reason
    if "denominator" in reason:
        assert any(c.denominator(*map(pas.algebra.rational.rational, place)) == 0 for c in surface.components), reason
        return
    first, second = ([c.diff(*order).at(*place) for c in surface.components] for order in ((1, 0), (0, 1)))
    for i, j in pairwise((0, 1, 2, 0)):
        assert first[i] * second[j] == first[j] * second[i], reason


def blocks(count: int, start: int = 0) -> list[range]:
    return [range(n, min(n + BLOCK, start + count)) for n in range(start, start + count, BLOCK)]


@pytest.mark.parametrize("seeds", blocks(QUICK), ids=str)
def test_regularity(seeds):
    for seed in seeds:
        require_right(case(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seeds", blocks(MANY, QUICK), ids=str)
def test_regularity_of_many(seeds):
    for seed in seeds:
        require_right(case(seed))


@pytest.mark.parametrize("regular", [True, False])
def test_most_are_decided(regular):
    """A net that catches nothing because all is undecided would not be one."""
    found = [regularity(m.surface, EFFORT) for m in map(case, range(QUICK, QUICK + 60)) if m.regular is regular]
    decided = sum(v.status is not Status.UNDECIDED for v in found)
    assert decided >= (0.85 if regular else 0.6) * len(found) > 10


def require_contacts(seed: int) -> None:
    made = contact_case(seed)
    found = contact_verdicts(made.surface, made.data, made.order)
    wanted = tuple(Status.PROVED if true else Status.REFUTED for true in made.true)
    assert tuple(v.status for v in found) == wanted, made.kind


@pytest.mark.parametrize("seeds", blocks(CONTACTS), ids=str)
def test_contacts(seeds):
    """Each broken alone, each verdict exact."""
    for seed in seeds:
        require_contacts(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seeds", blocks(MORE_CONTACTS, CONTACTS), ids=str)
def test_many_contacts(seeds):
    for seed in seeds:
        require_contacts(seed)


SMALL = [p for p in POWERS if abs(p) <= 300]


def require_bounds(seed: int) -> None:
    """That certified meshes and B-splines are within their bounds, exactly; or that there is a reason for none."""
    draw = Random(seed)
    surface = case(seed, ("graph", "offset", "revolution"), SMALL).surface
    try:
        tolerance = extent(surface)[1] * draw.choice((0.1, 0.02))
        mesh, patch = surface.mesh(tolerance), pas.fit_patch(surface, tolerance)
    except pas.PasError as error:
        assert str(error)
        return
    assert mesh.certified and patch.certified
    assert 0 < mesh.deviation <= tolerance and 0 < patch.deviation <= tolerance
    assert max(off_mesh(surface, mesh, draw) for _ in range(8)) <= Fraction(mesh.deviation) ** 2
    assert max(off_spline(surface, patch, draw) for _ in range(8)) <= Fraction(patch.deviation) ** 2


@pytest.mark.parametrize("seed", range(MESHES))
def test_meshes_and_splines(seed):
    require_bounds(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(MESHES, MESHES + MORE_MESHES))
def test_many_meshes_and_splines(seed):
    require_bounds(seed)


@pytest.mark.parametrize("power", [0, 155, -159, 300, -300])
def test_bounds_do_not_depend_on_units(power):
    """The same surface in another unit has the same mesh, and its bounds are as good."""
    shapes = "t - t^2/5", "h + t*h/7", "(t^2 - h^2)/(2 + t*h)"
    plain, scaled = (
        ParametricSurface(*(f"1e{p}*({x})" for x in shapes), domain=((0, 1), (0, "1/3"))) for p in (0, power)
    )
    first, second = (s.mesh(1e-2 * extent(s)[1]) for s in (plain, scaled))
    assert len(first.triangles) == len(second.triangles)
    assert second.deviation / extent(scaled)[1] == pytest.approx(first.deviation / extent(plain)[1], rel=1)
    draw = Random(power)
    patch = pas.fit_patch(scaled, 1e-6 * extent(scaled)[1])
    assert patch.certified and max(off_spline(scaled, patch, draw) for _ in range(20)) <= Fraction(patch.deviation) ** 2
    (exact,) = pas.bezier_patches(scaled)
    assert exact.surface().components == scaled.components


@pytest.mark.parametrize("seed", range(20))
def test_no_base_point_is_missed(seed):
    """Numerator and denominator of a component vanish together at a known place, irrational in half of the cases."""
    draw = Random(seed)
    root = draw.choice((T * T - 2, T - draw.choice((0, 1, 2, "1/3", "3/2")), 3 * T**3 - 7))
    place = H - draw.choice((0, 1, "2/7"))
    above, below = root * (1 + H * H) + place * number(draw), place * (2 + T) + root * number(draw)
    if (above / below).is_polynomial:
        above = above + root
    scale = Fraction(10) ** draw.choice(POWERS)
    surface = ParametricSurface(T, scale * above / below, ONE, domain=((0, 2), (0, 1)))
    assert any(abs(root(p.t, p.h)) < 1e-12 and abs(place(p.t, p.h)) < 1e-12 for p in base_points(surface)), surface
