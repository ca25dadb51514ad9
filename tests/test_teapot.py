"""The teapot: printed polynomials and their joints, and both teapots as the program builds them."""

from __future__ import annotations

import hashlib
import json
import re
import runpy
import subprocess
import sys
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from conftest import ROOT

import pas
from pas import solid
from pas.designs import STYLES, Body, Handle, Lid, PaperHandle, PaperSpout, PrintedSpout, Spout, points, teapot

FACTS = json.loads((ROOT / "tests" / "data" / "teapot.json").read_text())
VOLUMES = {"paper": 11.25, "better": 11.14}
"""Of the patches of the facts."""

ORDERS = {"paper": [0] * 4 + [1] * 2 + [2] * 2, "better": [0] + [1] * 9 + [2] * 6}


@cache
def built(style, **wishes):
    """A teapot, built once for all tests."""
    return teapot(style, **wishes)


def definitions(style):
    """All polynomials of a style by name, evaluated exactly."""
    names = {v: pas.Polynomial(v) for v in "xyz"}

    def value(text):
        text = re.sub(r"(?<!\w)(\d+)", r"Fraction(\1)", text.replace("^", "**"))
        text = re.sub(r"\*\*Fraction\((\d+)\)", r"**\1", text)
        text = re.sub(r"/([ab])\b", r"*(1/\1)", text)
        result = eval(text, {"Fraction": Fraction}, names)
        return result if isinstance(result, pas.Polynomial | Fraction) else pas.Polynomial(result)

    for name, text in (FACTS["defs"] | FACTS[style]["defs"]).items():
        if name != "f1_printed":
            names[name] = value(text)
    return names, value


def from_facts(style):
    """The solid of the printed patches and joints."""
    names, value = definitions(style)
    shape, face = None, {}
    for name, polynomial, region in FACTS[style]["patches"]:
        walls = [value(r) for r in region if not r.startswith("max")]
        if polynomial in ("spl", "spu"):
            walls.append(pas.Polynomial("1/4 - y^2"))  # other sheets far from the spout
        part = solid.patch(name, names[polynomial], *walls)
        shape = part if shape is None else shape | part
        face.setdefault(polynomial, name)
    if style == "better":
        for tube, quadric in (("Tu", "q1"), ("Tl", "q2")):
            a = names["a"]
            shape |= solid.patch("handle tube", names[tube], names[quadric], -(names[quadric] - a), "-x")
    for p, q, g, h, order in FACTS[style]["joints"]:
        shape = shape.joined(face[p], face[q], (value(g), value(h)), order)
    return shape


@pytest.mark.parametrize("style", ["paper", "better"])
@pytest.mark.slow
def test_printed_patches_make_one_closed_solid_with_all_joints(style):
    shape = from_facts(style)
    assert shape.proved
    assert all(f"exactly GC^{j.order}" in v.reason for j, v in zip(shape.joints, shape.verdicts, strict=True))
    mesh = shape.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    assert shape.volume(1e-2) == pytest.approx(VOLUMES[style], abs=6e-3)


def test_lid_and_body_come_out_as_printed():
    names, _ = definitions("paper")
    body = Body()
    made = Lid(height="7/5").solid(body).polynomials
    assert made["lid knob"] == (names["lid3"],)
    assert made["lid blend"][0].primitive() == names["lid2"].primitive()
    assert made["lid dome"] == (names["lid1"],)
    assert body.upper == names["q1"]
    assert names["q2"] == body.lower


def test_spouts_are_members_of_their_ideals():
    names, _ = definitions("paper")
    lower, upper = PaperSpout().cubics(Body())
    both = pas.contact_ideal((names["q2"], names["h1"]), 0) & pas.contact_ideal((names["kz"], names["h2"]), 0)
    assert lower in both
    assert names["spl"] in both
    assert names["Gd"] == names["Gd"]
    for generator in ("G0", "Gd", "Ge"):
        assert names[generator] in both
    assert upper in pas.contact_ideal((lower, names["h2"]), 1)


def quotient(polynomial, points):
    """What the published spout makes small: the sum of squares at points (x, z) over that of all coefficients."""
    values = sum(float(polynomial.at((x, 0, z))) ** 2 for x, z in points)
    return values / sum(float(c) ** 2 for c in polynomial.coefficients().values())


