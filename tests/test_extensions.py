"""Extensions from outside the package: an energy, a partition, a method, each one file of `examples/extensions`."""

from __future__ import annotations

import importlib.util
import sys
from fractions import Fraction

import numpy as np
import pytest
from conftest import ROOT, UNEQUAL, fair, pipes

import pas
from pas.blending.solving import METHODS
from pas.cli import main
from pas.contacts.contact import CONTACTS
from pas.exchange.formats import FORMATS
from pas.exchange.problem import PROBLEMS
from pas.fairing.energy import ENERGIES
from pas.partition.boxes import VERTEX_SIGNS
from pas.partition.cells import PARTITIONS, read_partition
from pas.shape import KINDS

FOLDER = ROOT / "examples/extensions"
TETRAHEDRON = [(0, 0, 0), (3, 1, 0), (-1, 2, "1/3"), (1, 1, 4)]
ANY_NODE = pas.solutions(pas.struts([((1, 2, 0), 1), ((-1, 2, 1), 1)], 1), 1, 4, "fan").partition
PARTITION_SAMPLES = {
    "six tetrahedra": [pas.SixTetrahedra(("1/2", 0, 1), ((1, 0, 0), (0, 2, 0), (0, 0, "1/3")))],
    "single cell": [pas.SingleCell(), pas.SingleCell((0, 0, 0), (1, 2, "1/3"), ("1/2", 1, "1/7"))],
    "tetrahedra": [
        pas.Partition([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, "1/3"), (1, 1, 1)], [(0, 1, 2, 3), (1, 2, 3, 4)])
    ],
    "region": [pas.Region(TETRAHEDRON, [(0, 1, 2, 3)], title="one tetrahedron"), ANY_NODE],
    "open region": [pas.OpenRegion(TETRAHEDRON, [(0, 1, 2, 3)], TETRAHEDRON[0], title="one tetrahedron")],
    "alfeld split": [pas.AlfeldSplit(), pas.AlfeldSplit(TETRAHEDRON, ("2/3", "4/5", 1))],
    "worsey-farin split": [pas.WorseyFarinSplit(), pas.WorseyFarinSplit(TETRAHEDRON)],
    "kuhn cube": [pas.KuhnCube(), pas.KuhnCube((0, 1, "-1/2"), (3, "4/3", 5))],
}
REGISTRIES = (CONTACTS, ENERGIES, FORMATS, KINDS, METHODS, PARTITIONS, PROBLEMS)
EVERY = [partition for partitions in PARTITION_SAMPLES.values() for partition in partitions]


@pytest.fixture(scope="module")
def extension():
    """A function that loads a file once; what the files register is forgotten after these tests."""
    loaded, before = {}, [(registry, dict(registry._entries)) for registry in REGISTRIES]

    def load(name):
        if name not in loaded:
            spec = importlib.util.spec_from_file_location(f"extension_{name}", FOLDER / f"{name}.py")
            loaded[name] = importlib.util.module_from_spec(spec)
            sys.modules[spec.name] = loaded[name]
            spec.loader.exec_module(loaded[name])
        return loaded[name]

    yield load
    for registry, entries in before:
        registry._entries = entries


def test_every_file_is_in_the_table():
    text = (FOLDER / "README.md").read_text()
    assert all(f"]({path.name})" in text for path in FOLDER.glob("*.py"))


def test_an_energy(extension, tmp_path):
    values = extension("values").Values
    space = pas.solutions(pipes(UNEQUAL), 1, 4)
    blend = space.fit(energy=values("1/2") + pas.ThinPlate(weight="1/100"))
    assert blend.certificate.proved
    # the matrix, anew: by the exact products of the membrane's rule, f^2 is the sum of squares of values
    form = space.prepared.form(values())
    basis, total = space.prepared.basis, 0
    for cell in range(6):
        corners = basis.partition.points[list(basis.partition.cells[cell])]
        volume = abs(np.linalg.det(corners[1:] - corners[0])) / 6 * basis.scale**3
        random = np.random.default_rng(cell).dirichlet(np.ones(4), 20000) @ corners
        table = basis.values(int(basis.partition.piece_of[cell]), random)
        total = total + volume * table.T @ table / len(table)
    assert np.linalg.norm(total - form) < 0.05 * np.linalg.norm(form)
    again = pas.load(space.fit(energy=values(3), prove=False).save(tmp_path / "a.pas.json"))
    assert again.wishes.energy == values(3)
    problem = tmp_path / "a.toml"
    problem.write_text(
        (ROOT / "examples/corners/unequal_gc1.toml").read_text() + '[energy]\nkind = "values"\nweight = 0.25\n'
    )
    assert pas.read_problem(problem).wishes.energy == values(Fraction(1, 4))
    problem.write_text(problem.read_text().replace("weight = 0.25", "weigth = 1"))
    with pytest.raises(pas.ProblemFileError, match=r"'weigth'.* is 'weight' meant"):
        pas.read_problem(problem)


