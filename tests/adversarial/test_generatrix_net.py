"""Verdicts on blends by a generatrix whose truth is known: none that is exact is false, what is measured says so."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from random import Random

import numpy as np
import pytest
from generatrix_cases import (
    SIZES,
    chord_product,
    double_point_is_near,
    exact_case,
    measured_case,
    tampered,
)

import pas
from pas.mesh.crossings import crossings
from pas.parametric.generatrix.blend import generatrix_blend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.paths import ExactCurve
from pas.parametric.generatrix.quadric import Quadric, read_plane
from pas.parametric.generatrix.sections import conic_section, ellipse_bounds
from pas.parametric.generatrix.shape import GeneratrixShape, ShapeFunction
from pas.parametric.generatrix.verdicts import contact_verdict, sense_verdict
from pas.verdicts import Findings, Status, Verdict

QUICK, MANY = 16, 140
WHOLE, MORE = 3, 40
PIPES, MORE_PIPES = 5, 40
BLOCK = 8
EXACT = (Status.PROVED, Status.REFUTED)


def blocks(count: int, start: int = 0) -> list[range]:
    return [range(n, min(n + BLOCK, start + count)) for n in range(start, start + count, BLOCK)]


def require_exact(seed: int) -> None:
    """Contacts are proved, each is refuted alone where it is broken by 10^-40; the sense is that of the chords."""
    made = exact_case(seed)
    blend = made.blend
    assert blend.surface.is_exact, made.kind
    assert [contact_verdict(blend, i).status for i in (0, 1)] == [Status.PROVED] * 2, made.kind
    assert (chord_product(blend) > 0) is made.same
    assert sense_verdict(blend).status is (Status.PROVED if made.same else Status.REFUTED), made.kind
    for number in (0, 1):
        for kind in ("curve", "plane"):
            broken = tampered(blend, number, kind)
            wanted = [Status.REFUTED if i == number else Status.PROVED for i in (0, 1)]
            assert [contact_verdict(broken, i).status for i in (0, 1)] == wanted, (made.kind, number, kind)


@pytest.mark.parametrize("seeds", blocks(QUICK), ids=str)
def test_exact_contacts(seeds):
    for seed in seeds:
        require_exact(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seeds", blocks(MANY, QUICK), ids=str)
def test_many_exact_contacts(seeds):
    for seed in seeds:
        require_exact(seed)


def require_whole(seed: int) -> None:
    """What is proved of regularity and of crossings is not contradicted by a mesh, what is refuted is by points."""
    blend = exact_case(seed).blend
    found = blend.certificate
    points, normals = blend.frames.sheet(blend.shape, (48, 16))
    if found.regular.proved:
        assert np.linalg.norm(normals, axis=-1).min() > 0
    assert found.regular.status is not Status.REFUTED or "vanishes" in found.regular.reason
    mesh = blend.mesh(size=(48, 16))
    assert np.isfinite(points).all()
    if found.simple.proved:
        assert not len(crossings(mesh.points, mesh.triangles)[0])
    assert found.simple.status is not Status.REFUTED  # it is proved or measured
    assert all(v.status in EXACT for v in found.contacts)


@pytest.mark.parametrize("seed", range(WHOLE))
def test_whole_certificates(seed):
    require_whole(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(WHOLE, WHOLE + MORE))
def test_many_whole_certificates(seed):
    require_whole(seed)


def require_marked(seed: int) -> None:
    """Pipes: contacts hold to rounding, everything else is measured, says so, and is right."""
    made = measured_case(seed)
    found = made.blend.certificate
    assert all(v.proved and "to rounding" in v.claim for v in found.contacts), made.kind
    assert found.sense.status is (Status.HOLDS_MEASURED if made.sense else Status.FAILS_MEASURED), made.kind
    for verdict, truth in ((found.regular, made.regular), (found.simple, made.simple)):
        assert verdict.measured and "measured" in str(verdict)
        if truth is not None:
            assert verdict.failed is not truth, (made.kind, str(verdict))
    assert not found.refuted and not found.proved
    if found.simple.reason.startswith("P("):
        assert double_point_is_near(made.blend, found.simple.reason), made.kind
    if found.failed:
        with pytest.raises(pas.NotProvedError, match="fails, measured"):
            made.blend.require()
    else:
        made.blend.require()


@pytest.mark.parametrize("seed", range(PIPES))
def test_what_is_measured_is_marked(seed):
    require_marked(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(PIPES, PIPES + MORE_PIPES))
def test_what_is_measured_of_many_is_marked(seed):
    require_marked(seed)


# Each rule alone


def arch(l1: object = 1, l2: object = 1, lean: int = 1, **options: object) -> pas.GeneratrixBlend:
    """Two parallel edges three apart; their tangents lean upwards."""
    first = Boundary.along(("s", "0", "0"), tangent=("0", "1", str(lean)), name="one")
    second = options.pop("second", None) or Boundary.along(("s", "3", "0"), tangent=("0", "-1", str(lean)), name="two")
    return generatrix_blend(first, second, GeneratrixShape(l1, l2), **({"unit": False} | options))


BACK = Boundary.along(("1 - s", "3", "2*s"), tangent=("0", "-1", "1"), name="two")


def off_plane(number: int, unit: bool = False) -> pas.GeneratrixBlend:
    """A boundary whose field is not perpendicular to its curve."""
    blend = arch(unit=unit)
    exact = blend.boundaries[number].exact
    bad = ExactCurve(
        exact.curve, tuple(n + v / 10**40 for n, v in zip(exact.normal, exact.velocity, strict=True)), True
    )
    items = list(blend.boundaries)
    items[number] = replace(items[number], exact=bad)
    made = replace(blend, frames=replace(blend.frames, boundaries=tuple(items)))
    made.__dict__["surface"] = blend.surface
    return made


RULES = {
    "nothing": (lambda: arch(), None, None),
    "contact 0: the curve": (lambda: tampered(arch(), 0, "curve"), 0, Status.REFUTED),
    "contact 0: the tangent plane": (lambda: tampered(arch(), 0, "plane"), 0, Status.REFUTED),
    "contact 0: the field": (lambda: off_plane(0), 0, Status.REFUTED),
    "contact 1: the curve": (lambda: tampered(arch(), 1, "curve"), 1, Status.REFUTED),
    "contact 1: the tangent plane": (lambda: tampered(arch(), 1, "plane"), 1, Status.REFUTED),
    "contact 1: the field": (lambda: off_plane(1), 1, Status.REFUTED),
    "sense": (lambda: arch(second=BACK, align=False), 2, Status.REFUTED),
    "regular: a cusp": (lambda: arch(3, 3, lean=0), 3, Status.REFUTED),
    "simple: a loop": (lambda: arch(9, 9), 4, Status.FAILS_MEASURED),
}


@pytest.mark.parametrize("name", RULES)
def test_each_claim_alone(name):
    make, number, status = RULES[name]
    verdicts = make().certificate.verdicts
    assert [i for i, v in enumerate(verdicts) if v.failed] == ([] if number is None else [number])
    if number is None:
        assert all(v.proved for v in verdicts)
    else:
        assert verdicts[number].status is status
        assert all(v.proved for v in verdicts[:3] if v is not verdicts[number])


@pytest.mark.parametrize("number", [0, 1])
def test_fields_off_the_plane_of_a_blend_that_is_not_exact(number):
    """Of vectors made of length one only the data are exact; they are looked at."""
    blend = off_plane(number, unit=True)
    assert not blend.surface.is_exact
    wanted = [Status.REFUTED if i == number else Status.PROVED for i in (0, 1)]
    assert [contact_verdict(blend, i).status for i in (0, 1)] == wanted


def test_sense_of_curves_whose_chords_are_perpendicular_is_measured():
    second = Boundary.along(("0", "3 + s", "0"), tangent=("-1", "-1", "1"))
    assert sense_verdict(arch(second=second)).measured


def test_sense_is_measured_where_chords_and_distances_disagree():
    """Both chords run along x, but corresponding points are nearer if one curve is reversed."""
    first = Boundary.along(("s", "0", "30*s*(1-s)*(1-2*s)"), tangent=("0", "1", "0"))
    second = Boundary.along(("s", "3", "-30*s*(1-s)*(1-2*s)"), tangent=("0", "-1", "0"))
    verdict = sense_verdict(generatrix_blend(first, second, GeneratrixShape(1, 1), align=False, unit=False))
    assert verdict.status is Status.FAILS_MEASURED and "apart on the average" in verdict.reason


@pytest.mark.parametrize("power", [1, 12, 17, 40, 300, 400])
@pytest.mark.parametrize("end", [0, 1])
def test_curves_that_stop_next_to_their_ends(power, end):
    """C' vanishes inside [0, 1] by 10^-power: there is no tangent there to be in contact with."""
    zero = Fraction(1, 10**power) if end == 0 else 1 - Fraction(1, 10**power)
    x = f"(s - {zero})^2 + s^3*0"
    with pytest.raises(pas.GeometryError, match="not regular"):
        Boundary.along((x, x, "0"), tangent=("0", "0", "1"))
    with pytest.raises(pas.GeometryError, match="vanishes"):
        Boundary.along(("s", "0", "0"), tangent=("0", f"s - {zero}", "0"))
    with pytest.raises(pas.GeometryError, match="along the curve"):
        Boundary.along(("s", "0", "0"), tangent=("1", f"s - {zero}", "0"))
    with pytest.raises(pas.GeometryError, match="denominator"):
        Boundary.along(("s", f"1/(s - {zero})", "0"), tangent=("0", "0", "1"))
    with pytest.raises(ValueError, match="l1 is"):
        GeneratrixShape(l1=ShapeFunction((zero**2, -2 * zero, Fraction(1))))
    with pytest.raises(ValueError, match="lambda1 is"):
        GeneratrixShape(lambda1=ShapeFunction((1 - zero**2, 2 * zero, Fraction(-1))))


