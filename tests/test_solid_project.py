"""Project files of solids and assemblies: exact round trips, and what cannot be saved."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from conftest import EQUAL, solved

import pas
from pas import cli, solid
from pas.algebra.affine import rotation, translation
from pas.errors import ProjectFileError
from pas.exchange import files as container
from pas.exchange.solid_records import FUNCTION, storable
from pas.mesh.mesh import Mesh
from pas.solid.assembly import assembly
from pas.solid.functions import Distance, Moved
from pas.solid.solid import Solid, patch
from pas.solid.tree import Atom, Node


def doubled() -> Solid:
    """Two patches of one sphere that meet in a claimed joint."""
    halves = patch("top", "x^2 + y^2 + z^2 - 1", "z") | patch("bottom", "x^2 + y^2 + z^2 - 1", "-z")
    return halves.joined("top", "bottom", ("x^2 + y^2 + z^2 - 1", "z"), 1)


SOLIDS = {
    "ball": solid.ball((0, "1/3", "-1e-20"), "22/7"),
    "difference": solid.box((0, 0, 0), (1, 1, 1)) - solid.ball((1, 1, 1), "1/2") - solid.ball((0, 0, 0), "1/2"),
    "turned": solid.torus((0, 0, 0), (1, 2, 3), 3, "1/2").rotate((1, 1, 0), 33, (1, 2, 3)).scale((1, "2/3", 5)),
    "apex": solid.cone((0, 0, 0), (0, 0, "1/3"), "1/7").translate(("1/3", 0.1, 0)),
    "joined": doubled(),
    "capped": solid.implicit("x^4 + y^4 + z^4 - 1", "z + 2", face="quartic").cap("x - 1/5", "flat, with ünïcode"),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_come_back_exactly(name, tmp_path):
    before = SOLIDS[name]
    after = pas.load(pas.save_solid(before, tmp_path / "a.pas.json"))
    assert isinstance(after, Solid)
    assert after.tree == before.tree
    assert after.joints == before.joints
    assert after.special_points == before.special_points
    assert after.faces == before.faces
    other = pas.save_solid(after, tmp_path / "b.pas.json")
    assert other.read_text() == (tmp_path / "a.pas.json").read_text()


def block() -> Solid:
    return solid.box((0, 0, 0), (4, 3, 2))


def bore() -> Solid:
    return solid.cylinder((2, "3/2", -1), (2, "3/2", 3), "1/2", face="bore")


def plate() -> Any:
    return solid.rounded_rectangle(40, 30, 5)


def corner() -> Solid:
    """A blend with its neighbours."""
    return solved(EQUAL, 1).solid(length=2)


MADE = {
    "box": block,
    "ball": lambda: solid.ball((0, 0, 0), 1),
    "cylinder": lambda: solid.cylinder((0, 0, 0), (1, 2, 3), 1),
    "cone": lambda: solid.cone((0, 0, 0), (1, 2, 3), 1),
    "truncated cone": lambda: solid.cone((0, 0, 0), (1, 2, 3), 1, "1/3").mirror((1, 0, 0)),
    "torus": lambda: solid.torus((0, 0, 0), (1, 2, 3), 3, 1),
    "implicit": lambda: solid.implicit("x^4 + y^4 + z^4 - 1"),
    "extruded": lambda: (plate() - solid.circle((10, 10), 3)).extrude(5),
    "tapered": lambda: plate().extrude(5, taper=10),
    "text": lambda: solid.text("ab", size=10).extrude(2),
    "revolved": lambda: solid.circle((3, 0), 1).revolve(),
    "revolved in part": lambda: solid.polygon([(1, 0), (2, 0), (2, 3)]).revolve(100),
    "rounded": lambda: block().rounded(radius="1/2"),
    "rounded edges": lambda: block().rounded(["box x+", "box y+"], radius="1/2", order=2),
    "rounded and drilled": lambda: (block() - bore()).rounded(radius="1/4"),
    "rounded profile": lambda: plate().extrude(9).rounded(radius=1),
    "fillet": lambda: block().fillet("box x+", "box y+", radius="1/2"),
    "fillet and drilled": lambda: block().fillet("box x+", "box y+", radius="1/2") - bore(),
    "chamfer": lambda: block().chamfer("box x+", "box y+", "1/2"),
    "pipe": lambda: solid.pipe([(0, 0, 0), (0, 0, 50), (30, 0, 50)], 5, bend=12, wall=1),
    "thread": lambda: solid.thread(8, "1.25", 5),
    "pattern": lambda: bore().pattern(3, (2, 0, 0)),
    "circular pattern": lambda: solid.box((2, 0, 0), (3, 1, 1)).circular_pattern(4, (0, 0, 1)),
    "union": lambda: block() | solid.ball((4, 3, 2), 1),
    "difference": lambda: block() - solid.ball((4, 3, 2), 1) - bore(),
    "intersection": lambda: block() & solid.ball((2, 1, 1), 2),
    "in turn": lambda: (block() - solid.ball((4, 3, 2), 1) | solid.box((3, 1, 1), (6, 2, "3/2"))) - bore(),
    "moved": lambda: (block() - bore()).rotate((1, 2, 3), 33).translate(5, 0, 0).scale(2),
    "capped": lambda: block().cap("x + y - 5"),
    "renamed": lambda: block().renamed("all"),
    "half of it": lambda: block() & solid.half_space("x + y + z - 4"),
    "shell": lambda: block().shell("1/10", open=["box z+"]),
    "run": lambda: solid.cylinder((0, 0, 0), (0, 0, 9), 1) - solid.cylinder((0, 0, -1), (0, 0, 10), "1/2"),
    "corner": corner,
    "corners": lambda: corner() | corner().renamed("other").translate(20, 0, 0),
    "cut corner": lambda: (corner() - solid.cylinder((0, 0, -9), (0, 0, 9), "1/10")).rotate((1, 2, 3), 20),
}


@pytest.mark.sampled(12)
@pytest.mark.parametrize("name", MADE)
def test_what_is_read_has_the_same_mesh(name, tmp_path):
    made = MADE[name]()
    read = pas.load(made.save(tmp_path / "a.pas.json"))
    assert read.save(tmp_path / "b.pas.json").read_text() == (tmp_path / "a.pas.json").read_text()
    assert type(read.sheets) is type(made.sheets)
    one, other = made.mesh(), read.mesh()
    assert (one.names, one.deviation) == (other.names, other.deviation)
    for field in ("points", "triangles", "faces", "normals"):
        assert np.array_equal(getattr(one, field), getattr(other, field)), field


def test_many_operations_in_turn_are_saved(tmp_path):
    """Trees that nest deeper than files are read, and what bounds these: a flat list of operands, each once."""
    made, lengths = block(), {}
    for k in range(301):
        small = solid.ball((4, 3, 1 + k / 320), "1/8") if k % 2 else solid.box((k / 80, 0, 0), ((k + 1) / 80, 1, 1))
        if k in (75, 300):
            read = pas.load(path := made.save(tmp_path / "a.pas.json"))
            assert read.tree == made.tree and read.sheets.steps == made.sheets.steps
            assert len(read.sheets.parts) == k + 1
            lengths[k] = len(path.read_text())
        made = made | small if k % 2 else made - small
    assert lengths[300] < 4.2 * lengths[75]


def test_branches_refer_to_earlier_ones(tmp_path):
    made = solid.ball((0, 0, 0), 1)
    for k in range(200):
        small = solid.ball((k, 0, 0), 1)
        made = made | small if k % 2 else made - small
    path = made.save(tmp_path / "a.pas.json")
    rewrite(path, lambda content: content["solid"]["branches"].reverse())
    with pytest.raises(ProjectFileError, match=r"there is no branch before number \d+; there are \d"):
        pas.load(path)


@pytest.mark.parametrize(("name", "verb"), [("a.pas.json", "`save` writes project files"), ("a.png", "`draw` makes")])
def test_what_other_verbs_write_is_said(name, verb, tmp_path):
    with pytest.raises(ValueError, match=f"cannot write a shape as '{name}'; the suffix must be one of .*; {verb}"):
        block().write(tmp_path / name)


def test_nothing_known_bounds_what_was_edited(tmp_path):
    path = solid.cylinder((0, 0, 0), (0, 0, 9), 5).save(tmp_path / "a.pas.json")
    rewrite(path, lambda content: content["solid"]["functions"][0]["polynomial"][-1].__setitem__(3, "-16"))
    read = pas.load(path)
    assert read.sheets is None
    assert read.volume(1e-3) == pytest.approx(np.pi * 16 * 9, rel=1e-4)


def test_what_bounds_a_solid_is_not_believed_where_it_was_edited(tmp_path):
    path = block().save(tmp_path / "a.pas.json")
    rewrite(path, lambda content: content["solid"]["sheets"]["body"]["data"]["body"]["data"].update(height=9.0))
    assert pas.load(path).sheets is None and pas.load(path).volume() == pytest.approx(24)


def test_what_bounds_a_solid_is_of_a_class_that_does(tmp_path):
    path = block().save(tmp_path / "a.pas.json")

    def change(content):
        own = content["solid"]
        body = own["sheets"]["body"]["data"]["body"]
        body.update({"class": "pas.solid.edges.Loop", "data": body["data"]["loops"][0]})
        known = {"functions": own["functions"], "tree": own["tree"], "body": own["sheets"]["body"]}
        own["sheets"]["of"] = container.checksum(known)

    rewrite(path, change)
    with pytest.raises(pas.ProjectFileError, match=r"of no class 'pas\.solid\.edges\.Loop'"):
        pas.load(path)


def test_joints_are_proved_anew(tmp_path):
    path = pas.save_solid(doubled(), tmp_path / "a.pas.json")
    assert "verdict" not in path.read_text()
    assert pas.load_solid(path).proved


def test_functions_are_written_once(tmp_path):
    path = pas.save_solid(SOLIDS["joined"], tmp_path / "a.pas.json")
    record = json.loads(path.read_text())["content"]["solid"]
    assert len(record["functions"]) == 3
    assert record["tree"]["union"][0]["intersection"][0] == {"function": 0, "face": "top"}


@pytest.fixture
def pair():
    mesh = Mesh.from_triangles(
        [(0, 0, 0), (1 / 3, 0, 0), (0, 0.1, 0), (0, 0, 1e-7)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], "tetra"
    )
    return assembly({"a ball": SOLIDS["ball"], "joined": (doubled(), "#0a0B0c"), "mesh": (mesh, "#ffffff")})


def test_assemblies_come_back_exactly(pair, tmp_path):
    again = pas.load(pas.save_solid(pair, tmp_path / "a.pas.json"))
    assert list(again.parts) == list(pair.parts)
    for name, part in pair.parts.items():
        assert again[name].color == part.color
        if isinstance(part.shape, Solid):
            assert again[name].shape.tree == part.shape.tree
            assert again[name].shape.joints == part.shape.joints
        else:
            for field in ("points", "triangles", "faces", "normals"):
                first, second = getattr(part.shape, field), getattr(again[name].shape, field)
                assert np.array_equal(first, second) and first.dtype == second.dtype
            assert again[name].shape.names == part.shape.names
    assert again.proved


@dataclass(frozen=True)
class Sphere(Distance):
    """The distance from a sphere about the origin."""

    radius: float

    def jets(self, points: Any) -> Any:
        """Values and gradients."""
        length = np.linalg.norm(points, axis=1)
        return np.concatenate([(length - self.radius)[:, None], points / length[:, None]], axis=1)


@dataclass(frozen=True)
class KeptSphere(Sphere):
    """One that can be saved."""

    def to_record(self) -> Any:
        """The radius."""
        return {"radius": self.radius}

    @classmethod
    def from_record(cls, record: Any) -> KeptSphere:
        """The sphere of `to_record`."""
        return cls(**record)


def test_functions_that_cannot_be_saved_are_named(tmp_path):
    around = Solid(Atom(Sphere(1.0), "sphere"))
    with pytest.raises(ValueError, match="a Sphere cannot be saved exactly: it is no polynomial"):
        pas.save_solid(around, tmp_path / "a.pas.json")
    with pytest.raises(ValueError, match="the part 'shell': a solid with a Sphere"):
        pas.save_solid(assembly(ball=SOLIDS["ball"], shell=around), tmp_path / "a.pas.json")
    with pytest.raises(TypeError, match="Sphere has no to_record"):
        storable(Sphere)
    assert not list(tmp_path.iterdir())


def test_functions_of_classes_that_say_how_are_saved(tmp_path, monkeypatch):
    monkeypatch.setattr("pas.exchange.solid_records._named", {})
    kept = Solid(Node((Atom(KeptSphere(0.1), "sphere", True), Atom(pas.Polynomial("x"), "")), False))
    with pytest.raises(ValueError, match="before its class is named to `storable`"):
        pas.save_solid(kept, tmp_path / "a.pas.json")
    assert storable(KeptSphere) is KeptSphere
    path = pas.save_solid(kept, tmp_path / "a.pas.json")
    assert pas.load(path).tree == kept.tree
    monkeypatch.setattr("pas.exchange.solid_records._named", {})
    with pytest.raises(pas.ProjectFileError, match=r"KeptSphere' are not known; name the class"):
        pas.load(path)


def test_moved_functions_are_saved(tmp_path, monkeypatch):
    monkeypatch.setattr("pas.exchange.solid_records._named", {})
    storable(KeptSphere)
    moved = KeptSphere(0.5).moved(translation((1, "1/3", 0))).moved(rotation((1, 1, 0), 33, (1, 2, 3)))
    again = FUNCTION.read(json.loads(json.dumps(FUNCTION.write(moved))))
    assert isinstance(again, Moved) and isinstance(again.inner, Moved)
    assert (again.map, again.factor, again.inner.map) == (moved.map, moved.factor, moved.inner.map)
    points = np.random.default_rng(0).normal(size=(10, 3))
    assert np.array_equal(again.jets(points), moved.jets(points))


@pytest.mark.parametrize("name", ["os.path", "builtins.eval", "subprocess.Popen", "pas.solid.mesh.np", "pas.cli.main"])
def test_files_cannot_name_any_class(name):
    with pytest.raises(ValueError, match="are not known"):
        FUNCTION.read({"class": name, "data": {}})


def test_names_and_shapes_are_checked(tmp_path):
    with pytest.raises(ValueError, match=r"the suffix must be .pas.json"):
        pas.save_solid(SOLIDS["ball"], tmp_path / "a.json")
    with pytest.raises(TypeError, match="must be a mesh, a solid, an assembly"):
        pas.save_solid("ball", tmp_path / "a.pas.json")
    assert not list(tmp_path.iterdir())


def test_kinds_are_told_apart(tmp_path):
    blend = solved(EQUAL, 1).save(tmp_path / "blend.pas.json")
    assert json.loads(blend.read_text())["content"]["kind"] == "blend"
    ball = pas.save_solid(SOLIDS["ball"], tmp_path / "ball.pas.json")
    rewrite(ball, lambda content: content.update(kind="car"))
    with pytest.raises(pas.ProjectFileError, match=r"of kind 'car'.*update pas"):
        pas.load(ball)


def test_blends_without_a_kind_stay_readable(tmp_path):
    path = solved(EQUAL, 1).save(tmp_path / "blend.pas.json")
    rewrite(path, lambda content: content.pop("kind"))
    assert pas.load(path).surface.patches == solved(EQUAL, 1).surface.patches


def test_edited_solids_are_not_believed(tmp_path):
    path = pas.save_solid(SOLIDS["ball"], tmp_path / "a.pas.json")
    path.write_text(path.read_text().replace('"ball"', '"bowl"'))
    with pytest.raises(pas.ProjectFileError, match="does not match its checksum"):
        pas.load(path)
    assert pas.load(path, edited=True).faces == ("bowl",)
    assert pas.load_solid(path, edited=True).faces == ("bowl",)


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c["solid"].pop("tree"),
        lambda c: c["solid"]["tree"]["intersection"].clear(),
        lambda c: c["solid"]["tree"]["intersection"][0].update(function=99),
        lambda c: c["solid"]["functions"][0].update(polynomial=[[1, 0, 0, "1/0"]]),
        lambda c: c["solid"].update(joints=[{"first": "a", "second": "b", "along": [], "order": 1}]),
        lambda c: c["solid"]["sheets"]["body"].pop("class"),
        lambda c: c.update(kind="assembly"),
    ],
)
def test_contents_that_make_no_sense(tmp_path, change):
    path = pas.save_solid(SOLIDS["difference"], tmp_path / "a.pas.json")
    rewrite(path, change)
    with pytest.raises(pas.ProjectFileError, match=r"a\.pas\.json: the content cannot be understood"):
        pas.load(path)


def test_the_command_line_reads_solids(tmp_path, capsys):
    ball = pas.save_solid(SOLIDS["ball"], tmp_path / "ball.pas.json")
    joined = pas.save_solid(doubled(), tmp_path / "joined.pas.json")
    assert cli.main(["mesh", str(ball), "-o", str(tmp_path / "ball.3mf"), "--tolerance", "0.3"]) == cli.DONE
    assert (tmp_path / "ball.3mf").exists()
    assert cli.main(["check", str(joined)]) == cli.DONE
    assert "top meets bottom with GC^1" in capsys.readouterr().out
    assert cli.main(["check", str(ball)]) == cli.FAILED
    assert cli.main(["render", str(ball), "-o", str(tmp_path / "ball.png"), "--curvature"]) == cli.WRONG
    assert "curvature colours exist for blends" in capsys.readouterr().err


def rewrite(path, change):
    """Change a file's content, with the right checksum."""
    record = json.loads(path.read_text())
    change(record["content"])
    record["sha256"] = container.checksum(record["content"])
    path.write_text(json.dumps(record))


@pytest.mark.parametrize("ends", ["flat", "round"])
def test_tubes_are_read_as_they_end(ends, tmp_path):
    tube = solid.tube(("cos(t)", "sin(t)", "t/5"), "1/8", (0, 1), ends=ends)
    read = pas.load(tube.save(tmp_path / "a.pas.json"))
    points = np.random.default_rng(0).uniform(tube.box[0], tube.box[1], (3000, 3))
    assert (read.value(points) == tube.value(points)).all()
    beyond = np.array([1.0, 0, 0]) - 0.1 * np.array([0, 1, 0.2]) / np.hypot(1, 0.2)
    assert tube.contains(beyond) == read.contains(beyond) == (ends == "round")