def test_the_published_spout_is_the_printed_one_and_as_close_to_its_points():
    printed = pas.Polynomial(FACTS["defs"]["f1_printed"])
    points = [tuple(map(Fraction, map(str, p))) for p in FACTS["spout_points_lower_xz"]]
    assert PaperSpout().lower_outline == tuple(points)
    assert PrintedSpout().printed == printed
    (fitted, _), (kept, _) = PaperSpout().cubics(Body()), PrintedSpout().cubics(Body())
    assert max(abs(c) for c in (kept - printed).coefficients().values()) < 4e-7
    unit = fitted / Fraction(sum(float(c) ** 2 for c in fitted.coefficients().values()) ** 0.5)
    assert max(abs(c) for c in (unit - printed).coefficients().values()) < 5e-6
    found, there, nearest = (quotient(p, points) for p in (fitted, printed, kept))
    assert found == pytest.approx(1.882311e-6, rel=1e-6)
    assert found <= nearest * (1 + 1e-12) == pytest.approx(found, rel=1e-6)
    assert found < there == pytest.approx(1.882627e-6, rel=1e-6)


def test_the_printed_spout_makes_a_pot():
    pot = teapot("paper", spout=PrintedSpout())
    assert pot.solid.proved
    assert sorted(j.order for j in pot.solid.joints) == sorted(order for *_, order in FACTS["paper"]["joints"])


@pytest.mark.parametrize("style", ["paper", pytest.param("better", marks=pytest.mark.slow)])
def test_teapots_are_closed_joined_and_of_the_known_volume(style):
    pot = built(style)
    shape = pot.solid
    assert shape.proved
    assert sorted(j.order for j in shape.joints) == ORDERS[style]
    assert all(f"exactly GC^{j.order}" in v.reason for j, v in zip(shape.joints, shape.verdicts, strict=True))
    mesh = shape.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    assert not any("= 0" in name for name in mesh.names)  # nothing is left open between patches
    assert shape.volume(1e-2) == pytest.approx(VOLUMES[style], rel=1e-2)
    cover = pot.lid.mesh(1e-2)
    assert (cover.is_closed, cover.components, cover.euler_characteristic) == (True, 1, 2)


DIGESTS = {
    "paper": ({"style": "paper"}, 12, "28825ff91c5e8f20"),
    "paper, other": ({"style": "paper", "spout_tilt": "-1/10", "handle_size": "21/20"}, 12, "bda7d71a536034ed"),
}
"""Wishes, number of faces, and the first digits of the SHA-256 of all polynomials, as the constants gave them."""


@pytest.mark.parametrize("name", DIGESTS)
def test_designs_give_the_same_polynomials_bit_for_bit(name):
    wishes, number, digest = DIGESTS[name]
    faces = {k: v for part in ("pot", "lid", "solid") for k, v in getattr(built(**wishes), part).polynomials.items()}
    assert len(faces) == number
    text = "\n".join(f"{face}: {p}" for face in sorted(faces) for p in faces[face])
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == digest


@pytest.mark.slow
def test_the_spout_bends_smoothly_and_its_wall_is_as_thick_as_wished():
    spout = Spout(wall="1/16")
    for number, bend in enumerate(spout.bends, 1):
        assert bend.certificate.proved
        assert bend.fairness.within(bend.limits)
        assert {contact.surface for contact in bend.surface.contacts} == {
            cone.contact.surface for cone in spout.cones(number)
        }
    assert Spout(wall=0).channel() is None
    outer, inner = spout.cones(1), spout.cones(1, spout.wall)
    assert all(16 * (a.radius - b.radius) == 1 for a, b in zip(outer, inner, strict=True))


def test_a_body_goes_through_its_profile():
    profile = [(1.118, -0.8), (1.4524, -0.3), (1.5, 0.0), (1.4142, 0.4)]  # of the usual body
    body = Body.through(profile, rim="6/5")
    assert all(abs(body.lower((r, 0, z))) < 1e-3 for r, z in profile)
    assert abs(body.lower.at((1, 0, 0)) + Fraction(5, 9)) < Fraction(1, 1000)
    assert body.upper.at((body.rim, 0, body.top)) == 0
    with pytest.raises(pas.GeometryError, match="at least three points"):
        Body.through([(1, 0), (1, 0), (1, 0)])
    with pytest.warns(UserWarning, match=r"the body is 0\.\d+ away from the point \(.*\) of its profile"):
        Body.through([(1, -0.8), ("3/2", "-1/2"), (1, 0), ("3/2", 0.3)])


