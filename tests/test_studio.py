"""The studio without a browser: documents and their texts, what a session does, and who may talk to the server."""

from __future__ import annotations

import asyncio
import http.client
import importlib.util
import json
import os
import re
import signal
import struct
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import pas
from pas import network
from pas.cli import WRONG, main
from pas.errors import InputError
from pas.exchange.formats import FORMATS, suffixes_for
from pas.studio import GALLERY, TEAPOT, Message, documents
from pas.studio.controls import controls
from pas.studio.conversation import INSIDE, REST, Conversation, RefusedError, StoppedError, request_of
from pas.studio.documents import DOCUMENTS, checked, plain_tables, problem_of, program, toml
from pas.studio.scene import coefficients, picture
from pas.studio.server import PAGE, Studio, listening
from pas.studio.session import StudioSession

CORNER = {
    "kind": "problem",
    "problem": {
        "name": "corner",
        "order": 1,
        "degree": 4,
        "pipes": [
            {"axis": [1, 0, 0], "radius": "1/3", "clip": 1},
            {"axis": [0, 1, 0], "radius": "1/4", "clip": 1},
            {"axis": [0, 0, 1], "radius": "2/5", "clip": 1},
        ],
    },
}
SHAPED = {"tension": "6.5", "points": {"near": [["0.3", "0.31", "1/3"]], "near_weight": "40"}}


def changed(**problem):
    return {**CORNER, "problem": {**CORNER["problem"], **problem}}


@pytest.fixture(scope="module")
def session():
    """A session that has solved the corner."""
    made = StudioSession()
    message = made.solve(CORNER)
    made.take(*made.kept(CORNER))
    return made, message


def run(text):
    space = {}
    exec(compile(text, "copied", "exec"), space)
    return space["shape"]


def test_copied_texts_make_exactly_what_is_seen(tmp_path, capsys):
    document = changed(**SHAPED)
    session = StudioSession()
    session.solve(CORNER)  # from the space of which the next one is chosen
    message = session.solve(document)
    (tmp_path / "copied.toml").write_text(message.head["toml"])
    for again in (run(message.head["python"]), pas.read_problem(tmp_path / "copied.toml").solve()):
        assert (coefficients(again.surface) == message.arrays["coefficients"]).all()
    assert message.head["proved"] and session.measure(document).head["facts"]["fairness"]["sharpness"] < 2
    assert 'pas.Pipe(axis=(1, 0, 0), radius="1/3", clip=1)' in message.head["python"]


HEMISPHERES = GALLERY["Two hemispheres"]["problem"]
SINGLE = {"kind": "problem", "problem": {name: value for name, value in HEMISPHERES.items() if name != "points"}}
"""Those of the gallery, of which nothing is wished yet."""


def with_points(document, **points):
    held = {**document["problem"].get("points", {}), **points}
    return {**document, "problem": {**document["problem"], "points": held}}


def pulled(document, by):
    """A document whose last handle has another value."""
    *before, (handle, value) = document["problem"]["points"]["handles"]
    return with_points(document, handles=[*before, [handle, str(float(value) + by)]])


def again(message, folder, monkeypatch):
    """The shapes that the texts of a message make."""
    monkeypatch.chdir(folder)
    (folder / "copied.toml").write_text(message.head["toml"])
    return run(message.head["python"]), pas.read_problem(folder / "copied.toml").solve()


def test_a_handle_pulls_the_surface_where_it_is_and_is_copied(tmp_path, monkeypatch, capsys):
    made = StudioSession()
    first = made.solve(SINGLE)
    assert [c["kind"] for c in first.head["controls"]][-2:] == ["coefficients", "handles"]
    surface = made.shape_of(SINGLE).surface
    start, way = np.array([[-0.5, 0, 0]]), np.array([[0, 1, 0]])  # from the centre
    distance = surface.intersect_rays(start[0], way)[0]
    document = made.handle(SINGLE, [-0.5, distance, 0])
    (((cell, index), _),) = document["problem"]["points"]["handles"]
    held = made.solve(document)
    assert document["problem"]["degree"] == 4 == sum(index) and held.head["proved"]
    assert np.abs(held.arrays["coefficients"] - first.arrays["coefficients"]).max() < 2e-3  # settled again
    made.take(*made.kept(document))
    surface, (share,) = made.shape_of(document).surface, held.head["shares"]
    partition = surface.partition
    domain = (
        np.array(index)
        / 4
        @ np.array([[float(c.p) / float(c.q) for c in partition.vertices[v]] for v in partition.cells[cell]])
    )
    ray = domain - start[0]

    def place(shape):
        return shape.intersect_rays(start[0], ray[None])[0] * ray + start[0]

    gradient = surface.gradient(place(surface)[None])[0]
    pull = 0.004  # along the normal
    document = pulled(document, -pull * np.linalg.norm(gradient) / share)
    made.move(document, made.scene)
    message = made.solve(document)
    assert message.head["proved"] and "handles = [[[" in message.head["toml"]
    for shape in (made.seen, made.shape_of(document)):
        exact = documents.Fraction(document["problem"]["points"]["handles"][0][1])
        assert shape.surface.cells[cell].b_coefficients[tuple(index)] == exact
    went = (place(made.shape_of(document).surface) - place(surface)) @ gradient / np.linalg.norm(gradient)
    assert went == pytest.approx(pull, rel=0.15)
    for shape in again(message, tmp_path, monkeypatch):
        assert (coefficients(shape.surface) == message.arrays["coefficients"]).all()


