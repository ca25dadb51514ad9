"""Positive factors change nothing: each kind of shape times numbers near the ends of the range of doubles and beyond.

A power of two leaves meshes the same to the bit.  Any other factor leaves coefficients that round otherwise, as a
factor 3 does: verdicts are the same, and counts of triangles but for ties.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pas
from pas import solid
from pas.algebra.scaling import Scaled
from pas.contacts.cones import nappe
from pas.independent.checker import check_independently
from pas.solid.functions import Pieces, region
from pas.solid.tree import Atom, combined

Made = tuple[Any, Any, bytes]
"""Verdicts, which must be the same for all factors, a count, and what must be the same bytes for powers of two."""

BINARY = {"2^-600": Fraction(1, 2**600), "2^1100": Fraction(2**1100)}
DECIMAL = {"1e300": Fraction(10**300), "1e-160": Fraction(1, 10**160), "1e-300": Fraction(1, 10**300)}
FACTORS = BINARY | DECIMAL

SPHERE, TORUS = "x^2 + y^2 + z^2 - 1", "(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"
POINTS = np.random.default_rng(5).normal(size=(40, 3))


def times(text: str, factor: Fraction) -> pas.Polynomial:
    return pas.Polynomial(text) * factor


def contact(surface: str, clip: str, factor: Fraction) -> pas.Contact:
    return pas.Contact(times(surface, factor), times(clip, factor))


def corner(factor: Fraction, radius: str = "1/9") -> list[pas.Contact]:
    axes = ("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y")
    return [contact(f"{b}^2 + {c}^2 - {radius}", f"{a} - 1", factor) for a, b, c in axes]


def of_surface(surface: pas.PiecewiseSurface, tolerance: float) -> Made:
    mesh = surface.mesh(tolerance)
    verdicts = [v.status for v in (*surface.certificate.verdicts, *mesh.certificate.verdicts)]
    return verdicts, len(mesh.triangles), mesh.points.tobytes() + surface.curvatures(mesh.points).tobytes()


def sphere(factor: Fraction) -> Made:
    return of_surface(times(SPHERE, factor).surface((-2, -2, -2), (2, 2, 2)), 0.05)


def torus(factor: Fraction) -> Made:
    return of_surface(times(TORUS, factor).surface((-2, -2, -1), (2, 2, 1)), 0.05)


def far(factor: Fraction) -> Made:
    """A surface whose stage has an origin of its own: its frame's is no point of doubles."""
    return of_surface(times("(x - 1/3)^2 + y^2 + z^2 - 1", factor).surface(("-5/3", -2, -2), ("7/3", 2, 2)), 0.05)


def blend_of_contacts(factor: Fraction) -> Made:
    return of_surface(pas.blend(corner(factor), 1).surface, 0.03)


def blend_times(factor: Fraction) -> Made:
    """The patches of a blend, all by one factor: faces and contacts stay, and fairness is that of the same shape."""
    known = pas.blend(corner(Fraction(1)), 1).surface
    patches = [patch * factor for patch in known.patches]
    surface = pas.PiecewiseSurface(known.partition, known.contacts, known.order, patches, known.degree)
    verdicts, count, same = of_surface(surface, 0.03)
    return (verdicts, str(surface.fairness())), count, same


def hollow(factor: Fraction) -> Made:
    found = pas.blend(corner(factor), 1).hollow("1/10")
    mesh = found.mesh(0.03)
    return [v.status for v in found.certificate.verdicts], len(mesh.triangles), mesh.points.tobytes()


def nozzle(factor: Fraction) -> Made:
    opening = pas.Opening(times("x^2 + y^2 + z^2 - 4", factor), (0, 0, 1), "1/2")
    return of_surface(
        pas.blend([opening, contact("(x - 1/32)^2 + (y + 1/64)^2 - 1/9", "z - 3", factor)], 1).surface, 0.05
    )


def plate(factor: Fraction) -> Made:
    both = [contact("z", "x^2 + y^2 - 1", factor), contact("x^2 + y^2 - 1/9", "z - 1", factor)]
    blend = pas.blend(both, 1)
    mesh = blend.solid("1/2").mesh(0.05)
    verdicts, count, same = of_surface(blend.surface, 0.05)
    return verdicts, count + len(mesh.triangles), same + mesh.points.tobytes()