@pytest.mark.slow
def test_what_is_right_for_a_spout_that_is_too_fat():
    fat = Spout(axis=((1, -0.3, 0.6), (2.12, -0.02, 0.5), (2.42, 0.78, 0.13), (2.8, 1.15, 0.11)))
    with pytest.raises(pas.GeometryError, match=r"body lower meets spout fillet .*; a fillet needs room .* a thinner"):
        teapot(spout=fat)


@pytest.mark.slow
def test_the_hollow_pot_pours():
    hollow = built("better").pot
    mesh = hollow.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, -2)
    axis = [[float(x), 0, float(z)] for x, z, _ in Spout().axis]
    assert not hollow.contains([[0, 0, 0], *axis]).any()
    assert hollow.contains([[1.45, 0, 0.2], [0, 0, -0.75], [-2.3, 0, 0.1]]).all()


@pytest.mark.slow
@pytest.mark.parametrize("style", ["paper", "better"])
def test_pots_and_lids_leave_to_cad(style, tmp_path):
    """Read again by Open Cascade as one valid solid each, or not written."""
    pytest.importorskip("OCP")
    parts = built(style).assembly
    assert parts.write(tmp_path / "teapot.step", tolerance=1e-3).exists()


@pytest.mark.slow
def test_parameters_rebuild():
    tall = built("better", spout_tilt="1/10", lid_height="3/2")
    assert tall.solid.proved
    assert tall.solid.contains([[0, 0, 1.49]])[0]
    assert not built("better").solid.contains([[0, 0, 1.49]])[0]


def test_parameters_name_the_joint():
    for changed in ({"lid_height": 1}, {"spout_tilt": 1}, {"spout": PaperSpout(), "handle_size": 2}):
        with pytest.raises(pas.GeometryError, match=r"joint.* cannot be made with"):
            teapot("better", **changed)


def test_many_points_are_classified():
    shape = built("paper").solid
    points = np.random.default_rng(0).uniform(shape.box[0], shape.box[1], size=(200_000, 3))
    share = shape.contains(points).mean() * np.prod(np.ptp(shape.box, axis=0))
    assert share == pytest.approx(VOLUMES["paper"], rel=0.02)


@pytest.mark.slow
def test_the_example_runs(tmp_path):
    script = ROOT / "examples" / "teapot" / "teapot.py"
    done = subprocess.run(
        [sys.executable, script, "--style", "paper", "-o", tmp_path], capture_output=True, text=True, check=True
    )
    assert "joints: 8 of 8 proved" in done.stdout
    assert (tmp_path / "teapot.stl").stat().st_size > 10_000


@pytest.mark.slow
def test_the_design_of_ones_own(tmp_path, capsys):
    pot = runpy.run_path(str(ROOT / "examples/teapot/own_design.py"))["main"](tmp_path / "own.stl")
    out = capsys.readouterr().out
    assert "joints: 16 of 16 proved" in out
    assert "volume 11.138" in out
    assert "refused: the joint of handle and upper body cannot be made" in out
    assert (tmp_path / "own.stl").stat().st_size > 10_000
    assert pot.solid.polynomials["spout tip"] != built("better").solid.polynomials["spout tip"]
    assert pot.solid.polynomials["body lower"] == built("better").solid.polynomials["body lower"]