def test_blends_of_many_cells_are_pulled_by_points_to_pass_through(session):
    made, first = session
    (control,) = (c for c in first.head["controls"] if c["kind"] == "handles")
    assert control["through"] and first.head["shares"] == []
    with pytest.raises(InputError, match="for others add a point to pass through"):
        made.handle(CORNER, [0, 0, 0])


def test_handles_of_projects_are_copied(tmp_path, monkeypatch, capsys):
    made = StudioSession()
    made.shape_of(SINGLE).save(tmp_path / "held.pas.json")
    opened = made.read("held.pas.json", (tmp_path / "held.pas.json").read_text())
    document = pulled_slider(made.handle(opened, [0, 1, 0]), {"coefficients": {"1": "-0.0035"}})
    message = made.solve(document)
    assert "handles={(" in message.head["python"] and 'coefficients={1: "-0.0035"}' in message.head["python"]
    monkeypatch.chdir(tmp_path)
    assert (coefficients(run(message.head["python"]).surface) == message.arrays["coefficients"]).all()


def pulled_slider(document, more):
    return {**document, "sliders": {"points": {**document["sliders"]["points"], **more}}}


@pytest.mark.slow
def test_where_no_handle_is_to_be_had_is_said():
    made = StudioSession()
    with pytest.raises(InputError, match="only blends of a single cell with a box have handles"):
        made.handle(GALLERY["Two quadrics"], [0, 0, 0])
    document = with_points(SINGLE, coefficients={"0": "0.0389", "1": "-0.0035"})  # of three dimensions one is the scale
    document["problem"]["degree"] = 4
    for wrong in (None, [1, 2], ["1", "2", "3"]):
        with pytest.raises(InputError, match="a place must be three numbers"):
            made.handle(document, wrong)
    with pytest.raises(InputError, match="no handle is free"):
        made.handle(document, [0, 1, 0])


@pytest.mark.slow
def test_coefficients_of_a_single_cell_are_set_and_copied(tmp_path, monkeypatch, capsys):
    made = StudioSession()
    first = made.solve(SINGLE)
    (control,) = (c for c in first.head["controls"] if c["kind"] == "coefficients")
    assert len(control["names"]) == len(control["ends"]) == len(first.head["members"]) == 3
    assert all(low < value < high for (low, high), value in zip(control["ends"], first.head["members"], strict=True))
    at = {**SINGLE, "problem": {**SINGLE["problem"], "degree": 4}}
    made.take(*made.kept(SINGLE))
    for value in ("-0.008", "-0.009"):
        document = with_points(at, coefficients={"1": value})
        moved = made.move(document, made.scene, anew=True)
        assert made.seen.coefficients[1] == documents.Fraction(value)
    message = made.solve(document)
    assert message.head["proved"] and message.head["members"][1] == -0.009
    assert np.abs(moved.arrays["coefficients"] - message.arrays["coefficients"]).max() < 0.05
    for shape in again(message, tmp_path, monkeypatch):
        assert (coefficients(shape.surface) == message.arrays["coefficients"]).all()
    low, high = control["ends"][1]
    for beyond in (1.02 * low, 0.98 * high):  # both are negative
        with pytest.raises(pas.InfeasibleError, match="coefficient 1 = "):
            made.solve(with_points(at, coefficients={"1": repr(beyond)}))
    free = with_points(at, coefficients={})
    assert (
        "coefficients"
        not in StudioSession().solve(free).head["python"].replace("sum-of-coefficients", "").split("[points]")[0]
    )


def test_another_degree_lets_handles_and_coefficients_go():
    choices = {c["path"][-1]: c["frees"] for c in controls(CORNER) if c["kind"] == "choice"}
    assert set(choices) == {"order", "degree"}
    assert all({path[-1] for path in paths} == {"handles", "coefficients"} for paths in choices.values())


def test_what_no_call_says_is_copied_with_its_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    problem = GALLERY["Two quadrics"]["problem"]
    shape = run(program(problem))
    assert np.allclose(shape.mesh().points, problem_of(problem).solve().mesh().points, rtol=0, atol=0)


@pytest.mark.parametrize("name", GALLERY)
def test_starting_points_are_documents_with_controls(name):
    document = checked(json.loads(json.dumps(GALLERY[name])))
    text = DOCUMENTS[document["kind"]].toml(document)
    if text is not None:
        assert problem_of(document["problem"]).name == document["problem"]["name"]
        assert toml(document["problem"]) == text
    found = controls(document)
    assert found
    for control in found:
        assert control["kind"] in ("number", "vector", "choice", "points", "text")
        assert control["kind"] != "number" or control["low"] < control["high"]


@pytest.mark.parametrize("name", GALLERY)
def test_a_control_stays_one_where_its_number_becomes_a_text(name):
    """As a slider's is: it tells the digits that it shows."""
    document = GALLERY[name]
    found = [control["path"] for control in controls(document)]
    if document["kind"] == "problem":
        text = json.loads(json.dumps(document["problem"]), parse_int=lambda digits: f"{digits}.0")
        text["order"] = document["problem"].get("order", 1)
        assert [control["path"] for control in controls({**document, "problem": text})] == found
    assert len(set(map(str, found))) == len(found)