@pytest.mark.parametrize("power", [12, 40, 300])
def test_lengths_that_only_come_near_zero(power):
    assert GeneratrixShape(l1=ShapeFunction((Fraction(1, 10**power), Fraction(1)))).l1 is not None
    raised = Fraction(1, 9) + Fraction(1, 10**power)
    assert GeneratrixShape(l1=ShapeFunction((raised, Fraction(-2, 3), Fraction(1)))).l1 is not None


@pytest.mark.parametrize("seed", range(12))
def test_bounds_of_ellipses(seed):
    """What is said of an ellipse for all angles holds at rational points of the circle, exactly."""
    draw = Random(seed)
    size = Fraction(10) ** draw.choice([p for p in SIZES if abs(p) <= 100])
    a, b, c = (Fraction(draw.randint(1, 30), 7) for _ in range(3))
    plane = f"z + ({Fraction(draw.randint(-9, 9), 30)})*x + ({Fraction(draw.randint(-9, 9), 30)})*y - ({c / 9 * size})"
    quadric = Quadric(f"({a})*x^2 + ({b})*y^2 + ({c})*z^2 + x*y/9 - ({size**2})")
    conic = conic_section(quadric, *read_plane(plane))
    bounds = ellipse_bounds(quadric, conic)
    assert 0 <= bounds.angle < 1e-9 and math.isfinite(bounds.distance)
    origin, first, second = ([Fraction(float(x)) for x in v] for v in (conic.origin, conic.first, conic.second))
    gradient = [quadric.polynomial.diff(i) for i in range(3)]
    for _ in range(5):
        u = Fraction(draw.randint(-50, 50), 17)
        cosine, sine = (1 - u * u) / (1 + u * u), 2 * u / (1 + u * u)
        point = [o + cosine * p + sine * q for o, p, q in zip(origin, first, second, strict=True)]
        tangent = [-sine * p + cosine * q for p, q in zip(first, second, strict=True)]
        slope = [g.at(point) for g in gradient]
        steep = sum(x * y for x, y in zip(tangent, slope, strict=True)) ** 2
        squares = sum(x * x for x in tangent) * sum(x * x for x in slope)
        assert steep <= Fraction(math.sin(bounds.angle)) ** 2 * squares
        assert quadric.polynomial.at(point) ** 2 <= Fraction(bounds.distance) ** 2 * sum(x * x for x in slope)