@pytest.mark.slow
def test_parts_of_both_styles_go_together():
    """The published spout on the other pot: its joint with the body is GC^0, and it has no channel."""
    pot = teapot(spout=PaperSpout())
    assert pot.solid.proved
    order = {(j.first, j.second): j.order for j in pot.solid.joints}
    assert order["body lower", "spout lower"] == 0
    assert order["body upper", "handle upper fillet"] == 1
    assert "lid ring" not in pot.lid.faces
    mesh = pot.solid.mesh(2e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    assert not [face for face in pot.pot.faces if face.startswith("channel")]
    assert "lid ring" in Lid().seated(Body()).faces


def test_a_handle_of_ones_own_needs_two_methods():
    class NoHandle:
        def walls(self):
            return (), ()

        def attached(self, solid, body):
            return solid

    pot = teapot(spout=PaperSpout(), handle=NoHandle())
    assert pot.solid.proved
    assert not [face for face in pot.solid.faces if "handle" in face]
    with pytest.raises(TypeError, match="handle_size changes designs with a field size, which"):
        teapot(handle=NoHandle(), handle_size=1)


IMPOSSIBLE = {
    "seam": (lambda: Body(seam=1), "the joint of lower and upper body .* between the bottom at -4/5 and the top at 1"),
    "axis": (lambda: Body(lower="x^2 + y^2 + z^2 - 1/10"), "the joint of lower and upper .* lower quadric .* -4/5"),
    "rim": (lambda: Body(rim=-1), "the joint of lid and body .* not -1"),
    "dome": (lambda: Lid(dome_end="1/5"), "the joint of dome and blend"),
    "knob": (lambda: Lid(knob_start="1/20"), "the joint of knob and blend .* above dome_end 9/100"),
    "low knob": (lambda: teapot(lid_height=1), "the joint of knob and blend .* lid_height 1: the knob starts at 6/5"),
    "thick": (lambda: Handle(thickness="3/5"), "the joint of handle loop and handle tubes .* below half"),
    "thin": (lambda: Handle(thickness=0), "the joints of the handle .* thickness must be positive, not 0"),
    "high": (
        lambda: teapot("paper", handle=Handle(middle="3/10")), "the joint of handle and upper body .* and the lid at 1"
    ),
    "paper": (lambda: PaperHandle(size=2), "the joints of handle and body .* handle_size 2"),
    "tilt": (lambda: Spout(tilt="1/4"), "the joints of the spout .* spout_tilt 1/4"),
    "paper tilt": (lambda: PaperSpout(tilt="1/4"), "the joint of the two spout patches .* spout_tilt 1/4"),
    "inside": (lambda: PaperSpout(inside=(2, 0, 0)), "the two spout patches .* inside must be a point of"),
    "bend": (lambda: Spout(bend="1/2"), "the bends of the spout .* between 0 and 1/2, not 1/2"),
    "wall": (lambda: Spout(wall="1/5"), "the channel of the spout .* below the least radius 11/100, not 1/5"),
    "fillet": (lambda: Spout(body_side=0), "the fillet of spout and body .* must be positive"),
    "outside": (
        lambda: teapot(spout=Spout(axis=points((2, 0, 0.3), (2.4, 0.5, 0.2), (2.8, 1.2, 0.1)))),
        r"the joint of spout and body .* lead out of the lower body, not from \(2, 0, 0\) to \(2.4, 0, 0.5\)",
    ),
    "back": (
        lambda: Spout(axis=points((1, 0, 0.2), (2, 0, 0.2), (1, 0.01, 0.2))).attached(Body().solid((), ()), Body()),
        "bend 1 of the spout cannot be made: ",
    ),
    "root": (lambda: teapot(spout=PaperSpout(root="x - 5")), "joint.* spout"),
}  # fmt: skip
"""Designs that cannot be made, and what is said of the joint."""


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_what_cannot_be_made_names_the_joint(name):
    make, sentence = IMPOSSIBLE[name]
    with pytest.raises(pas.GeometryError, match=sentence):
        make()


MISUSE = {
    "no number": (lambda: Spout(tilt="much"), ValueError, "tilt is not a rational number: 'much'"),
    "no points": (lambda: Spout(axis="1 2"), TypeError, "axis must be a sequence of points"),
    "points in space": (
        lambda: PaperSpout(lower_outline=[(1, 2, 3)]),
        ValueError,
        r"lower_outline must be points \(x, z\)",
    ),
    "flat points": (lambda: Spout(axis=[(1, 2), (1, 3), (2, 3)]), ValueError, r"axis must be points \(x, z, radius\)"),
    "mixed points": (lambda: Spout(axis=[(1, 2, 3), (1, 2)]), ValueError, r"axis\[1\] has 2 coordinates"),
    "a wrong part": (lambda: teapot(spout=Handle()), TypeError, r"spout must be a design such as .*Spout\(\)"),
    "a class": (lambda: teapot(handle=Handle), TypeError, r"handle must be a design such as .*Handle\(\)"),
    "a style": (lambda: teapot("ugly"), ValueError, "style must be one of 'paper', 'better', not 'ugly'"),
    "a wall": (lambda: PaperSpout(lower_walls=["x +"]), ValueError, r"lower_walls\[0\]"),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_names_the_argument(name):
    make, error, sentence = MISUSE[name]
    with pytest.raises(error, match=sentence):
        make()


def test_styles_are_two():
    assert list(STYLES) == ["paper", "better"]
    assert pas.teapot is teapot