@pytest.mark.slow
@pytest.mark.parametrize("name", GALLERY)
def test_starting_points_are_solved_and_seen(name):
    message = StudioSession().solve(GALLERY[name])
    assert not [v for v in message.head["verdicts"] if v["status"] in ("refuted", "fails, measured")]
    assert len(message.packed()) < 4e6


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted((ROOT / "examples").rglob("*.toml")), ids=lambda p: p.stem)
def test_examples_come_back_from_their_documents(path):
    document = StudioSession().read(path.name, path.read_text())
    problem, again = pas.read_problem(path), problem_of(document["problem"])
    for name, value in vars(problem).items():
        if name not in ("name", "boundaries", "shape", "data"):
            # readers have places in memory
            told = [re.sub(" at 0x[0-9a-f]+", "", repr(v)) for v in (getattr(again, name), value)]
            assert told[0] == told[1]


def test_decimals_keep_their_digits():
    found = plain_tables({"a": [documents.Fraction("0.1"), documents.Fraction("-2.7589241763811208")]})
    assert found == {"a": [0.1, -2.7589241763811208]}
    assert (
        plain_tables(documents.Fraction("0.1000000000000000000001")) == "1000000000000000000001/10000000000000000000000"
    )


def test_a_packed_message_is_what_the_page_reads():
    data = Message({"kind": "x"}, {"a": np.arange(3.0), "b": np.arange(5, dtype=np.uint8)}).packed()
    (length,) = struct.unpack("<I", data[:4])
    assert (4 + length) % 8 == 0
    head = json.loads(data[4 : 4 + length])
    assert head["arrays"] == [["a", "float64", 3], ["b", "uint8", 5]]
    assert np.frombuffer(data, "<f8", 3, 4 + length).tolist() == [0, 1, 2]
    assert list(data[4 + length + 24 :][:5]) == [0, 1, 2, 3, 4]


def test_meshes_that_stand_in_for_rays_end_at_curved_clips_as_well():
    contact = {"surface": "y^2 + z^2 - 1/4", "clip": "x^2 + y^2 + z^2 - 1"}
    document = {"kind": "problem", "problem": {
        "order": 1, "degree": 2, "prove": False, "guard": False, "contacts": [contact],
        "partition": {"kind": "single cell", "lower": [-2, -2, -2], "upper": [2, 2, 2]},
        "normalize": {"kind": "value-at", "point": [0, 0, 0], "value": -1},
    }}  # fmt: skip
    made = StudioSession()
    assert made.solve(document).head["clips"] == [2] and made.measure(document).head["facts"]["fairness"] is None
    mesh = made.mesh(document).arrays
    surface = made.shape_of(document).surface
    scale = float(surface.partition.frame.scale.p) / float(surface.partition.frame.scale.q)
    far = np.linalg.norm(scale * mesh["points 0"].astype(float), axis=1)[mesh["triangles 0"]]
    assert len(far) > 50 and far.min(axis=1).max() < 1 < far.max()


def inside(local, cell, point):
    """The least barycentric coordinate of a point in a cell."""
    corners = np.vstack([local.points[list(cell)].T, np.ones(4)])
    return np.linalg.solve(corners, [*point, 1]).min()


def test_a_moved_slider_sends_coefficients_alone(session):
    made, first = session
    one = made.move(changed(tension="5"), "")
    two = made.move(changed(tension="5.5"), one.head["scene"])
    assert (one.head["kind"], two.head["kind"]) == ("picture", "moved")
    assert two.head["scene"] == one.head["scene"] == first.head["scene"]
    assert len(two.packed()) < 3000
    assert 0 < np.abs(two.arrays["coefficients"] - one.arrays["coefficients"]).max() < 0.2
    mesh = made.move(changed(tension="5.6"), one.head["scene"], mesh=True).arrays
    local = made.seen.surface.local
    values = [
        patch.at(p.tolist())
        for p in mesh["points 0"][:40].astype(float)
        for patch in [
            made.seen.surface.patches[local.piece_of[int(np.argmax([inside(local, c, p) for c in local.cells]))]]
        ]
    ]
    assert np.abs(np.array(values, float)).max() < 1e-6 and len(mesh["triangles 0"]) > 300
    verdicts = made.prove()
    assert verdicts.head["proved"] and len(verdicts.head["verdicts"]) == len(first.head["verdicts"])


def test_verdicts_of_a_moved_shape_are_those_of_the_independent_checker(session, tmp_path):
    from pas.independent.checker import check_independently

    made, _ = session
    for near in (["1/4", "1/4", "1/4"], ["0.5", "0.5", "0.45"]):
        made.move(changed(points={"near": [near], "near_weight": "1000"}), "")
        head = made.prove().head
        made.seen.save(tmp_path / "moved.pas.json")
        assert not head["proved"] or all(f.proved for f in check_independently(tmp_path / "moved.pas.json"))