def test_open_boundaries_start_at_an_end():
    edge = Boundary.along(("s", "0", "0"), tangent=("0", "1", "0"))
    for phase, backwards in ((1.0, False), (0.0, True), (0.5, False)):
        with pytest.raises(ValueError, match="is open: it starts"):
            replace(edge, phase=phase, backwards=backwards)
    assert edge.turned(True, 0).turned(True, 0)(0.25)[0] == 0.25


# What the marks come to elsewhere


def test_marks_are_kept_in_records():
    for status in Status:
        verdict = Verdict(status, "a claim", "a reason", (1.0, 2.0, 3.0), 4)
        assert Verdict.from_record(verdict.to_record()) == verdict
        assert verdict.proved is (status is Status.PROVED)
        assert verdict.measured is (status in (Status.HOLDS_MEASURED, Status.FAILS_MEASURED))
        assert verdict.failed is (status in (Status.REFUTED, Status.FAILS_MEASURED))
    old = {"claim": "a", "status": "refuted", "reason": "b", "witness": None, "measure": 0}
    assert Verdict.from_record(old).status is Status.REFUTED


def test_counts_in_words():
    def some(*statuses: Status) -> Findings:
        return Findings(tuple(Verdict(s, "", "") for s in statuses))

    assert some(Status.PROVED, Status.PROVED).counts == "all proved"
    assert some().counts == "nothing claimed, nothing proved"
    mixed = some(Status.FAILS_MEASURED, Status.PROVED, Status.HOLDS_MEASURED, Status.HOLDS_MEASURED, Status.UNDECIDED)
    assert mixed.counts == "1 proved; 1 undecided; 2 measured to hold; 1 measured to fail"


