"""Layouts: what they must cover, their spline spaces by formulas, and blends of nodes in any directions on them."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest

import pas
from pas.algebra.rational import cross, determinant, dot, rational
from pas.blending.net import Net, splines
from pas.blending.place import place, placements, with_ends
from pas.blending.solving import fewest_members
from pas.contacts.contact import as_contact
from pas.exchange.problem import read_problem
from pas.layouts.kinds import LAYOUTS
from pas.layouts.nodes import ContactNode
from pas.layouts.planes import arrangement
from pas.layouts.region import WALLS, Builder, region
from pas.partition.layout import Layout
from pas.render.layout import colors
from pas.surface.placed import PlacedContacts

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
BACK = tuple(tuple(-c for c in axis) for axis in (X, Y, Z))


def pipe(axis, radius, clip, point=(0, 0, 0)):
    return pas.Pipe(axis=axis, radius=radius, clip=clip, point=point)


FIVE = ((1, 1, 1), (1, -1, -1), (-2, 1, -1), (-1, -1, 1), (1, 2, -2))
TETRAHEDRAL = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
NODES = {
    "elbow": [pipe(X, 1, 2), pipe(Y, 1, 2)],
    "unequal at 120 degrees": [pipe((1, -1, 0), 1, "3/2"), pipe((0, 1, -1), "3/5", "3/2")],
    "T": [pipe(X, 1, 2), pipe(BACK[0], 1, 2), pipe(Y, 1, 2)],
    "Y": [pipe(axis, 1, "4/5") for axis in ((2, -1, -1), (-1, 2, -1), (-1, -1, 2))],
    "cross": [pipe(axis, 1, 2) for axis in (X, BACK[0], Y, BACK[1])],
    "tetrahedral": [pipe(axis, "1/2", 1) for axis in TETRAHEDRAL],
    "three skew": [pipe((3, 1, 1), 1, "3/4"), pipe((-1, 4, 1), "4/5", "3/5"), pipe((1, -2, 5), "6/5", "1/2")],
    "off centre": [pipe(X, "1/3", 1, (0, "1/20", "-1/30")), pipe(Y, "1/4", 1), pipe(Z, "2/5", 1)],
    "six-way": [pipe(axis, 1, 2) for pair in zip((X, Y, Z), BACK, strict=True) for axis in pair],
}

DIMENSIONS = {
    # node: dimensions at GC^1 degree 4 and GC^2 degree 5 on the first layout of the ladder
    "elbow": (24, 23),
    "unequal at 120 degrees": (41, 34),
    "T": (35, 24),
    "Y": (26, 16),
    "cross": (31, 18),
    "tetrahedral": (29, 9),
    "three skew": (25, 7),
    "off centre": (25, 7),
}

CENTERS = {
    # a bend's centre lies in the bend, by its clips and the smaller radius; that of other nodes where their lines meet
    "right bend": (NODES["elbow"], ("17/64", "17/64", 0)),
    "shorter": ([pipe(X, 1, "3/2"), pipe(Y, 1, "3/2")], ("13/64", "13/64", 0)),
    "unequal": ([pipe(X, 1, 2), pipe(Y, "1/2", 2)], ("17/128", "17/128", 0)),
    "elsewhere": ([pipe(X, 1, 2, (0, 3, 1)), pipe(Y, 1, 5, (0, 0, 1))], ("17/64", "209/64", 1)),
    "obtuse": ([pipe(X, 1, 2), pipe((-4, 7, 0), 1, "1/4")], ("1/8", "13/64", 0)),
    "no room in the bend": ([pipe(X, 1, 2), pipe((4, 7, 0), 1, "1/4")], (0, 0, 0)),
    "in one line": ([pipe(X, 1, 2), pipe(BACK[0], "1/2", 2)], (0, 0, 0)),
    "T": (NODES["T"], (0, 0, 0)),
    "three skew": (NODES["three skew"], (0, 0, 0)),
}


@pytest.mark.parametrize("name", CENTERS)
def test_where_the_centre_is(name):
    items, center = CENTERS[name]
    assert ContactNode.of([as_contact(item) for item in items]).center == tuple(map(rational, center))


WAYS = [(1, 4, 13, 10), (2, 5, 28, 10), (2, 6, 34, 20), (2, 7, 40, 35)]


def lunes(number):
    """Half-planes around the z axis through whole vectors, no two of which are opposite."""
    rays = [(5, 1), (1, 3), (-3, 4), (-7, -2), (-2, -5), (3, -7), (4, -1)][:number]
    return Layout(
        [Z, BACK[2], *((x, y, 0) for x, y in rays)], [(0, 2 + i, 1, 2 + (i + 1) % number) for i in range(number)]
    )


@pytest.mark.parametrize("number", [5, 6, 7])
@pytest.mark.parametrize(("order", "degree", "constant", "each"), WAYS)
def test_fans_have_the_dimensions_of_their_formula(number, order, degree, constant, each):
    layout = lunes(number)
    found = sum(splines(layout, order, d)[0].nrows() for d in range(degree + 1))
    assert found == constant + each * number


@pytest.mark.parametrize("order", [1, 2])
def test_homogeneous_splines_are_as_many_as_the_rank_in_floating_point_says(order):
    layout, degree = lunes(5), 4
    exponents = [(i, j, degree - i - j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    rows = []
    random = np.random.default_rng(0)
    for arc in layout.arcs:
        a, b = (np.array(layout.rays[i], float) for i in (arc.start, arc.end))
        normal = np.cross(a, b)
        points = random.random((40, 1)) * a + random.random((40, 1)) * b
        for times in range(order + 1):
            values = directional(points, normal / np.linalg.norm(normal), exponents, times)
            row = np.zeros((40, len(layout.pieces), len(exponents)))
            row[:, arc.first], row[:, arc.second] = values, -values
            rows.append(row.reshape(40, -1))
    matrix = np.concatenate(rows)
    rank = np.linalg.matrix_rank(matrix / np.linalg.norm(matrix, axis=1, keepdims=True).clip(1e-12))
    assert splines(layout, order, degree)[0].nrows() == matrix.shape[1] - rank


def directional(points, direction, exponents, times):
    """The derivatives of all monomials along a direction, by the coefficients in the step: (N, monomials)."""
    steps = np.linspace(-1, 1, 5)
    table = [
        np.stack([np.prod((points + t * direction) ** np.array(e), axis=1) for e in exponents], axis=1) for t in steps
    ]
    coefficients = np.polynomial.polynomial.polyfit(steps, np.stack(table).reshape(5, -1), 4)
    return coefficients[times].reshape(len(points), -1)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", DIMENSIONS)
def test_named_nodes_have_their_dimensions(name):
    placed = place(NODES[name], 1, "fan")
    for order, degree, dimension in zip((1, 2), (4, 5), DIMENSIONS[name], strict=True):
        assert pas.solutions(NODES[name], order, degree, placed.partition).dimension == dimension


@pytest.mark.parametrize(("name", "bounds"), [("three skew", 2), ("off centre", 2), ("elbow", 1), ("cross", 0)])
def test_unknowns_less_equations_are_a_bound_and_sharp_where_no_equation_repeats(name, bounds):
    placed = place(NODES[name], 1, "fan")
    found = [
        (fewest_members(PlacedContacts(placed.partition, placed.contacts, order), degree), dimension)
        for order, degree, dimension in zip((1, 2), (4, 5), DIMENSIONS[name], strict=True)
    ]
    assert all(0 <= bound <= dimension for bound, dimension in found)
    assert sum(bound == dimension for bound, dimension in found) >= bounds, found


def test_a_third_half_plane_in_each_gap_adds_thirty():
    six = pas.solutions(NODES["three skew"], 2, 5, "fan")
    nine = list(placements(with_ends(NODES["three skew"], 2, "fan"), 2, "fan"))[-1]
    assert len(nine.partition.pieces) == 9
    assert (six.dimension, pas.solutions(NODES["three skew"], 2, 5, nine.partition).dimension) == (7, 37)


def test_a_region_on_more_cells_has_the_space_of_its_layout():
    # the net of B-coefficients on all cells of the region is another construction
    placed = place(NODES["elbow"], 1, "fan")
    assert Net(placed, 4).solve()[0].nrows() == pas.solutions(NODES["elbow"], 1, 4, placed.partition).dimension


@pytest.mark.parametrize("kind", LAYOUTS)
def test_the_layout_of_a_region_is_the_one_it_was_built_on(kind):
    node = ContactNode.of(
        [as_contact(p) for p in {"strips": five(), "fan": NODES["cross"], "planes": diagonals()}[kind]]
    )
    layout = LAYOUTS[kind].trials[1][0].make(node.discs, node.center)
    found = region(layout, node.discs).layout
    assert {arcs(layout, p) for p in range(len(layout.pieces))} == {arcs(found, p) for p in range(len(found.pieces))}
    assert found.name == layout.name


@pytest.mark.parametrize("order", [1, 2, 3, 8])
@pytest.mark.parametrize("kind", LAYOUTS)
@pytest.mark.sampled(3)
def test_a_kind_that_is_asked_for_has_a_region_at_any_order_or_a_sentence(kind, order):
    for contacts in (five(), NODES["six-way"], NODES["elbow"]):
        try:
            placed = place(contacts, order, kind)
        except pas.GeometryError as error:
            assert len(str(error)) > 20
        else:
            assert placed.partition.title == place(contacts, min(order, 2), kind).partition.title
    if kind == "strips":
        assert place(five(), order, kind).partition.title.startswith("strips")


@pytest.mark.slow
def test_strips_have_a_surface_of_order_2():
    items = [((1, 0, 0), 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")]
    blend = pas.node(items, 2, partition="strips", degree=6, energy=pas.ThinPlate())
    assert blend.certificate.proved and blend.surface.partition.title == "strips between 3 contacts and 1 empty site"


def five():
    """Five pipes in directions that have a layout of strips."""
    return [pipe(axis, "1/2", clip) for axis, clip in zip(FIVE, ("3/4", "3/4", "1/2", "3/4", "1/2"), strict=True)]


def diagonals():
    """Eight pipes along the diagonals of a cube, which the planes of the first orbit keep apart."""
    return [pipe(axis, "1/2", 1) for axis in product((1, -1), repeat=3)]


def arcs(layout, piece):
    """A piece by its rays, wherever one begins to go round it."""
    rays = [layout.rays[i] for i in layout.pieces[piece]]
    start = rays.index(min(rays))
    return tuple(rays[start:] + rays[:start])


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", ["elbow", "unequal at 120 degrees", "T", "Y", "off centre"])
def test_nodes_are_proved_and_fair(name):
    blend = pas.blend(NODES[name], 1)
    assert blend.certificate.proved
    assert blend.surface.degree == 4
    assert blend.fairness.beyond(blend.limits) == ()
    assert "fan of" in str(blend)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", NODES)
def test_all_named_nodes_are_proved_and_fair(name, order):
    blend = pas.blend(NODES[name], order)
    assert blend.certificate.proved
    assert blend.fairness.beyond(blend.limits) == ()


@pytest.mark.slow
def test_the_six_way_node_has_full_planes_and_is_symmetric():
    blend = pas.blend(NODES["six-way"], 2, 6, wishes=pas.Wishes(energy=pas.ThinPlate()))
    assert (blend.surface.partition.title, len(blend.surface.patches), blend.dimension) == ("4 planes", 14, 18)
    assert blend.certificate.proved
    mesh = blend.mesh(1e-2)
    assert mesh.euler_characteristic == 2 - 6


def test_a_node_is_a_solid_and_a_file(tmp_path):
    blend = pas.blend(NODES["unequal at 120 degrees"], 1, wishes=pas.Wishes(energy=pas.ThinPlate()))
    again = pas.load(blend.save(tmp_path / "node.pas.json"))
    assert again.surface.polynomials == blend.surface.polynomials
    assert again.surface.partition.title == blend.surface.partition.title
    assert again.space.dimension == blend.dimension
    assert again.certificate.proved
    assert again.attempts == blend.attempts
    solid = blend.solid("1/2")
    assert solid.certificate.proved
    assert np.ptp(solid.box, axis=0).max() < 8  # the region's cells bound it, in any direction


def test_the_mesh_of_a_node_ends_on_its_contacts():
    # planes of other walls pass through the circles
    blend = pas.blend([pipe(X, "1/2", 1), pipe((-1, 1, 0), "1/2", 1)], 1, wishes=pas.Wishes(energy=pas.ThinPlate()))
    mesh = blend.mesh()
    ends = mesh.points[mesh.boundary]
    off = np.min([np.maximum(abs(c.surface(ends)), abs(c.clip(ends))) for c in blend.surface.contacts], axis=0)
    assert off.max() < 1e-9


def test_a_users_own_layout_serves():
    layout = Layout(
        [*(X, Y, Z), *BACK], [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    )
    tilted = [pipe((1, 1, 1), "2/5", 1), pipe((-1, -1, 1), "2/5", 1)]
    found = pas.solutions(tilted, 1, 4, layout)
    assert found.dimension > 0
    assert found.partition.layout is not None
    assert Layout.from_record(layout.to_record()) == layout


OCTANTS = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
"""The pieces between the rays X, Y, Z, -X, -Y, -Z."""

TWO_PIPES = """order = 1
[[pipes]]
axis = [1, 1, 1]
radius = "2/5"
clip = 1
[[pipes]]
axis = [-1, -1, 1]
radius = "2/5"
clip = 1
[partition]
"""


def test_layouts_in_problem_files(tmp_path):
    path = tmp_path / "node.toml"
    rays = [[*axis] for axis in (X, Y, Z, *BACK)]
    pieces = [[*piece] for piece in OCTANTS]
    for table in ('kind = "fan"', f'kind = "layout"\nrays = {rays}\npieces = {pieces}'):
        path.write_text(f"{TWO_PIPES}{table}\n")
        assert read_problem(path) is not None
    for table, words in (
        ('kind = "fans"', "there is no partition 'fans'"),
        ('kind = "fan"\ncenter = [0, 0, 0]', "'center' does not belong to the layout 'fan'"),
        ('kind = "layout"\nrays = [[1, 0, 0]]', "the partition 'layout' needs 'pieces'"),
        ('kind = "layout"\nray = [[1, 0, 0]]', "is 'rays' meant"),
    ):
        path.write_text(f"{TWO_PIPES}{table}\n")
        with pytest.raises(pas.ProblemFileError, match=words):
            read_problem(path)


@pytest.mark.parametrize(
    ("rays", "pieces", "words"),
    [
        ([X, Y, Z], [], "a layout needs pieces"),
        ([], [], "a layout needs pieces"),
        ([X, Y, Z, (-1, -1, -1)], [(0, 1, 2), (1, 0, 3), (2, 1, 3)], "has no piece on its other side"),
        ([X, Y, Z, (-1, -1, -1)], [(0, 2, 1), (1, 3, 0), (2, 3, 1), (0, 3, 2)], "counterclockwise"),
        ([X, BACK[0], Y, Z], [(0, 1, 2), (1, 0, 3)], "rays 0 and 1 lie on one line through the centre"),
        ([X, Y, Z, (-1, -1, -1)], [(0, 1), (1, 0, 3)], r"pieces\[0\] must be at least three numbers of rays"),
        ([X, Y, Z, (-1, -1, -1)], [(0, 1, 7)], "different numbers of rays below 4"),
        ([X, Y, Z, (0, 0, 0)], [(0, 1, 2)], r"rays\[3\] must not be the zero vector"),
        ([X, Y, Z, (2, 0, 0)], [(0, 1, 2)], r"rays\[3\] has the direction of rays\[0\]"),
        ([X, Y, Z, (-1, -1, -1)], [(0, 1, 2), (0, 1, 2)], "lie on the same side of the arc"),
    ],
)
def test_layouts_that_are_none(rays, pieces, words):
    with pytest.raises((pas.GeometryError, ValueError), match=words):
        Layout(rays, pieces)


def test_a_layout_may_not_go_round_twice():
    rays = [Z, BACK[2], X, Y, BACK[0], BACK[1]]
    twice = [(0, 2, 1, 3), (0, 3, 1, 4), (0, 4, 1, 5), (0, 5, 1, 2)]
    assert len(Layout(rays, twice).arcs) == 8
    # seven lunes of two sevenths of a turn each go round twice, and every arc has a piece on either side
    turned = [(round(100 * np.cos(4 * np.pi * i / 7)), round(100 * np.sin(4 * np.pi * i / 7)), 0) for i in range(7)]
    with pytest.raises(pas.GeometryError, match="cover all directions once; they do 2 times"):
        Layout([Z, BACK[2], *turned], [(0, 2 + i, 1, 2 + (i + 1) % 7) for i in range(7)])


@pytest.mark.parametrize(
    ("items", "words"),
    [
        ([pipe(X, 1, 2)], "joins two contacts or more, and here is one"),
        ([], "here are none"),
        ([pipe(X, 1, 2), pipe(X, 1, 2)], "contacts 1 and 2 end in the same curve"),
        ([pipe(X, 1, 2), pipe(X, 1, 2, (0, 5, 0))], "contacts 1 and 2 end in the same plane"),
        (
            [pipe(X, 1, 2), pipe((4, 1, 0), 1, "1/2")],
            r"contacts 1 and 2 are seen 14 degrees apart.*clips at distances of",
        ),
        (
            [pipe(X, 1, 2), ("1 - x^2 - z^2", "y - 2"), pipe(Z, 1, 2)],
            r"contact 2: the surface .* is positive inside its curve",
        ),
        ([pipe(X, 1, 2), ("x^2 - z^2 - 1", "y - 2")], "contact 2: .* not closed"),
        ([pipe(X, 1, 2), ("x^2 + z^2 + 1", "y - 2")], "contact 2: .* no real point"),
        ([pipe(Z, 1, 2), pas.Plate(Z, 2), pas.Plate(X, 2)], "joins one plate and other contacts, and here are 2 and 1"),
    ],
)
def test_nodes_that_cannot_be(items, words):
    with pytest.raises(pas.GeometryError, match=words):
        pas.blend(items, 1)


def test_the_distance_that_is_said_to_work_works():
    close = [pipe(X, 1, 2), pipe((2, 2, 1), 1, "2/3")]
    with pytest.raises(pas.GeometryError, match="clips at distances of at least") as failure:
        pas.blend(close, 1)
    words = str(failure.value).split("at least ")[1].split()
    first, second = float(words[0]), float(words[2])
    far = [pipe(X, 1, 1.05 * first), pipe((2, 2, 1), 1, 1.05 * second / 3)]
    assert pas.blend(far, 1, wishes=pas.Wishes(energy=pas.ThinPlate())).certificate.proved


def test_names_of_layouts():
    assert tuple(LAYOUTS) == ("planes", "fan", "strips")
    with pytest.raises(ValueError, match=r"there is no partition 'fans'.*'fan'"):
        pas.blend(NODES["T"], 1, partition="fans")
    with pytest.raises(TypeError, match=r"partition must be a pas\.Partition"):
        pas.blend(NODES["T"], 1, partition=3)
    with pytest.raises(pas.GeometryError, match="full planes serve 4 contacts or more"):
        pas.blend(NODES["T"], 1, partition="planes")


def test_arrangements_of_planes_cover_the_sphere():
    for normals in (
        [X, Y, Z],
        [(1, 1, 1), (1, -1, 1), (-1, 1, 1), (-1, -1, 1)],
        [(1, 2, 3), (3, -1, 1), (-1, 1, 2), (2, 2, -1)],
    ):
        layout = arrangement(normals, (0, 0, 0))
        count = len(normals)
        assert len(layout.pieces) == count * (count - 1) + 2
    with pytest.raises(pas.GeometryError, match="three planes at least"):
        arrangement([X, Y, (1, 1, 0)], (0, 0, 0))


def test_determinants_of_rays():
    for a, b in combinations([X, (1, 2, 3), (-4, 1, 0)], 2):
        assert determinant(a, b, cross(a, b)) == np.linalg.det([a, b, np.cross(a, b)]).round()


def test_struts_have_clips_where_a_blend_has_room():
    free = pas.struts([(X, 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], 2)
    node = ContactNode.of([as_contact(p) for p in free])
    for a, b in combinations(node.discs, 2):
        assert a.angle + b.angle <= 0.6 * np.arccos(np.clip(a.direction @ b.direction, -1, 1)) + 1e-9
    given = pas.struts([(X, 1, 5), ((-1, 2, 0), 1), ((0, -1, 3), "3/4", "7/2")], 2)
    assert [str(p.clip) for p in (given[0], given[2])] == ["5", "7/2"]
    assert given[1].clip <= free[1].clip
    moved = pas.struts([(X, 1), ((-1, 2, 0), 1)], 1, center=(1, 2, "1/3"))
    assert [str(p.point[2]) for p in moved] == ["1/3", "1/3"]


def test_pictures_of_layouts_with_the_curves_of_contacts(tmp_path, monkeypatch):
    placed = place(NODES["three skew"], 1)
    layout, contacts = placed.partition.layout, placed.contacts
    with_discs = layout.picture(tmp_path / "a.png", contacts, size=(160, 120))
    without = layout.picture(tmp_path / "b.png", size=(160, 120))
    drawn = pas.draw(layout, tmp_path / "c.png", size=(160, 120))
    assert without.read_bytes() == drawn.read_bytes() != with_discs.read_bytes()
    with pytest.raises(pas.GeometryError, match="fits in no piece of the layout"):
        lunes(5).picture(tmp_path / "d.png", [pipe(Z, 1, 2)])
    with pytest.raises(ValueError, match=r"\.png"):
        layout.picture(tmp_path / "d.jpg")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    with pytest.raises(pas.MissingLibraryError, match="a window needs a screen"):
        layout.picture()


def test_the_sphere_of_a_layout_has_its_pieces_as_faces():
    layout = lunes(7)
    mesh = layout.mesh(1e-3)
    assert mesh.is_closed
    assert mesh.euler_characteristic == 2
    assert mesh.volume == pytest.approx(4 / 3 * np.pi, rel=3e-3)
    # the areas of lunes are those of their angles
    turned = np.unwrap([np.arctan2(y, x) for x, y, _ in [*layout.rays[2:], layout.rays[2]]])
    assert list(mesh.face_areas.values()) == pytest.approx(2 * np.diff(turned), rel=3e-3)
    for size in (5, 7):
        found = colors(lunes(size))
        assert all(found[arc.first] != found[arc.second] for arc in lunes(size).arcs)


def test_a_node_in_one_line():
    blend = pas.node([(X, 1), ((-1, 2, 0), 1), ((0, -1, 3), "3/4")], 1, energy=pas.ThinPlate())
    assert blend.certificate.proved
    assert len(blend.surface.contacts) == 3


@pytest.mark.parametrize(
    ("items", "error", "words"),
    [
        ([(X, 1)], ValueError, "two struts or more, not 1"),
        ("struts", TypeError, r"pairs \(direction, radius\)"),
        ([(X, 1), X], TypeError, r"direction of struts\[1\] must be three numbers"),
        ([(X, 1), (Y,)], TypeError, r"struts\[1\] must be \(direction, radius\)"),
        ([(X, 1), (Y, -1)], ValueError, "radius must be positive"),
        ([(X, 1), ((0, 0, 0), 1)], ValueError, "zero vector"),
        (
            [(X, 1), ((20, 1, 0), 1)],
            pas.GeometryError,
            "directions 1 and 2 are 2.86 degrees apart; at least 10 are needed",
        ),
    ],
)
def test_struts_that_cannot_be(items, error, words):
    with pytest.raises(error, match=words):
        pas.struts(items, 1)


def test_no_wall_lies_in_a_clip_plane():
    # here the end of a ray, rounded, would lie exactly in the second clip plane, beside the clip face
    pipes = [pas.Pipe((-6, 4, 3), 2, "21/64"), pas.Pipe((0, -1, -3), "11/10", "3/4")]
    blend = pas.blend(pipes, 1)
    assert blend.certificate.proved
    assert blend.surface.partition.title.startswith("fan")
    assert not blend.fairness.beyond(blend.limits)
    # and wherever a plane lies: its height is made that of the end, which then goes on
    node = ContactNode.of([as_contact(p) for p in pipes])
    layout = LAYOUTS["fan"].trials[1][0].make(node.discs, node.center)
    for ray in layout.rays:
        first, second = node.discs
        end = Builder(layout, node.discs, WALLS).end(ray)
        met = replace(second, height=dot(second.normal, end))
        moved = Builder(layout, (first, met), WALLS).end(ray)
        assert moved != end
        assert dot(met.normal, moved) != met.height


def test_walls_go_round_a_run_behind_two_branches_side_by_side():
    """The flat walls between far rays cut into it, down to 0.87 of its radius."""
    tubes = [(Y, 20), (BACK[1], 20), (("-0.292", 0, "0.956"), "14.3"), (("0.777", 0, "0.629"), "15.9")]
    node = ContactNode.of(list(map(as_contact, pas.struts(tubes, 1))))
    turns = np.radians(np.arange(180, 361, 5))
    behind = 21.9 * np.stack([np.cos(turns), 0 * turns, np.sin(turns)], axis=1)
    for order in (1, 2):
        for part in node.regions(order, "fan"):
            assert (part.locate(behind) >= 0).all()