def of_solid(shape: solid.Solid) -> Made:
    mesh = shape.mesh(0.05)
    verdicts = [v.status for v in shape.verdicts], mesh.is_closed, round(shape.volume(), 3), shape.faces
    return (verdicts, shape.contains(POINTS).tolist()), len(mesh.triangles), mesh.points.tobytes()


def cut_ball(factor: Fraction) -> Made:
    return of_solid(solid.implicit(times(SPHERE, factor)) - solid.half_space(times("x - 1/2", -factor)))


def ball_and_bar(factor: Fraction) -> Made:
    bar = solid.implicit(times("x^2 + y^2 - 1/9", factor), times("2 - z", factor), times("z", factor), face="bar")
    return of_solid(solid.implicit(times(SPHERE, factor)) | bar)


def solid_of_blend(factor: Fraction) -> Made:
    return of_solid(pas.blend(corner(factor), 1).solid(1))


def on_generatrix(factor: Fraction) -> Made:
    first = pas.plane_section(times("x^2 + y^2 - 1", factor), times("z + 1", factor))
    second = pas.plane_section(times("x^2 + y^2 - 1/4", factor), times("z - 1", factor))
    blend = pas.generatrix_blend(first, second)
    mesh = blend.mesh()
    return [v.status for v in blend.certificate.verdicts], len(mesh.triangles), mesh.points.tobytes()


def rays(factor: Fraction) -> Made:
    found = pas.Evaluator(times(TORUS, factor)).rays(3 * POINTS, POINTS[::-1] - 3 * POINTS)
    return found.rays.tolist(), len(found.parameters), found.parameters.tobytes()


KINDS: tuple[Callable[[Fraction], Made], ...] = (
    sphere, torus, far, blend_of_contacts, blend_times, hollow, nozzle, plate, cut_ball, ball_and_bar, solid_of_blend,
    on_generatrix, rays,
)  # fmt: skip

TIES = 0.05
"""Share by which numbers of triangles may differ, where coefficients round otherwise and ties are cut otherwise."""

FEW = 4
"""Triangles by which they may differ besides, for meshes of a hundred: those of two edges that are collapsed or not."""


@cache
def plain(kind: Callable[[Fraction], Made]) -> Made:
    return kind(Fraction(1))


@pytest.mark.sampled(7)
@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("factor", FACTORS)
def test_a_positive_factor_changes_nothing(kind, factor):
    verdicts, count, same = plain(kind)
    found = kind(FACTORS[factor])
    assert found[0] == verdicts
    assert abs(found[1] - count) <= TIES * count + FEW
    if factor in BINARY:
        assert found[1:] == (count, same)


@pytest.mark.parametrize("factor", FACTORS)
def test_values_are_those_of_the_polynomial_itself(factor):
    surface, evaluator = (make(times(TORUS, FACTORS[factor])) for make in (_boxed, pas.Evaluator))
    plain_jets = pas.Evaluator(TORUS).jets(POINTS / 4)
    with np.errstate(over="ignore", under="ignore"):
        wanted = np.array([[_double(Fraction(v) * FACTORS[factor]) for v in row] for row in plain_jets.tolist()])
    assert np.isinf(wanted).any() == (factor == "2^1100")
    for found in (evaluator.jets(POINTS / 4), surface.jets(POINTS / 4)):
        np.testing.assert_allclose(found, wanted, rtol=1e-13)
        assert factor not in BINARY or np.array_equal(found, wanted)
    np.testing.assert_array_equal(surface.gradient(POINTS / 4), surface.jets(POINTS / 4)[:, 1:])


def test_values_outside_are_as_asked_for_whatever_the_scale():
    surface = _boxed(times(SPHERE, BINARY["2^1100"]))
    assert surface.evaluator.values([[9, 9, 9]], outside=-1.0) == -1.0
    assert np.isnan(surface([9, 9, 9]))