@pytest.mark.slow
def test_no_random_move_is_called_proved_that_the_independent_checker_does_not_prove(session, tmp_path):
    from pas.independent.checker import check_independently

    made, _ = session
    random, counts = np.random.default_rng(17), {True: 0, False: 0}
    for _ in range(800):
        near = [repr(round(c, 3)) for c in random.uniform(-0.9, 0.9, 3).tolist()]
        tension, weight = random.uniform(0, 30), 10 ** random.uniform(1, 5)
        shape = {"points": {"near": [near], "near_weight": repr(weight)}, "tension": repr(tension)}
        try:
            made.move(changed(**shape), "")
        except (pas.PasError, ValueError):  # a point outside, or a step that is lost from sight
            made.take(*StudioSession().kept(CORNER))
            continue
        proved = made.prove().head["proved"]
        counts[proved] += 1
        made.seen.save(tmp_path / "moved.pas.json")
        assert not proved or all(f.proved for f in check_independently(tmp_path / "moved.pas.json"))
    assert counts[True] > 80 and counts[False] > 25


@pytest.mark.slow
def test_a_document_far_from_the_last_one_is_followed():
    """On a busy machine the first move may come before the shape that it begins from."""
    quartic = {name: value for name, value in GALLERY["Elbow of one quartic"]["problem"].items() if name != "degree"}

    def wished(**points):
        return {"kind": "problem", "problem": {**quartic, "degree": 4, "points": points}}

    final, quick, before = StudioSession(), StudioSession(), wished(coefficients={"1": "-0.005"})
    final.solve(before)
    quick.take(*final.kept(before))
    for value in ("0.3493722", "0.1919826"):
        quick.move(wished(handles=[[[1, [3, 0, 1, 0]], value]]))
        assert quick.seen.surface.cells[1].b_coefficients[3, 0, 1, 0] == Fraction(value)
    assert quick.prove().head["proved"]


def test_changed_contacts_are_outlined_at_once(session):
    made, _ = session
    pipes = [{**CORNER["problem"]["pipes"][0], "radius": "0.3"}, *CORNER["problem"]["pipes"][1:]]
    outline = made.move(changed(pipes=pipes))
    assert outline.head["kind"] == "outline" and len(outline.head["beyond"]) == 3
    assert made.move(changed(pipes=pipes), anew=True).head["kind"] == "picture"
    assert made.move(changed(tension="9")).head["kind"] == "picture"


WRONG_DOCUMENTS = [
    ({}, "there is no kind of document None"),
    ({"kind": "problem"}, "a problem must be a table"),
    (changed(order=0), "order must be"),
    (changed(order="2"), "order must be"),
    (changed(pipes=[{"axis": [1, 0, 0], "radius": "1/0", "clip": 1}]), "pipe 1: radius divides by zero"),
    (changed(pipes=[{"axis": [0, 0, 0], "radius": 1, "clip": 1}]), "pipe 1: axis must not be the zero vector"),
    (changed(points={"near": [["1", "2"]]}), "near"),
    (changed(tension="-1"), "tension"),
    (changed(points={"handles": [[[0, [1, 1, 1, 0]], "1"]]}), "must be four numbers >= 0 with the sum 4"),
    (changed(points={"handles": [1]}), "handles must map (cell, multi-index of four numbers) to values"),
    (changed(points={"coefficients": {"one": "1"}}), "coefficients must map numbers of members"),
    (changed(points={"coefficients": {"99": "1"}}), "coefficients[99] is that of no member"),
    (changed(tension=None), "Invalid value"),
    (changed(colour="red"), "unknown key 'colour'"),
    ({"kind": "teapot", "values": {"spout": 1}}, "a teapot has the values"),
    ({"kind": "project", "name": "../../etc/passwd"}, "is not open here"),
]


@pytest.mark.parametrize(("document", "sentence"), WRONG_DOCUMENTS, ids=lambda x: x if isinstance(x, str) else "")
def test_what_is_wrong_with_a_document_is_one_sentence(document, sentence):
    with pytest.raises((pas.PasError, ValueError, TypeError), match=re.escape(sentence)) as caught:
        StudioSession().solve(document)
    assert "\n" not in str(caught.value) and "problem.toml" not in str(caught.value)


def test_files_are_read_by_their_text_alone(session, tmp_path):
    made, _ = session
    problem = ROOT / "examples/corners/three_pipes.toml"
    document = made.read("../../three pipes.toml", problem.read_text())
    assert document["problem"]["pipes"][0] == {"axis": [1, 0, 0], "radius": "1/3", "clip": 1}
    made.seen.save(tmp_path / "kept.pas.json")
    opened = made.read("kept.pas.json", (tmp_path / "kept.pas.json").read_text())
    assert opened == {"kind": "project", "name": "kept.pas.json", "sliders": {}, "blend": True}
    message = made.solve(opened)
    assert 'pas.load("kept.pas.json")' in message.head["python"]
    moved = made.solve({**opened, "sliders": {"tension": "8"}})
    assert 'refit(steps=None, tension="8")' in moved.head["python"] and moved.head["proved"]
    with pytest.raises(pas.ProjectFileError, match="its content does not match its checksum"):
        made.read("kept.pas.json", (tmp_path / "kept.pas.json").read_text().replace('"degree"', '"grade"', 1))


def test_the_largest_safe_lengths_are_told():
    document = GALLERY["Two quadrics"]
    limits = StudioSession().safe(document).head["limits"]
    assert 3 < limits["l1"] < 6 and set(limits) <= {"l1", "l2"}
    assert [c["path"][-1] for c in controls(document) if c.get("safe")] == ["l1", "l2"]
    made = StudioSession()
    moved = made.move({**document, "problem": {**document["problem"], "shape": {"l1": "3", "l2": "1"}}})
    assert moved.head["kind"] == "moved" and moved.arrays["points 0"].shape[1] == 3
    again = {**document, "problem": {**document["problem"], "shape": {"l1": "5/2", "l2": "1"}}}
    followed, anew = made.move(again), StudioSession().move(again)  # by its shape alone, and from the beginning
    assert np.abs(followed.arrays["points 0"] - anew.arrays["points 0"]).max() < 1e-9
    assert np.abs(followed.arrays["points 0"] - moved.arrays["points 0"]).max() > 0.01


