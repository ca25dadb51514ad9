"""What every public class shows of itself: a short repr, and formulas as LaTeX."""

from __future__ import annotations

import inspect
import re
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import UNEQUAL, fair, pipes, solved
from flint import fmpq
from matplotlib.mathtext import MathTextParser
from test_contact_kinds import SAMPLES as CONTACT_SAMPLES

import pas
from pas import solid
from pas.algebra.brief import LONGEST, brief, cut
from pas.contacts.contact import CONTACTS
from pas.fairing.basis import to_doubles
from pas.fairing.solver import FitSolver
from pas.shape import KINDS

FOUR_RAYS = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, -1, -1))
LONG = pas.Polynomial("(1 + 2*x/3 + 3*y + 4*z/7)^9")


@cache
def parametric():
    data = pas.BlendingData([pas.elliptic_cylinder(1, 1), pas.elliptic_cylinder(2, 2)], values=[0, 1])
    return pas.hermite_blend(data, order=2)


@cache
def generatrix():
    return pas.blend_quadrics("x^2 + y^2 + z^2 - 4", "z - 1", "x^2 + y^2 - (z - 7)^2/9", "z - 5")


@cache
def space():
    elbow = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
    return pas.solutions(elbow, order=1, partition=pas.SingleCell((-2, -2, -2), (2, 2, 2)))


def corner():
    return solved(("1/3", "1/3", "1/3"), 1)


def sphere():
    curves = [pas.plane_section("x^2 + y^2 - 1", f"z - {h}") for h in (2, -2)]
    return pas.blend_through_sphere(curves, (0, 0, 0), 1)


def ball():
    return solid.ball((0, 0, 0), 1)


def tetrahedron():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    zero = np.zeros(4, dtype=int)
    boundary = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return pas.VolumeMesh(points, np.array([[0, 1, 2, 3]]), zero[:1], ("part",), boundary, zero, ("face",))


@cache
def cubics():
    cylinders = [("x^2 + y^2 - 1", "z"), ("x^2 + y^2 - 4", "z - 2")]
    return pas.solutions(cylinders, order=1, degree=4, partition=pas.SingleCell((-3, -3, 0), (3, 3, 2)))


def existence():
    return pas.existence([("y^2 + z^2 - r^2", "x - 1"), ("x^2 + z^2 - r^2", "y - 1")], 1, 3, ("r",))