def test_the_field_of_a_solid_is_that_of_its_polynomials():
    factor = Fraction(10**30)
    ball, bar = solid.implicit(times(SPHERE, factor)), solid.implicit("x^2 + y^2 - 1/9", "2 - z", "z + 2", face="bar")
    at = [[0, 0, 0.5], [0.2, 0, 1.5]]
    np.testing.assert_allclose((ball | bar).value(at), [-0.75e30, 0.04 - 1 / 9], rtol=1e-12)
    surface = pas.blend(corner(Fraction(1)), 1).surface
    one, many = (_inside(surface, f).value([[0, 0, 0], [0.1, 0.1, 0.2]]) for f in (Fraction(1), Fraction(2**200)))
    np.testing.assert_array_equal(many, np.ldexp(one, 200))


def test_the_pieces_of_a_surface_have_one_power_in_common():
    """They are not divided by powers of their own: they would not meet."""
    region = pas.blend(corner(Fraction(1)), 1).surface.partition
    plane = region.planes(0)[0]
    pieces = [times("x + y + z - 1", Fraction(1)) + plane * (1000 if number == 0 else 0) for number in range(6)]
    surface = pas.PiecewiseSurface.from_polynomials(region, (), 0, pieces)
    assert surface.scaled.polynomials == tuple(p / 2**surface.scaled.exponent for p in surface.patches)
    points = region.points.mean(axis=0) + 0.1 * POINTS
    found, number = surface(points), region.locate(points)
    for row in np.flatnonzero(number >= 0):
        assert found[row] == pytest.approx(pieces[region.piece_of[number[row]]](points[row]), abs=1e-9)


def test_polynomials_scaled_together_have_one_power_of_two_in_common():
    given = [times("x - 1", Fraction(3 * 2**700)), pas.Polynomial("x - 1/2"), pas.Polynomial(0)]
    found = Scaled.of(given)
    assert found.exponent == 701
    assert found.polynomials == tuple(p / 2**701 for p in given)
    assert Scaled.of([pas.Polynomial(0)]) == Scaled((pas.Polynomial(0),), 0)


def test_the_independent_checker_proves_what_is_scaled(tmp_path: Path):
    path = pas.save(pas.blend(corner(DECIMAL["1e300"]), 1), tmp_path / "corner.pas.json")
    assert all(finding.proved for finding in check_independently(path))


@pytest.mark.parametrize("slope", ["1e308", 1e308, "1e-300", "1000001", "1/1000001"])
def test_an_opening_is_no_wider_or_narrower_than_doubles_follow(slope):
    with pytest.raises(ValueError, match=r"^slope must be from 1e-06 to 1e\+06, not .*: it is the tangent of half"):
        pas.Opening("x^2 + y^2 + z^2 - 4", (0, 0, 1), slope)


@pytest.mark.parametrize("slope", ["1e6", "1e-6"])
@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 2, 2), (3, -7, 5)])
def test_the_widest_and_the_narrowest_opening_have_rays(slope, axis):
    clip = pas.Opening("x^2 + y^2 + z^2 - 4", axis, slope).contact.scaled.clip
    lengths = np.linalg.norm(nappe(clip, np.array(axis, dtype=float)), axis=1)
    assert lengths[1:] / lengths[0] == pytest.approx(float(slope), rel=1e-3)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("square", ["1e308", "1e-308", "1e20", "1e-20"])
def test_a_cone_that_is_too_wide_or_narrow_is_refused_in_a_sentence(square):
    cone = pas.Contact("x^2 + y^2 + z^2 - 4", f"x^2 + y^2 - {square}*z^2")
    with pytest.raises(pas.GeometryError, match=r"is no cone with an inside: .* tangent from 1e-06 to 1e\+06"):
        pas.blend([cone, ("x^2 + y^2 - 1/9", "z - 3")], 1)


def _boxed(polynomial: pas.Polynomial) -> pas.PiecewiseSurface:
    return polynomial.surface((-2, -2, -2), (2, 2, 2))


def _inside(surface: pas.PiecewiseSurface, factor: Fraction) -> solid.Solid:
    inside = Pieces(surface.partition, [p * factor for p in surface.polynomials])
    return solid.Solid(combined(False, Atom(inside, "blend"), region(surface.partition)))


def _double(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return np.inf if value > 0 else -np.inf