def test_exports_are_files_of_the_shape(session):
    made, _ = session
    head = made.export(CORNER, ".stl")
    assert head.head["name"] == "corner.stl" and head.head["proved"]
    assert head.arrays["content"].size == 84 + 50 * struct.unpack("<I", head.arrays["content"][80:84].tobytes())[0]
    with pytest.raises(InputError, match=r"there is no format '.exe'"):
        made.export(CORNER, ".exe")


HAS_3MF = importlib.util.find_spec("lib3mf") is not None


LONG_TO_MESH = ("Helicoid to pipe", "Round an obstacle")
"""Of the gallery, beside one of the same kind that takes less."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in LONG_TO_MESH else []) for name in GALLERY]
)
@pytest.mark.sampled(20)
def test_formats_that_are_offered_are_written_and_no_others(name):
    made = StudioSession()
    offered = made.solve(GALLERY[name]).head["formats"]
    assert set(offered) >= {".pas.json", ".stl", ".obj", ".ply", ".glb", ".vtp"} and len(set(offered)) == len(offered)
    assert (".3mf" in offered) == (name == "Teapot" and HAS_3MF) and (".vtu" in offered) == (
        made.solved[1].kind == "blend"
    )
    for suffix in (".pas.json", *dict.fromkeys(FORMATS[suffix].name for suffix in FORMATS)):
        if suffix in offered:
            assert made.export(GALLERY[name], suffix).arrays["content"].size > 500
            continue
        with pytest.raises(InputError, match="this shape cannot be written as"):
            made.export(GALLERY[name], suffix)
        if suffix in (".3mf", ".step"):  # a body could be filled with tetrahedra, given minutes
            with pytest.raises((pas.PasError, ValueError, TypeError)):
                made.solved[1].write(f"x{suffix}")


MESHLESS = {
    "kind": "problem",
    "problem": {
        "name": "meshless", "order": 1, "degree": 4, "prove": False, "guard": False,
        "contacts": [{"surface": "y^2 + z^2 - 1", "clip": "x - 2"}, {"surface": "x^2 + z^2 - 1", "clip": "y - 2"}],
        "partition": {"kind": "single cell", "lower": [-2, -2, -2], "upper": [2, 2, 2]},
        "points": {"outside": [["0", "0", "0"], ["1", "1", "0"], ["1", "0", "0"], ["0", "1", "0"]]},
    },
}  # fmt: skip
"""An elbow that is kept away from where it would be: it crosses a wall of its cell, and no mesh of it is found."""


def test_what_has_no_mesh_is_drawn_by_rays_and_its_export_says_why():
    made = StudioSession()
    assert made.solve(MESHLESS).head["how"] == "cast"
    for suffix in (".stl", ".glb"):
        with pytest.raises(pas.MeshError, match="no good mesh was found"):
            made.export(MESHLESS, suffix)
    assert made.export(MESHLESS, ".pas.json").arrays["content"].size > 500
    scene = made.move(MESHLESS, anew=True).head["scene"]
    moved = made.move(MESHLESS, scene, mesh=True)
    assert moved.head["kind"] == "moved" and set(moved.arrays) == {"coefficients"}


def with_thin_plate(document):
    """Chosen at once, and as unfair as that may be."""
    return {**document, "problem": {**document["problem"], "energy": {"kind": "thin-plate"}}}


def with_radius(document, radius):
    first, *others = document["problem"]["pipes"]
    return {**document, "problem": {**document["problem"], "pipes": [{**first, "radius": radius}, *others]}}


@pytest.mark.parametrize(
    ("document", "unfair"),
    [
        (CORNER, r""),
        (changed(degree=3, pipes=[{**p, "radius": "1/3"} for p in CORNER["problem"]["pipes"]]),
         r"sharpness 1\.0\d above 1\.02; bulge 0\.\d+ above 0\.05"),
        (with_thin_plate(with_radius(GALLERY["T joint"], "1.4")),
         r"waist .*; 2\d\.\d times as sharp as its sharpest neighbour, .* no room .*"),
    ],
)  # fmt: skip
def test_what_is_not_fair_is_named_though_all_is_proved(document, unfair):
    made = StudioSession()
    assert made.solve(document).head["proved"]
    assert re.fullmatch(unfair, "; ".join(made.measure(document).head["unfair"]))


def test_patches_and_closed_bodies_are_offered_as_such():
    patch, ball = pas.fit_patch(pas.torus(2, 1, angle=True), 0.1), pas.solid.ball((0, 0, 0), 1)
    if importlib.util.find_spec("OCP"):
        assert ".step" in suffixes_for(patch)
    assert all(map(FORMATS[".step"].content.can_be_of, (patch, ball)))
    assert (".3mf" in suffixes_for(ball)) == HAS_3MF
    assert ".3mf" not in suffixes_for([ball, StudioSession().shape_of(SINGLE)])


REFUTED = changed(
    prove=False, guard=False, energy={"kind": "thin-plate"},
    points={"near": [["0.8", "0.8", "0.8"]], "near_weight": "100000"},
)  # fmt: skip


def test_a_refuted_state_says_where_and_is_repaired():
    made = StudioSession()
    message = made.solve(REFUTED)
    failed = [v for v in message.head["verdicts"] if v["status"] == "refuted"]
    assert failed and not message.head["proved"] and all(len(v["witness"]) == 3 for v in failed if v["witness"])
    assert any(v["witness"] for v in failed)
    better = made.repair(REFUTED)
    assert better["problem"]["points"]["near"] == REFUTED["problem"]["points"]["near"]
    assert made.solve(better).head["proved"]
    with pytest.raises(InputError, match="only blends can be repaired"):
        made.repair({"kind": "teapot", "values": {}})


LONG = json.dumps({"do": "move", "document": {"x": "y" * 300000}})
BAD_REQUESTS = ["", "[]", "{}", '{"do": "rm"}', '{"do": "move"}', '{"do": "rest", "document": [1]}', "[" * 5000,
                '{"do": "rest", "document": {}, "seq": "1"}', LONG]  # fmt: skip


@pytest.mark.parametrize("text", BAD_REQUESTS, ids=range(len(BAD_REQUESTS)))
def test_requests_that_are_none_are_refused_in_a_sentence(text):
    with pytest.raises(ValueError, match=r"^(a request|the request|seq)"):
        request_of(text)


class Slow:
    """A worker whose answers are given when the test says so."""

    def __init__(self):
        self.asked, self.gates, self.doing = [], [], ()

    async def ask(self, verb, *arguments):
        gate = asyncio.get_running_loop().create_future()
        self.doing = (verb, *arguments)
        self.asked.append(self.doing)
        self.gates.append(gate)
        try:
            return await gate
        finally:
            self.doing = ()

    def stop(self):
        if self.gates and not self.gates[-1].done():
            self.gates[-1].set_exception(StoppedError())


async def settle():
    for _ in range(20):
        await asyncio.sleep(0)


def test_the_newest_state_wins_and_no_verdict_is_sent_for_another_picture():
    async def talk():
        sent, quick, final = [], Slow(), Slow()

        async def send(message):
            sent.append(dict(message.head))

        async def ask(verb, seq):
            await session.receive(json.dumps({"do": verb, "seq": seq, "document": {"n": seq}}))
            await settle()

        session = Conversation(send, quick, final)
        running = asyncio.create_task(session.run())
        for seq in (1, 2, 3):
            await ask("move", seq)
        assert [a[:2] for a in quick.asked] == [("move", {"n": 1})]
        quick.gates[-1].set_result(Message({"kind": "outline"}))
        await settle()
        assert quick.asked[-1] == ("move", {"n": 1}, "", False, True)
        quick.gates[-1].set_result(Message({"kind": "moved"}))
        await settle()
        assert quick.asked[-1] == ("measure",)  # which takes less than what was solved anew
        quick.gates[-1].set_result(Message({"kind": "measures"}))
        await settle()
        assert sent[-1] == {"kind": "measures", "shot": 1}
        assert quick.asked[-1][:2] == ("move", {"n": 3})  # 2 was never worked on
        quick.gates[-1].set_result(Message({"kind": "moved"}))
        await ask("rest", 3)
        assert quick.asked[-1] == ("prove",) and final.asked[-1] == ("solve", {"n": 3})
        await ask("move", 4)  # ends the proof of 3
        quick.gates[-1].set_result(Message({"kind": "moved"}))
        await ask("rest", 4)  # and its final shape
        assert [m["seq"] for m in sent if m["kind"] != "measures"] == [1, 1, 3, 4] and not [
            m for m in sent if m["kind"] == "verdicts"
        ]
        assert final.asked[-1] == ("solve", {"n": 4})
        final.gates[-1].set_result(Message({"kind": "picture", "final": True}))
        await settle()
        assert sent[-1] == {"kind": "picture", "final": True, "shot": 4, "seq": 4}
        assert final.asked[-1] == ("kept", {"n": 4})
        final.gates[-1].set_result(("key", {}))
        await settle()
        assert quick.asked[-1] == ("take", "key", {}) and final.asked[-1] == ("measure", {"n": 4})
        final.gates[-1].set_result(Message({"kind": "measures"}))
        await settle()
        assert sent[-1] == {"kind": "measures", "shot": 4}
        quick.gates[-1].set_result(None)
        await ask("move", 5)
        quick.gates[-1].set_result(Message({"kind": "moved"}))
        await asyncio.sleep(1.5 * REST)
        assert final.asked[-1] == final.doing == ("solve", {"n": 5})  # ahead, while the hand rests
        for verb in ("prove", "measure"):
            assert quick.asked[-1] == (verb,)
            quick.gates[-1].set_result(Message({"kind": verb}))
            await settle()
        await ask("move", 6)
        assert final.doing == () and sent[-1]["kind"] == "measure"
        running.cancel()

    asyncio.run(talk())


def test_every_request_is_answered_even_where_the_program_fails(capsys):
    async def talk():
        sent, quick, final = [], Slow(), Slow()

        async def send(message):
            message.packed()
            sent.append(dict(message.head))

        session = Conversation(send, quick, final)
        running = asyncio.create_task(session.run())
        for verb, worker, wrong in (
            ("export", final, ZeroDivisionError()),
            ("export", final, RefusedError("no good mesh was found")),
            ("combs", final, Message({"length": float("nan")})),  # which is no JSON
            ("move", quick, ZeroDivisionError()),
            ("rest", final, Message({"kind": "picture", "unit": float("inf")})),
            ("move", quick, RefusedError("no surface")),  # and it goes on
        ):
            await session.receive(json.dumps({"do": verb, "seq": 7, "document": {}}))
            await settle()
            (worker.gates[-1].set_result if isinstance(wrong, Message) else worker.gates[-1].set_exception)(wrong)
            await settle()
            text = str(wrong) if isinstance(wrong, RefusedError) else INSIDE
            assert sent[-1] == {"kind": "refused", "text": text, "seq": 7, "of": verb}
        assert len(sent) == 6 and not running.done()
        running.cancel()

    asyncio.run(talk())
    assert capsys.readouterr().err.count("Traceback") == 4


# ---- the server

STUDIO = (sys.executable, "-m", "pas", "studio")


@pytest.fixture(scope="module")
def server():
    """A studio without a browser: its process, port and token."""
    process = subprocess.Popen(
        [*STUDIO, "--no-browser"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT, start_new_session=True,
    )  # fmt: skip
    line = process.stdout.readline()
    found = re.fullmatch(r"the studio is at http://127\.0\.0\.1:(\d+)/#token=(\S+) \(Ctrl-C ends it\)\n", line)
    assert found, line
    for _ in range(200):  # until it answers
        try:
            ask(int(found[1]))
            break
        except OSError:
            time.sleep(0.05)
    yield process, int(found[1]), found[2]
    if process.poll() is None:
        process.kill()
        process.wait()


def ask(port, path="/", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, dict(answer.getheaders()), answer.read()


def test_pages_are_served_to_itself_alone(server):
    _, port, token = server
    status, headers, body = ask(port)
    assert status == 200 and token not in body.decode()
    content = headers["content-security-policy"]
    assert "default-src 'none'" in content and "unsafe" not in content and "frame-ancestors 'none'" in content
    assert (headers["referrer-policy"], headers["x-content-type-options"]) == ("no-referrer", "nosniff")
    for host in (
        "example.org",
        f"example.org:{port}",
        "127.0.0.1",
        f"127.0.0.1:{port + 1}",
        f"127.0.0.1.nip.io:{port}",
    ):
        assert ask(port, Host=host)[0] == 403
    for path in ("/../server.py", "/%2e%2e/server.py", "/page/cast.js", "/server.py", "/..%5cserver.py", "/~"):
        assert ask(port, path)[0] in (403, 404)


def test_the_whole_page_is_small_and_names_no_other_host(server):
    files = [path for path in PAGE.iterdir() if path.is_file()]
    bodies = [ask(server[1], f"/{path.name}", **{"Accept-Encoding": "gzip"}) for path in files]
    assert {headers.get("content-encoding", "identity") for _, headers, _ in bodies} <= {"gzip", "identity"}
    assert sum(len(body) for _, _, body in bodies) < 80_000  # over the wire, as browsers ask for it
    assert sum(path.stat().st_size for path in files) < 120_000
    for path in files:
        names = set(re.findall(r"(?:https?|wss?)://([^/\s`'\"]+)", path.read_text(encoding="utf-8")))
        assert names <= {"www.w3.org", "${location.host}"}, path  # the first names SVG, and is never asked


def test_conversations_need_token_and_origin(server):
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    _, port, token = server
    good = f"http://127.0.0.1:{port}"
    for origin, words in [(good, ["pas"]), (good, ["pas", "x" * len(token)]), (good, None), (None, ["pas", token]),
                          ("http://example.org", ["pas", token]), (f"https://127.0.0.1:{port}", ["pas", token]),
                          ("null", ["pas", token]), (f"http://127.0.0.1:{port + 1}", ["pas", token])]:  # fmt: skip
        with pytest.raises(InvalidStatus, match="403"):
            connect(f"ws://127.0.0.1:{port}/talk", origin=origin, subprotocols=words).close()
    with connect(f"ws://127.0.0.1:{port}/talk", origin=good, subprotocols=["pas", token]) as talk:
        first = talk.recv(timeout=20)
        assert json.loads(first[4 : 4 + struct.unpack("<I", first[:4])[0]])["kind"] == "gallery"
        talk.send('{"do": "format the disk"}')
        said = talk.recv(timeout=20)
        assert json.loads(said[4 : 4 + struct.unpack("<I", said[:4])[0]])["kind"] == "refused"


def children(pid):
    listed = [Path(f"/proc/{n}/stat") for n in os.listdir("/proc") if n.isdigit()]
    found = []
    for path in listed:
        try:
            fields = path.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            found.append(int(path.parent.name))
    return found


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are looked up in /proc")
def test_it_ends_by_ctrl_c_and_leaves_no_process(server):
    process, _, _ = server
    helpers = children(process.pid)
    assert len(helpers) >= 2
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 0 and out == "the studio has ended\n" and err == ""
    assert_gone(helpers)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are looked up in /proc")
@pytest.mark.parametrize("way", [signal.SIGINT, signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, None])
def test_it_leaves_no_process_however_it_ends(way):
    """In the middle of solving for a page; None: its terminal is closed."""
    import pty

    from websockets.sync.client import connect

    ours, terminal = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", IN_TERMINAL], stdin=terminal, stdout=subprocess.PIPE, cwd=ROOT, start_new_session=True
    )
    os.close(terminal)
    port, token = re.search(rb":(\d+)/#token=(\S+)", process.stdout.readline()).groups()
    address = f"127.0.0.1:{port.decode()}"
    with connect(f"ws://{address}/talk", origin=f"http://{address}", subprotocols=["pas", token.decode()]) as talk:
        assert talk.recv(timeout=20)
        talk.send(json.dumps({"do": "rest", "seq": 1, "document": GALLERY["Six-way node"]}))
        time.sleep(2)
        helpers = children(process.pid)
        assert len(helpers) >= 2
        if way is not None:
            process.send_signal(way)
        os.close(ours)
        process.wait(timeout=20)
    assert_gone(helpers)


IN_TERMINAL = """import fcntl, runpy, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)  # the terminal is this session's
sys.argv = ["pas", "studio", "--no-browser"]
if __name__ == "__main__":
    runpy.run_module("pas", run_name="__main__")"""


def assert_gone(processes):
    for _ in range(200):
        if not any(map(alive, processes)):
            return
        time.sleep(0.05)
    raise AssertionError(f"processes are left: {[p for p in processes if alive(p)]}")


def test_a_port_in_use_is_one_sentence(capsys):
    with listening(0) as door:
        assert main(["studio", "--no-browser", "--port", str(door.getsockname()[1])]) == WRONG
    assert "is in use or not allowed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("no.toml", "no.toml"),
        ("a.txt", "neither a problem"),
        pytest.param("wrong.toml", "wrong.toml, line 2", marks=pytest.mark.slow),  # processes are started that read it
    ],
)
def test_a_wrong_file_is_one_sentence(name, sentence, capsys, tmp_path):
    (tmp_path / "wrong.toml").write_text("order = 2\n[[pipes]]\nradius = 1\n")
    assert main(["studio", "--no-browser", str(tmp_path / name)]) == WRONG
    error = capsys.readouterr().err
    assert sentence in error and error.count("\n") == 1


def test_shapes_are_animated_from_one_camera(tmp_path):
    from PIL import Image

    balls = [pas.solid.ball((0, 0, 0), r) for r in ("1/2", 1)]
    path = pas.animate(lambda n: balls[n], (0, 1), tmp_path / "grow.gif", size=(80, 60), pause=0.1)
    moving = Image.open(path)
    assert (moving.n_frames, moving.size, moving.info["duration"]) == (2, (80, 60), 100)
    wide = []
    for number in range(2):
        moving.seek(number)
        row = np.asarray(moving.convert("RGB"), dtype=int)[30]
        wide.append(int((row.max(axis=1) - row.min(axis=1) > 60).sum()))  # orange
    assert wide[0] * 1.7 < wide[1] < wide[0] * 2.3
    folder = pas.animate(lambda _: balls[0], range(2), tmp_path / "frames", size=(80, 60), turn=90)
    assert sorted(p.name for p in folder.iterdir()) == ["0000.png", "0001.png"]
    with pytest.raises(ValueError, match="values must hold at least one"):
        pas.animate(lambda n: balls[n], (), tmp_path / "none.gif")
    with pytest.raises(ValueError, match="pause must be a positive number"):
        pas.animate(lambda n: balls[n], (0,), tmp_path / "none.gif", pause=0)


def test_tokens_differ_and_stand_in_the_fragment():
    one, two = Studio(None, 8000), Studio(None, 8000)
    assert one.token != two.token and one.address == f"http://127.0.0.1:8000/#token={one.token}"
    assert len(one.token) >= 32


def test_meshes_of_other_kinds_are_drawn_from_triangles():
    message = picture(pas.solid.ball((0, 0, 0), 1))
    assert message.head["how"] == "mesh" and message.head["triangles"] * 3 == message.arrays["triangles 0"].size
    assert np.abs(np.linalg.norm(message.arrays["points 0"], axis=1) - 1).max() < 0.01
    assert set(TEAPOT) == {c["path"][-1] for c in controls({"kind": "teapot", "values": {}})}


def test_a_network_is_sent_as_bodies_and_their_places():
    """Together they are the mesh, in the page's coordinates, and have the colours of their classes."""
    net = network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1), (0, 2), (2, 3)], "1/8", "1/8")
    part = net.blend(1, "lowest")
    message = picture(part)
    places = [message.arrays[f"places {n}"] for n in range(len(message.head["colors"]))]
    points = [message.arrays[f"points {n}"] for n in range(len(places))]
    assert sum(map(len, places)) == len(net.points)
    assert [name for name, _ in message.head["parts"]] == [str(one) for one in part.classes]
    assert set(message.head["colors"]) == {color for _, color in message.head["parts"]}
    everything = np.concatenate([at + shape for shape, ats in zip(points, places, strict=True) for at in ats])
    box = message.head["scale"] * np.stack([everything.min(axis=0), everything.max(axis=0)]) + message.head["origin"]
    np.testing.assert_allclose(box, part.bounding_box, atol=1e-6)
    counts = [len(message.arrays[f"triangles {n}"].reshape(-1, 3)) * len(at) for n, at in enumerate(places)]
    assert message.head["triangles"] == sum(counts)