SAMPLES = {
    "ConvexProblem": lambda: pas.solutions(pipes(), 1, 4).problem(),
    "Session": pas.Session,
    "Alignment": lambda: generatrix().alignment,
    "BasePoint": lambda: pas.BasePoint("x", 0.25, 0.5),
    "Blend": corner,
    "BlendingData": lambda: parametric().data,
    "Boundary": lambda: generatrix().boundaries[0],
    "Box": lambda: pas.Box((0, 0, 0), (1, 1, 1)),
    "Certificate": lambda: corner().certificate,
    "Contact": lambda: pas.Contact(LONG, "x"),
    "ContactEnd": lambda: pas.ContactEnd.of(pipes()[0], (0, 0, 0)),
    "Crossings": lambda: pas.Evaluator(LONG).rays(np.eye(3), [(1, 2, 3)]),
    "CurvatureContact": lambda: pas.curvature_contact(LONG, LONG, (LONG, "x - 1")),
    "Evaluator": lambda: pas.Evaluator(corner().surface),
    "Existence": existence,
    "ExistenceCase": lambda: existence().cases[0],
    "FittedPatch": lambda: pas.fit_patch(pas.torus(2, 1), 0.1, ((-1, 1), (-1, 1))),
    "Generator": lambda: space().generators[0],
    "GeneratrixBlend": generatrix,
    "GeneratrixCertificate": lambda: generatrix().certificate,
    "GeneratrixShape": lambda: generatrix().shape,
    "HollowBlend": lambda: corner().hollow("1/10"),
    "Ideal": lambda: pas.Ideal(LONG, LONG * "x"),
    "IsolatedPoint": lambda: pas.IsolatedPoint(1, "x", 0.5, fmpq(1, 3), "t - 1/2", next(iter(pas.PointKind))),
    "Layout": lambda: pas.Layout(
        np.vstack([np.eye(3, dtype=int), [(-1, -1, -1)]]), [(0, 1, 2), (1, 0, 3), (2, 1, 3), (0, 2, 3)]
    ),
    "LeastSquares": lambda: cubics().least_squares(np.random.default_rng(0).random((40, 3))),
    "MeanAlpha": pas.MeanAlpha,
    "Kind": lambda: KINDS["solid"],
    "Membrane": pas.Membrane,
    "Mesh": lambda: ball().mesh(0.1),
    "Multipliers": lambda: space().multipliers[0],
    "NormalFormSystem": lambda: pas.normal_form_system([("x^2 + y^2 - 1", "z")], 1, 4),
    "Optimum": lambda: cubics().optimum(through=[(1.2, 0, 1)]),
    "ParametricBlend": parametric,
    "ParametricCertificate": lambda: parametric().prove(((-1, 1), (0, 1))),
    "ParametricMesh": lambda: parametric().mesh(1e-1, domain=((-1, 1), (0, 1))),
    "ParametricSolutions": lambda: parametric().all_solutions(),
    "ParametricSurface": lambda: parametric().surface,
    "Partition": lambda: pas.Partition([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)]),
    "Region": lambda: pas.Region([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)], title="one"),
    "Opening": lambda: pas.Opening("(x + y/3 + z/7)^2 + 3*x*z - 11/13", (1, 0, 0), "1/2"),
    "OpenRegion": lambda: pas.OpenRegion([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)], (0, 0, 0)),
    "Picture": pas.Picture,
    "PiecewiseSurface": lambda: corner().surface,
    "Pipe": lambda: pipes()[0],
    "Energy": lambda: pas.CurvatureVariation() + pas.ThinPlate() / 100,
    "CurvatureVariation": lambda: pas.CurvatureVariation(tension="7/3"),
    "Sizes": lambda: pas.Sizes(0.5, 1.0),
    "SurfacePoints": lambda: seen(),
    "Fairness": lambda: corner().surface.fairness(),
    "FairnessLimits": lambda: pas.FairnessLimits.of_order(2),
    "Cone": lambda: pas.Cone((1, 0, 0), "1/3", 1, "1/10"),
    "AlfeldSplit": pas.AlfeldSplit,
    "KuhnCube": pas.KuhnCube,
    "WorseyFarinSplit": pas.WorseyFarinSplit,
    "EllipticPipe": lambda: pas.EllipticPipe((1, 0, 0), [(0, "1/2", 0), (0, 0, "1/3")], 1),
    "Ellipsoid": lambda: pas.Ellipsoid((1, 0, 0), [(2, 0, 0), (0, "1/2", 0), (0, 0, "1/3")], "1/7", ("1/9", 0, 0)),
    "Hyperboloid": lambda: pas.Hyperboloid((1, 0, 0), [(0, "1/2", 0), (0, 0, "1/3")], 1, 2),
    "Paraboloid": lambda: pas.Paraboloid((1, 0, 0), [(0, "1/2", 0), (0, 0, "1/3")], 1),
    "Plate": lambda: pas.Plate((0, 0, 1), "1/2"),
    "QuadricContact": lambda: pas.QuadricContact("(x + y/3 + z/7 - 1)^2 + 3*x*z - 11/13", "x - 1"),
    "Sphere": lambda: pas.Sphere((1, 0, 0), 1, "1/2"),
    "Torus": lambda: pas.Torus((0, 0, 1), (2, 0, 0), "1/2"),
    "PointKind": lambda: next(iter(pas.PointKind)),
    "Polynomial": lambda: LONG,
    "PolynomialCriterion": lambda: pas.has_polynomial_solution(parametric().data, 2),
    "Quadric": lambda: pas.Quadric("x^2 + y^2 + z^2 - 4"),
    "QuadricBranch": lambda: pas.quadric_intersection("x^2 + y^2 + z^2 - 4", "x^2 + y^2 - z^2 - 1")[0],
    "QuadricKind": lambda: next(iter(pas.QuadricKind)),
    "RationalFunction": lambda: pas.RationalFunction("(1 + t + 3*h)^9/(2 + t - h)^8"),
    "RationalPatch": lambda: pas.bezier_patches(parametric().surface, ((-1, 1), (0, 1)))[0],
    "ShapeFunction": lambda: pas.ShapeFunction.through([(0, 1), ("1/3", 2), ("2/3", "7/5"), (1, 1)]),
    "SingleCell": lambda: pas.SingleCell((-2, -2, -2), (2, 2, 2)),
    "SixTetrahedra": pas.SixTetrahedra,
    "SolutionSpace": space,
    "SphereBlend": sphere,
    "Status": lambda: pas.Status.PROVED,
    "Style": lambda: pas.Style.ZEBRA,
    "Submodule": lambda: pas.Submodule([LONG, "x"], [LONG, "y"]),
    "SumOfCoefficients": pas.SumOfCoefficients,
    "SurfaceCurve": lambda: pas.iso_curve(parametric().surface, h=0),
    "Teapot": lambda: pas.teapot("paper"),
    "ThinPlate": lambda: pas.ThinPlate(pas.Box((0, 0, 0), (1, 1, 1))),
    "TrivialPart": lambda: space().trivial_part,
    "UnitCoefficients": pas.UnitCoefficients,
    "ValueAt": lambda: pas.ValueAt((0, 0, 0), -1),
    "Verdict": lambda: corner().certificate.one_sheet,
    "VolumeMesh": tetrahedron,
    "VolumeSettings": pas.VolumeSettings,
    "WeightPole": lambda: pas.WeightPole(0, 0.5, True),
    "Weights": lambda: pas.Weights([0, 1], 2),
    "SolvingMethod": lambda: pas.SolvingMethod("mine", corner, True),
    "Wishes": lambda: pas.Wishes(inside=np.random.default_rng(0).random((40, 3)).tolist()),
    "solid.Assembly": lambda: solid.assembly({f"part number {i}": ball() for i in range(50)}),
    "solid.Joint": lambda: solid.Joint("a", "b", (LONG, "x"), 1),
    "solid.Part": lambda: solid.assembly(ball=ball())["ball"],
    "solid.Profile": lambda: solid.rounded_rectangle(LONGEST, 3, 1) - solid.circle((2, 2), "1/2"),
    "solid.Sketch": lambda: solid.sketch().line_to(1, 0).arc_to(2, 1).line_to(2, 3),
    "solid.Solid": lambda: solid.union([solid.ball((i, 0, 0), 1, f"ball {i}") for i in range(50)]),
    "solid.SolidMesh": lambda: ball().mesh(0.1),
}
"""An object of each public class: a large one where there are large ones."""


