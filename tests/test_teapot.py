"""The teapot: printed polynomials and their joints, and both teapots as the program builds them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from conftest import ROOT

import pas
from pas import solid
from pas.teapot import body, lid, spout
from pas.teapot.pot import teapot

FACTS = json.loads((ROOT / "tests" / "data" / "teapot.json").read_text())
VOLUMES = {"paper": 11.25, "better": 11.14}


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
def test_printed_patches_make_one_closed_solid_with_all_joints(style):
    shape = from_facts(style)
    assert shape.proved
    assert all(f"exactly GC^{j.order}" in v.reason for j, v in zip(shape.joints, shape.verdicts, strict=True))
    mesh = shape.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    assert shape.volume(1e-2) == pytest.approx(VOLUMES[style], abs=6e-3)


def test_lid_and_body_come_out_as_printed():
    names, _ = definitions("paper")
    assert lid.knob(Fraction(7, 5)) == names["lid3"]
    assert lid.blend().primitive() == names["lid2"].primitive()
    assert names["lid1"] == lid.DOME
    assert body.upper() == names["q1"]
    assert names["q2"] == body.LOWER


def test_spouts_are_members_of_their_ideals():
    names, _ = definitions("paper")
    lower, upper = spout.paper(Fraction(0))
    both = pas.contact_ideal((names["q2"], names["h1"]), 0) & pas.contact_ideal((names["kz"], names["h2"]), 0)
    assert lower in both
    assert names["spl"] in both
    assert names["Gd"] == names["Gd"]
    for generator in ("G0", "Gd", "Ge"):
        assert names[generator] in both
    assert upper in pas.contact_ideal((lower, names["h2"]), 1)
    lower, upper = spout.better(Fraction(0))
    assert lower in pas.contact_ideal((names["q2"], names["h1"]), 1)


@pytest.mark.parametrize("style", ["paper", "better"])
def test_teapots_are_closed_joined_and_of_the_known_volume(style):
    pot = teapot(style)
    shape = pot.solid
    assert shape.proved
    wanted = sorted(order for *_, order in FACTS[style]["joints"])
    assert sorted(j.order for j in shape.joints) == wanted
    assert all(f"exactly GC^{j.order}" in v.reason for j, v in zip(shape.joints, shape.verdicts, strict=True))
    mesh = shape.mesh(5e-3)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, 0)
    assert not any("= 0" in name for name in mesh.names)  # nothing is left open between patches
    assert shape.volume(5e-3) == pytest.approx(VOLUMES[style], rel=1e-2)
    cover = pot.lid.mesh(5e-3)
    assert (cover.is_closed, cover.components, cover.euler_characteristic) == (True, 1, 2)


@pytest.mark.slow
def test_the_hollow_pot_pours():
    hollow = teapot("better").pot
    mesh = hollow.mesh(1e-2)
    assert (mesh.is_closed, mesh.components, mesh.euler_characteristic) == (True, 1, -2)
    assert not hollow.contains([[0, 0, 0], [1.78, 0, 0.08], [2.2, 0, 0.7]]).any()
    assert hollow.contains([[1.45, 0, 0], [0, 0, -0.75], [-2.3, 0, 0.1]]).all()


def test_parameters_rebuild_or_name_the_joint():
    tall = teapot("better", lid_height="3/2")
    assert tall.solid.proved
    assert tall.solid.contains([[0, 0, 1.49]])[0]
    assert not teapot("better").solid.contains([[0, 0, 1.49]])[0]
    assert teapot("better", handle_size="11/10").solid.proved
    assert teapot("better", spout_tilt="1/10").solid.proved
    for changed in ({"lid_height": 1}, {"spout_tilt": 1}, {"handle_size": 2}):
        with pytest.raises(pas.GeometryError, match=r"joint.* cannot be made with"):
            teapot("better", **changed)
    with pytest.raises(ValueError, match="style must be one of"):
        teapot("ugly")


def test_many_points_are_classified():
    shape = teapot("better").solid
    points = np.random.default_rng(0).uniform(shape.box[0], shape.box[1], size=(200_000, 3))
    share = shape.contains(points).mean() * np.prod(np.ptp(shape.box, axis=0))
    assert share == pytest.approx(VOLUMES["better"], rel=0.02)


@pytest.mark.slow
def test_the_example_runs(tmp_path):
    script = ROOT / "examples" / "teapot" / "teapot.py"
    done = subprocess.run(
        [sys.executable, script, "--style", "paper", "-o", tmp_path], capture_output=True, text=True, check=True
    )
    assert "joints: 8 of 8 proved" in done.stdout
    assert (tmp_path / "teapot.stl").stat().st_size > 10_000