def test_a_partition(extension, tmp_path):
    """The fan over the hexagon of the six tetrahedra is that partition, and has its blends."""
    top, bottom, *rim = [list(signs) for signs in VERTEX_SIGNS]
    fan = extension("fan").Fan(top, bottom, rim)
    blend = pas.blend(pipes(UNEQUAL), 1, partition=fan)
    assert blend.certificate.proved
    assert blend.surface.degree == fair(UNEQUAL, 1).surface.degree
    again = pas.load(blend.save(tmp_path / "a.pas.json"))
    assert again.surface.patches == blend.surface.patches
    assert again.certificate.proved
    text = (ROOT / "examples/corners/unequal_gc1.toml").read_text()
    problem = tmp_path / "a.toml"
    problem.write_text(f'{text}\n[partition]\nkind = "fan"\ntop = {top}\nbottom = {bottom}\nrim = {rim}\n')
    assert pas.read_problem(problem).partition.vertices == fan.vertices
    problem.write_text(problem.read_text().replace("bottom", "botom"))
    with pytest.raises(pas.ProblemFileError, match=r"unknown key 'botom'.* is 'bottom' meant"):
        pas.read_problem(problem)


def test_a_method(extension):
    extension("checked")
    assert "checked" in METHODS
    space = pas.solutions(pipes(UNEQUAL), 1, 4, method="checked")
    assert space.equals(pas.solutions(pipes(UNEQUAL), 1, 4))
    with pytest.raises(ValueError, match="there is a method 'checked' already"):
        pas.register_method(METHODS["checked"])
    with pytest.raises(TypeError, match=r"method must be a pas\.SolvingMethod"):
        pas.register_method("linear")


def test_a_method_that_gives_polynomials(extension):
    """Undetermined coefficients find what the other methods do; several pieces take tuples, and nonsense is refused."""
    extension("undetermined")
    crossed = [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")]
    for order, degree in ((0, 3), (1, 2), (1, 4)):
        found = pas.solutions(crossed, order, degree, pas.SingleCell(), method="undetermined coefficients")
        assert found.equals(pas.solutions(crossed, order, degree, pas.SingleCell()))
    known = pas.solutions(pipes(UNEQUAL), 1, 4)
    bases = {
        "tuples": list(known.basis),
        "lists": [list(member) for member in known.basis],
        "short": [member[:5] for member in known.basis],
        "twice": [*known.basis, known.basis[0]],
        "high": [tuple(p * "x" for p in known.basis[0])],
    }
    for name, basis in bases.items():
        pas.register_method(pas.SolvingMethod(name, lambda placed, degree, basis=basis: basis, several=True))
    for name in ("tuples", "lists"):
        space = pas.solutions(pipes(UNEQUAL), 1, 4, method=name)
        assert space.basis == known.basis and space.fit(energy=pas.ThinPlate()).certificate.proved
    for name, words in (
        ("short", "member 0 of the method 'short' has 5 polynomials for 6 pieces"),
        ("twice", "the 26 members of the method 'twice' are not linearly independent"),
        ("high", "of a degree above 4"),
    ):
        with pytest.raises(ValueError, match=words):
            pas.solutions(pipes(UNEQUAL), 1, 4, method=name)


def test_a_contact(extension, tmp_path):
    """A cyclide has the circles that it is made from, moves as others do, and is blended from files and back."""
    cyclide = extension("cyclide").Cyclide
    bend = cyclide((0, 0, 1), (4, 0, 0), 1, "3/2")
    surface = bend.contact.surface
    assert bend.rim.center == (4, 0, 0) and bend.rim.normal == (0, 1, 0)
    for place, radius in ((4, 1), (-4, Fraction(3, 2))):  # both circles in the plane y = 0, exactly
        for x, z in ((1, 0), (0, 1), (-1, 0), (Fraction(3, 5), Fraction(-4, 5))):
            assert surface.at((place + radius * x, 0, radius * z)) == 0
    ring = cyclide((0, 0, 1), (4, 0, 0), 1, 1).contact.surface  # of one radius it is a torus
    assert ring == pas.Torus((0, 0, 1), (4, 0, 0), 1).contact.surface
    moved = bend.rotate((1, 2, 2), 90).translate((1, "1/2", 0))
    assert moved.rim.center == bend.contact.rotate((1, 2, 2), 90).translate((1, "1/2", 0)).rim.center
    problem = tmp_path / "bend.toml"
    problem.write_text(
        'order = 1\n[[cyclides]]\naxis = [0, 0, 1]\narm = [4, 0, 0]\nradius = 1\nfar_radius = "3/2"\n'
        '[[pipes]]\naxis = [0, -1, 0]\nradius = 1\nclip = "auto"\npoint = [4, -3, 0]\n'
    )
    read = pas.read_problem(problem)
    assert [c.contact for c in read.contacts if isinstance(c, cyclide)] == [bend.contact]
    blend = pas.blend(read.contacts, read.order, 4)
    assert blend.certificate.proved and blend.fairness.within(blend.limits)
    assert pas.load(blend.save(tmp_path / "bend.pas.json")).certificate.proved


def test_the_octahedral_split(extension):
    """A node of a diamond lattice: four pipes of one radius in four of the eight faces."""
    split = extension("octahedron").OctahedralSplit(3)
    assert len(split.cells) == 8 and read_partition(split.to_record()).vertices == split.vertices
    assert (
        extension("octahedron").OctahedralSplit("3/2", (1, "1/2", 0)).center
        == pas.SixTetrahedra((1, "1/2", 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))).center
    )
    directions = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    blend = pas.blend([pas.Pipe(axis, "1/2", 1) for axis in directions], 2, 6, partition=split)
    assert blend.certificate.proved and blend.dimension == 26
    assert blend.fairness.sharpness < 1.02 and blend.fairness.hollowness < 1.7


