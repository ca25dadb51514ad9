"""Proofs: good surfaces pass, surfaces built to be wrong are refuted where they are wrong."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, product
from math import comb, factorial

import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, solved

import pas
from pas import PiecewiseSurface, Polynomial, Status


def rebuilt(surface: PiecewiseSurface, change) -> PiecewiseSurface:
    """The surface with `change(number, polynomial)` in place of each cell's polynomial."""
    polynomials = [change(i, cell.polynomial) for i, cell in enumerate(surface.cells)]
    return PiecewiseSurface.from_polynomials(surface.partition, surface.contacts, surface.order, polynomials)


@pytest.fixture(scope="module", params=[1, 2])
def good(request) -> PiecewiseSurface:
    """A proved surface."""
    return solved(EQUAL, request.param).surface


def test_good_is_proved(good):
    certificate = good.certify()
    assert certificate.proved
    assert [v.status for v in certificate.verdicts] == [Status.PROVED] * 11
    assert "proved" in str(certificate)


@pytest.mark.parametrize("cell", range(6))
@pytest.mark.parametrize("term", ["x*y*z", "1", "z^2"])
def test_one_coefficient_changed_is_refuted(good, cell, term):
    wrong = rebuilt(good, lambda i, p: p + Polynomial(term) / 10**12 if i == cell else p)
    certificate = wrong.certify()
    assert not certificate.proved
    faces = good.partition.interior_faces
    for face, verdict in zip(faces, certificate.faces, strict=True):
        touched = cell in (face.first, face.second)
        assert verdict.status is (Status.REFUTED if touched else Status.PROVED)
        if touched:
            assert abs(face.plane(np.array(verdict.witness))) < 1e-9
    for number, verdict in enumerate(certificate.contacts):
        assert verdict.status is (Status.REFUTED if cell == 2 * number else Status.PROVED)


def test_a_contact_broken_without_the_faces_is_refuted(good):
    k = good.order
    planes = [f.plane for f in good.partition.interior_faces if 0 in (f.first, f.second)]
    bump = (planes[0] * planes[1]) ** (k + 1) / 10**9
    certificate = rebuilt(good, lambda i, p: p + bump if i == 0 else p).certify()
    assert all(v.proved for v in certificate.faces)
    assert [v.proved for v in certificate.contacts] == [False, True, True]
    assert certificate.contacts[0].status is Status.REFUTED
    witness = np.array(certificate.contacts[0].witness)
    assert good.contacts[0].surface(witness) == pytest.approx(0, abs=1e-9)
    assert good.contacts[0].clip(witness) == pytest.approx(0, abs=1e-9)


def test_a_lower_order_of_contact_is_named(good):
    k = good.order
    wrong = rebuilt(good, lambda i, p: p + good.contacts[0].clip ** k * (1 if i == 0 else 0))
    verdict = wrong.certify().contacts[0]
    assert verdict.status is Status.REFUTED
    assert f"GC^{k - 1} only" in verdict.reason


def test_alpha_of_changing_sign_is_refuted(good):
    certificate = rebuilt(good, lambda _, p: p * (Polynomial("y + z/3") - "1/10")).certify()
    assert all(v.proved for v in certificate.faces)
    assert certificate.contacts[0].status is Status.REFUTED
    assert "alpha" in certificate.contacts[0].reason
    witness = np.array(certificate.contacts[0].witness)
    assert (Polynomial("y + z/3") - "1/10")(witness) < 1e-6


def test_a_surface_turned_inside_out_is_refuted(good):
    certificate = rebuilt(good, lambda _, p: -p).certify()
    assert [v.status for v in certificate.contacts] == [Status.REFUTED] * 3
    assert certificate.one_sheet.status is Status.REFUTED
    assert certificate.enclosed.status is Status.REFUTED


@pytest.mark.parametrize("radius", ["1/8", "1/50"])
def test_a_bubble_is_refuted(good, radius):
    bubble = Polynomial("(x + 1/4)^2 + y^2 + (z - 1/9)^2") - Polynomial(radius) ** 2
    certificate = rebuilt(good, lambda _, p: p * bubble).certify()
    assert all(v.proved for v in (*certificate.contacts, *certificate.faces, certificate.enclosed))
    assert certificate.one_sheet.status is Status.REFUTED
    witness = np.array(certificate.one_sheet.witness)
    assert abs(bubble(witness)) < 0.05


def test_a_bubble_outside_is_refuted(good):
    bubble = Polynomial("(x + 3/4)^2 + (y + 3/4)^2 + (z + 3/4)^2 - 1/400")
    certificate = rebuilt(good, lambda _, p: p * bubble).certify()
    assert certificate.one_sheet.status is Status.REFUTED
    assert certificate.enclosed.proved


def test_a_second_sheet_through_the_walls_is_refuted(good):
    certificate = rebuilt(good, lambda _, p: p * Polynomial("14/5 - x - y - z")).certify()
    assert all(v.proved for v in (*certificate.contacts, *certificate.faces))
    assert certificate.enclosed.status is Status.REFUTED
    witness = np.array(certificate.enclosed.witness)
    assert witness.sum() > 2.8
    assert certificate.one_sheet.status is Status.REFUTED