def test_measured_contacts_of_parametric_blends():
    """Sines: the right blend holds, one with another surface fails, both as measured; nothing is refuted."""
    waves = [pas.ParametricSurface("t", "h", f"sin(t + {i})*h/3") for i in (0, 1)]
    data = pas.BlendingData(waves)
    right = pas.hermite_blend(data, 1).prove()
    assert all(v.status is Status.HOLDS_MEASURED for v in right.contacts)
    other = pas.BlendingData([waves[0], pas.ParametricSurface("t", "h", "sin(t)*h/3 + h^2/50")])
    from pas.parametric.data import contact_verdicts

    wrong = contact_verdicts(pas.hermite_blend(data, 1).surface, other, 1)
    assert [v.status for v in wrong] == [Status.HOLDS_MEASURED, Status.FAILS_MEASURED]
    for power in (-200, 200):
        scaled = [s.moved([[f"1e{power}", 0, 0], [0, f"1e{power}", 0], [0, 0, f"1e{power}"]]) for s in other.surfaces]
        blend = pas.hermite_blend(data, 1).surface.moved(
            [[f"1e{power}", 0, 0], [0, f"1e{power}", 0], [0, 0, f"1e{power}"]]
        )
        again = contact_verdicts(blend, pas.BlendingData(scaled), 1)
        assert [v.status for v in again] == [Status.HOLDS_MEASURED, Status.FAILS_MEASURED]