def test_every_registered_partition_is_tested_here():
    inside = {name for name, made in PARTITIONS.items() if made.__module__.startswith("pas.")}
    assert set(PARTITION_SAMPLES) == inside


@pytest.mark.parametrize("partition", EVERY, ids=lambda p: p.name)
def test_partitions_go_through_tables_and_toml(partition, tmp_path):
    record = partition.to_record()
    again = read_partition(record)
    assert type(again) is type(partition)
    assert again.to_record() == record
    parts = ("vertices", "cells", "pieces", "center")
    assert [getattr(again, part) for part in parts] == [getattr(partition, part) for part in parts]
    table = "\n".join(f"{key} = {value!r}" for key, value in record.items() if value is not None)
    problem = tmp_path / "a.toml"
    problem.write_text(f'order = 1\n[[contacts]]\nsurface = "x^2 + y^2 - 1"\nclip = "z"\n[partition]\n{table}\n')
    assert pas.read_problem(problem).partition.to_record() == record
    with pytest.raises(ValueError, match="'colour' does not belong to the partition"):
        read_partition(record | {"colour": "red"})


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"kind": "six tetrahedrons"}, "kind: there is no partition 'six tetrahedrons'; is 'six tetrahedra' meant"),
        ({}, "the partition 'six tetrahedra' needs 'legs'"),
        ({"kind": "tetrahedra", "vertices": []}, "the partition 'tetrahedra' needs 'cells'"),
        ({"kind": "single cell", "lower": [0, 0, 0]}, "needs both lower and upper"),
    ],
)
def test_bad_partitions_are_refused(table, words):
    with pytest.raises(ValueError, match=words):
        read_partition(table)


def test_a_primitive(extension, tmp_path):
    prism = extension("prism").prism
    wedge = prism([(0, 0), (3, 0), (0, 4)], 0, "1/2")
    assert set(wedge.faces) == {"top", "bottom", "side 1", "side 2", "side 3"}
    assert abs(wedge.volume() - 3) < 1e-12
    mesh = wedge.mesh(0.1)
    assert mesh.is_closed and set(mesh.names) == set(wedge.faces)
    again = pas.load(wedge.save(tmp_path / "wedge.pas.json"))
    assert again.faces == wedge.faces and again.contains([1, 1, 0.25]) and not again.contains([2, 2, 0.25])
    with pytest.raises(ValueError, match="do not at corner 2"):
        prism([(0, 0), (0, 4), (3, 0)], 0, 1)


def test_a_style_of_pictures(extension, tmp_path):
    extension("heights")
    ball = pas.solid.ball((0, 0, 0), 1)
    project = str(ball.save(tmp_path / "a.pas.json"))
    assert main(["render", project, "-o", str(tmp_path / "a.png"), "--style", "heights", "--tolerance", "0.05"]) == 0
    ball.draw(tmp_path / "b.png", style="heights", tolerance=0.05)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    with pytest.raises(ValueError, match="no style of pictures 'height'; is 'heights' meant"):
        ball.draw(tmp_path / "c.png", style="height")