def test_a_singular_point_is_not_proved(good):
    certificate = rebuilt(good, lambda _, p: p * Polynomial("(x + 1/4)^2 + y^2 + z^2")).certify()
    assert not certificate.one_sheet.proved


def test_a_surface_that_misses_its_clip_face_is_refuted(good):
    # the sheet of the pipe is there, and a second one that meets the clip face off the circle
    second = Polynomial("(x - 1)^2 + (y - 1/2)^2 + (z - 2/5)^2 - 1/400")
    certificate = rebuilt(good, lambda _, p: p * second).certify()
    assert certificate.enclosed.status is Status.REFUTED
    assert certificate.contacts[0].proved


@pytest.mark.parametrize(("radii", "order"), [(EQUAL, 1), (EQUAL, 2), (UNEQUAL, 1), (UNEQUAL, 2)])
def test_rays_confirm_the_single_sheet(radii, order):
    """Sampling, independent of the proof: along rays from the centre the sign changes once."""
    surface = solved(radii, order).surface
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    t = np.linspace(0.01, 1.7, 170)
    values = surface(t[:, None, None] * directions)
    signs = np.where(np.isnan(values), 0, np.sign(values))
    rises = (signs[:-1] < 0) & (signs[1:] > 0)
    falls = (signs[:-1] > 0) & (signs[1:] < 0)
    assert not falls.any()
    assert rises.sum(axis=0).max() == 1
    assert rises.any(axis=0).mean() > 0.8


def exact_sheet_proof(surface: PiecewiseSurface, halvings: int) -> int:
    """The one-sheet proof in rational arithmetic, by de Casteljau's algorithm on Fractions.

    Shares no code with the proof it checks but the exact polynomials.  Returns the number of
    tetrahedra examined, or raises AssertionError where one stays open.
    """
    examined = 0
    for cell in surface.cells:
        radial = sum((Polynomial(v) * cell.polynomial.diff(v) for v in "xyz"), Polynomial(0))
        stack = [(blossom(cell.polynomial, cell.vertices), blossom(radial, cell.vertices), cell.vertices, 0)]
        while stack:
            f, p, corners, depth = stack.pop()
            examined += 1
            if min(f.values()) > 0 or max(f.values()) < 0 or min(p.values()) > 0 or made_up(p, f):
                continue
            assert depth < halvings
            pairs = [
                (sum((a - b) ** 2 for a, b in zip(corners[i], corners[j], strict=True)), i, j)
                for i in range(4)
                for j in range(i)
            ]
            _, i, j = max(pairs)
            middle = tuple((a + b) / 2 for a, b in zip(corners[i], corners[j], strict=True))
            for stays, moves in ((i, j), (j, i)):
                half = list(corners)
                half[moves] = middle
                stack.append((halved(f, stays, moves), halved(p, stays, moves), tuple(half), depth + 1))
    return examined


def made_up(p: dict, f: dict) -> bool:
    """Whether all coefficients of p + t f are positive for the middle of the t that their signs allow."""
    low = max(-p[i] / f[i] for i in f if f[i] > 0)
    high = min(-p[i] / f[i] for i in f if f[i] < 0)
    return all(p[i] + (low + high) / 2 * f[i] > 0 for i in f)


def blossom(p: Polynomial, corners) -> dict:
    """B-coefficients of a cubic: its polar form at the corners, by the polarisation identity."""
    degree = 3
    result = {}
    for index in product(range(degree + 1), repeat=4):
        if sum(index) == degree:
            u = [corners[i] for i in range(4) for _ in range(index[i])]
            total = Fraction(0)
            for size in range(1, degree + 1):
                for chosen in combinations(u, size):
                    mean = [sum(c) / Fraction(size) for c in zip(*chosen, strict=True)]
                    total += (-1) ** (degree - size) * Fraction(size) ** degree * p.at(mean)
            result[index] = total / factorial(degree)
    return result


def halved(form: dict, stays: int, moves: int) -> dict:
    """De Casteljau at the midpoint of an edge."""
    result = {}
    for index in form:
        m = index[moves]
        total = Fraction(0)
        for j in range(m + 1):
            source = list(index)
            source[moves] = j
            source[stays] += m - j
            total += comb(m, j) * form[tuple(source)]
        result[index] = total / 2**m
    return result


def test_the_proof_holds_in_rational_arithmetic():
    surface = solved(EQUAL, 1).surface
    assert surface.degree == 3
    examined = exact_sheet_proof(surface, halvings=24)
    assert examined == pytest.approx(surface.certify().one_sheet.measure, rel=0.2)


def test_verdicts_are_no_booleans(good):
    certificate = good.certify()
    with pytest.raises(TypeError, match="proved"):
        bool(certificate)
    with pytest.raises(TypeError, match="status"):
        bool(certificate.one_sheet)
    assert pas.Certificate.from_record(certificate.to_record()) == certificate