def seen():
    """What an energy sees of a corner."""
    space = pas.solutions(pipes(), 1, 4)
    solver = FitSolver(space.prepared, pas.Wishes(prove=False).settled(space.placed))
    found = solver.fitted()
    return solver.iterate(to_doubles(found.working)[0], found.rows).value.sampled.points


def public_classes():
    for room, prefix in ((pas, ""), (solid, "solid.")):
        for name in room.__all__:
            thing = getattr(room, name)
            if inspect.isclass(thing) and not issubclass(thing, Exception) and not inspect.isabstract(thing):
                yield prefix + name, thing


def test_every_public_class_has_a_sample():
    names = {name for name, _ in public_classes()}
    assert not names - set(SAMPLES), "add an object of each of these classes to SAMPLES"
    assert not set(SAMPLES) - names, "these classes are no longer public"


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("name", "kind"), [c for c in public_classes() if c[0] in SAMPLES])
def test_reprs_are_short(name, kind):
    sample = SAMPLES[name]()
    assert isinstance(sample, kind)
    text = repr(sample)
    assert len(text) <= LONGEST, text[: 2 * LONGEST]
    assert kind.__name__.lower() in text.lower().replace(" ", "") or kind is not type(sample)
    assert "object at 0x" not in text


def test_what_a_surface_is_placed_on_says_so():
    assert re.fullmatch(r"<PlacedContacts: 3 contacts, GC\^\d, .+>", repr(corner().surface.placed))


def test_long_formulas_keep_their_ends():
    assert repr(LONG).startswith("<Polynomial of degree 9 with 220 terms: 512/19683*x^9 + ")
    assert repr(LONG).endswith("36/7*z + 1>")
    assert repr(pas.Polynomial("x^2 - 1/9")) == "Polynomial('x^2 - 1/9')"
    assert repr(solid.union([solid.ball((i, 0, 0), 1, f"ball {i}") for i in range(50)])).endswith(" and 31 more>")
    assert repr(pas.Ideal("x^2", "y")) == "Ideal('x^2', 'y')"
    assert repr(pas.Ideal(LONG, "y")).startswith("<Ideal of 2 generators: '512/19683*x^9")


def test_brief_shortens_each_field():
    assert brief(pas.WeightPole(0, 0.5, True)) == "WeightPole(weight=0, h=0.5, inside=True)"
    assert "points=<float64 (4, 3)>" in repr(tetrahedron())
    assert "witness=None" not in repr(corner().certificate)
    assert cut("a" * 300, 20) == "a" * 12 + "..." + "a" * 5


FORMULAS = {
    "y^12 + x^2 - 1/9": r"y^{12} + x^{2} - \frac{1}{9}",
    "-4/9*x*y^2 - z": r"-\frac{4}{9} x y^{2} - z",
    "0": "0",
    "123456789012345678901/2*x": r"\frac{123456\ldots_{21\text{ digits}}}{2} x",
}


@pytest.mark.parametrize("text", FORMULAS)
def test_polynomials_as_latex(text):
    assert pas.Polynomial(text)._repr_latex_() == f"${FORMULAS[text]}$"


def test_long_and_rational_latex():
    text = LONG._repr_latex_()
    assert text.endswith(r"+ \cdots \text{ (220 terms)}$")
    assert text.count(" + ") == 22 + 1
    assert text.count("{") == text.count("}")
    assert pas.RationalFunction("t^2/(1 + h)")._repr_latex_() == r"$\frac{t^{2}}{h + 1}$"
    assert pas.RationalFunction("t^2/2")._repr_latex_() == r"$\frac{1}{2} t^{2}$"


def test_solution_spaces_as_latex():
    elbow = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
    space = pas.solutions(elbow, order=1, partition=pas.SingleCell((-2, -2, -2), (2, 2, 2)))
    text = space._repr_latex_()
    assert text.startswith(r"$GC^{1},\ n = 3,\ \dim = 1:\quad \langle ") and text.endswith(r"\rangle$")
    assert "x^{3}" in text
    assert pas.solutions(pipes(), 1, 4)._repr_latex_() == r"$GC^{1},\ n = 4,\ \dim = 25$"
    assert r"\ldots" in pas.solutions(elbow, 1, 4, pas.SingleCell())._repr_latex_()


def test_contacts_and_measures_in_notebooks():
    """Formulas that matplotlib reads, and well-formed tables."""
    parser = MathTextParser("path")
    pipe = pas.Pipe((1, 0, 0), "1/3", 1)
    assert pipe._repr_latex_() == r"$y^{2} + z^{2} - \frac{1}{9} = 0, \quad x - 1 = 0$"
    for table, arguments in CONTACT_SAMPLES.items():
        parser.parse(CONTACTS[table](**arguments)._repr_latex_())
    assert pas.Pipe((1, 0, 0), "1/3", "auto")._repr_latex_() is None
    fairness = fair(UNEQUAL, 1).fairness
    root = ElementTree.fromstring(fairness._repr_html_())
    assert [row[0].text for row in root] == [name for name, _ in fairness.lines()]
    assert ElementTree.fromstring(f"<div>{fair(UNEQUAL, 1).certificate._repr_html_()}</div>").find("table") is not None
    for thing in (pas.contact_ideal(pipe, 1), pas.syzygies(["x", "y^2"]), pas.solutions(pipes(), 1, 3)):
        parser.parse(thing._repr_latex_())
