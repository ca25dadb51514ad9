"""Certificates of meshes: proved where a mesh is the surface, never where it is not, and where it cannot be known."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from conftest import EQUAL, UNEQUAL, solved

import pas
from pas.blending.place import place
from pas.certify.graph_proofs import crossed
from pas.certify.mesh_proofs import _grouped
from pas.certify.triangle_forms import ELEVATED, TriangleForms, elevation, lattice
from pas.mesh.shading import unit_rows
from pas.verdicts import Status

TORUS = "(x^2 + y^2 + z^2 + 8/9)^2 - 4*(x^2 + y^2)"
BALLS = "((x - {0})^2 + y^2 + z^2 - 1/4)*((x + {0})^2 + y^2 + z^2 - 1/4)"


def boxed(text, size=1.0, tolerance=1e-2):
    """The mesh of a polynomial's zeros in a box around 0 that has no symmetry."""
    lower, upper = (-1.25, -1.375, -1.4375), (1, 1.0625, 1.125)
    return pas.Polynomial(text).surface([size * v for v in lower], [size * v for v in upper]).mesh(tolerance)


@cache
def torus():
    """A mesh of a torus."""
    return boxed(TORUS, 2, 2e-2)


def topology(certificate):
    """The verdict on it."""
    return next(v for v in certificate.verdicts if v.claim == "the topology of the surface")


@pytest.mark.parametrize(
    ("text", "size", "euler", "components"),
    [
        (TORUS, 2, 0, 1),
        (BALLS.format("3/5"), 2, 4, 2),
        ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5", 3, -8, 1),
        ("x^2 + 2*y^2 - z^2 - 1/4 + x/7", 1, 0, 1),
        ("x^2 - y^2 - z/3", 1, 1, 1),
        ("x + y/2 + z/3 - 1/7", 1, 1, 1),
        ("x^2 + y^2 - 1/4", 1, 0, 1),
        ("1e-12*(x^2 + y^2 + z^2 - 1/2)", 1, 2, 1),
        ("1e12*(x^2 + y^2 + z^2 - 1/2)", 1, 2, 1),
        ("z*(x^2 + y^2 + z^2 - 9/4) + 1/10", 2, None, 2),
    ],
)
@pytest.mark.sampled(2)
def test_meshes_in_boxes_are_proved(text, size, euler, components):
    mesh = boxed(text, size, 2e-3 * size)
    certificate = mesh.certificate
    assert topology(certificate).proved, str(certificate)
    assert certificate.holds
    assert certificate.places == ()
    assert mesh.components == components
    assert euler is None or mesh.euler_characteristic == euler
    assert mesh.deviation * 0.99 <= certificate.distance <= 3 * 2e-3 * size
    assert "rises across all" in str(certificate)


@pytest.mark.parametrize("radii", [EQUAL, UNEQUAL])
def test_meshes_of_several_pieces_are_proved(radii):
    mesh = solved(radii, 2).surface.mesh(2e-3)
    assert topology(mesh.certificate).proved, str(mesh.certificate)
    assert mesh.certificate.distance < 6e-3


def struts(*ends):
    """The node of bars from 0 to some ends."""
    return pas.blend(pas.struts([(end, 1) for end in ends], 2), 2).surface


def proved_near(surface):
    """Coarse and fine meshes are proved, within little more than their tolerance."""
    longest = float(np.ptp(surface.partition.points, axis=0).max())
    for share, most in ((1e-2, 2.5), (1e-3, 1.5)):
        mesh = surface.mesh(share * longest)
        assert topology(mesh.certificate).proved, str(mesh.certificate)
        assert mesh.certificate.holds
        assert mesh.deviation * 0.99 <= mesh.certificate.distance <= most * share * longest


def test_meshes_of_nodes_of_struts_are_proved():
    proved_near(struts((1, 0, 0), (-1, 0, 0), (0, 1, 0)))


@pytest.mark.slow
def test_meshes_of_larger_nodes_are_proved():
    ends = [tuple(sign * int(i == k) for k in range(3)) for i in range(3) for sign in (1, -1)]
    proved_near(struts(*ends))


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("size", "most"), [(0.02, 1.25), (0.2, 1.25), (1.0, 1.5)])
def test_every_piece_that_a_triangle_touches_is_seen_and_few_others(size, most):
    """Points of triangles and the cells that they are in; triangles whose corners are on faces between cells, too."""
    ends = (1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)
    partition = place(pas.struts([(end, 1) for end in ends], 2), 2).partition
    patches = ["x^2 + y^2 + z^2 - 1"] * len(partition.pieces)  # cells alone matter
    local = pas.PiecewiseSurface.from_polynomials(partition, (), 1, patches).framed
    rng = np.random.default_rng(38)
    inside = rng.dirichlet(np.ones(4), 100)
    inside[:50, rng.integers(0, 4)] = 0  # on faces
    inside /= inside.sum(axis=1, keepdims=True)
    first = np.einsum("ni,nij->nj", inside, local.corners[rng.integers(0, len(local.corners), 100)])
    triangles = first[:, None] + size * rng.uniform(-1, 1, (100, 3, 3)) * [[[0.0], [1.0], [1.0]]]
    weights = rng.dirichlet(np.full(3, 0.5), 200)
    points = np.concatenate([triangles, np.einsum("wi,nij->nwj", weights, triangles)], axis=1)
    within = (local.cells.barycentric(points.reshape(-1, 3)) >= -1e-12).all(axis=1).reshape(-1, *points.shape[:2])
    counts = np.zeros(2)
    for piece, cells in enumerate(local.cells.pieces):
        met = within[list(cells)].any(axis=(0, 2))
        seen = np.isin(np.arange(100), local.touched(triangles)[piece])
        assert not (met & ~seen).any()
        counts += [met.sum(), seen.sum()]
    assert counts[1] < most * counts[0]  # 1.6, 1.6 and 2.0 without planes through the centre


@pytest.mark.slow
def test_triangles_that_fold_are_made_finer():
    surface = struts((-1, -3, 1), (2, 1, -1), (3, 0, -1))
    mesh = surface.mesh(1e-2 * float(np.ptp(surface.partition.points, axis=0).max()))
    assert mesh.is_manifold
    assert mesh.euler_characteristic == -1


def test_the_distance_is_not_below_what_is_measured():
    mesh = torus()
    rng = np.random.default_rng(1)
    weights = rng.dirichlet(np.ones(3), len(mesh.triangles))
    points = np.einsum("tk,tkx->tx", weights, mesh.points[mesh.triangles])
    ring = np.hypot(points[:, 0], points[:, 1]) - 1
    assert np.abs(np.hypot(ring, points[:, 2]) - 1 / 3).max() <= mesh.certificate.distance


def without_one(mesh):
    """A triangle removed."""
    return replace(mesh, triangles=mesh.triangles[1:])


def moved_off(mesh):
    """A vertex moved off the surface."""
    points = mesh.points.copy()
    points[7] += 0.03 * mesh.point_normals[7]
    return replace(mesh, points=points)


def moved_across(mesh):
    """A vertex moved over its neighbours."""
    points = mesh.points.copy()
    points[mesh.triangles[0, 0]] = 2 * points[mesh.triangles[0, 1]] - points[mesh.triangles[0, 0]]
    return replace(mesh, points=points)


def doubled(mesh):
    """The same sheet twice."""
    size = len(mesh.points)
    return replace(
        mesh, points=np.tile(mesh.points, (2, 1)), triangles=np.concatenate([mesh.triangles, mesh.triangles + size])
    )


def turned(mesh):
    """Inside out."""
    return replace(mesh, triangles=mesh.triangles[:, ::-1])


@pytest.mark.parametrize("mutate", [without_one, moved_off, moved_across, doubled, turned])
def test_mutated_meshes_get_no_certificate(mutate):
    assert torus().certificate.holds
    wrong = mutate(torus()).certificate
    assert not wrong.holds or not topology(wrong).proved
    assert not (topology(wrong).proved and wrong.distance is not None and wrong.distance < 2e-2 * 1.5)


def octants(center):
    """The unit sphere in an octahedron, whose eight cells have a common corner."""
    corners = [center, (2, 0, 0), (0, 2, 0), (0, 0, 2), (-2, 0, 0), (0, -2, 0), (0, 0, -2)]
    cells = [(0, 1 + a, 2 + b, 3 + c) for a in (0, 3) for b in (0, 3) for c in (0, 3)]
    partition = pas.Partition(corners, cells, center)
    return pas.PiecewiseSurface.from_polynomials(partition, (), 1, ["x^2 + y^2 + z^2 - 1"] * 8)


def test_the_distance_is_bounded_where_the_centre_is_close_to_a_wall():
    assert octants(("1997/3000",) * 3).mesh(5e-2).certificate.distance < 6e-2


def test_what_is_outside_the_region_is_no_distance_from_the_surface():
    """A small octahedron beyond the middle of a wall, where the pieces have no value however far they go on."""
    surface = octants((0, 0, 0))
    mesh = surface.mesh(5e-2)
    points = np.concatenate([mesh.points, 2.4 + 0.1 * np.array([*np.eye(3), *-np.eye(3)])])
    more = np.array(surface.partition.cells)[:, 1:] - 1 + len(mesh.points)
    more[[1, 2, 4, 7]] = more[[1, 2, 4, 7], ::-1]
    found = surface.certify_mesh(points, np.concatenate([mesh.triangles, more]))
    assert mesh.certificate.distance < 6e-2 and found.distance is None


SHARP = [
    ((-723, 204, -44), "3/16"),
    ((-450, 222, 249), "17/64"),
    ((559, -441, -149), "13/64"),
    ((583, -66, -208), "15/64"),
]
"""Struts of a foam around a node, and where they begin, which leave edges that are 100 times as sharp as what is beside
them at the lowest degree."""


def test_a_mesh_of_a_sharp_node_is_proved_along_rays():
    """Some triangles beside its edges look away from the gradient, and normals lead through the edges."""
    radius = Fraction(4096, 177)
    surface = pas.blend([pas.Pipe(axis, radius, clip) for axis, clip in SHARP], 1, "lowest").surface
    certificate = surface.mesh(0.03 * radius).certificate
    assert "are seen once from the centre" in topology(certificate).reason
    assert topology(certificate).proved and certificate.distance < 4 * 0.03 * radius


def spiked(surface, mesh):
    """A vertex moved along the ray to the centre, so that triangles around it look away from the gradient."""
    points = mesh.points.copy()
    inner = np.setdiff1d(np.arange(len(points)), mesh.boundary)
    vertex = inner[np.argmin((unit_rows(points[inner]) * mesh.point_normals[inner]).sum(axis=1))]
    points[vertex] *= 0.7
    return surface.certify_mesh(points, mesh.triangles)


def test_what_is_seen_once_has_the_topology_of_graphs_alone():
    """Not of a surface that is torn along faces, nor where contacts' curves may be several."""
    corner = solved(EQUAL, 1).surface
    mesh = corner.mesh(2e-2)
    assert "are seen once" in topology(spiked(corner, mesh)).reason and topology(spiked(corner, mesh)).proved
    first, *others = corner.polynomials
    clips = [contact.clip for contact in corner.contacts]
    added = first + pas.Polynomial("1/1000") * (clips[0] * clips[1] * clips[2]) ** 2
    torn = pas.PiecewiseSurface.from_polynomials(corner.partition, corner.contacts, 1, [added, *others])
    assert torn.certificate.one_sheet.proved and torn.certificate.enclosed.proved
    assert not topology(torn.certify_mesh(mesh.points, mesh.triangles)).proved
    for power, proved in ((2, True), (4, False)):
        tube = f"y^{power} + z^{power} - 1/16"
        ends = [pas.Contact(tube, "x - 2"), pas.Contact(tube, "-x - 2")]
        box = pas.SingleCell((-2, -1, -1), (2, 1, 1))
        surface = pas.PiecewiseSurface.from_polynomials(box, ends, 1, [tube])
        assert surface.certificate.proved
        assert topology(spiked(surface, surface.mesh(2e-2))).proved is proved


def test_a_component_that_is_missing_is_found():
    mesh = boxed(BALLS.format("3/5"), 2, 1e-2)
    left = (mesh.points[mesh.triangles][:, :, 0] < 0).all(axis=1)
    found = topology(replace(mesh, triangles=mesh.triangles[left]).certificate)
    assert found.status is Status.UNDECIDED and "a component is missing" in found.reason
    assert found.witness is not None
    assert found.witness[0] > 0.1


@pytest.mark.slow
def test_a_coarse_mesh_that_passes_by_a_place_of_rest_is_not_refuted():
    """At 1e-2 one place next to the surface is on the wrong side, and the topology is that of finer meshes, proved."""
    struts = [((-2, 0, -2), 1), ((2, 0, -3), 1), ((-2, 1, 0), 1), ((-1, -2, -3), 1)]
    surface = pas.blend(pas.struts(struts, 2), 2).surface
    size = float(np.ptp(surface.partition.points, axis=0).max())
    coarse, fine = (surface.mesh(share * size) for share in (1e-2, 1e-3))
    assert topology(fine.certificate).proved
    assert (coarse.components, coarse.euler_characteristic) == (fine.components, fine.euler_characteristic) == (1, -2)
    assert topology(coarse.certificate).status in (Status.PROVED, Status.UNDECIDED)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("text", "place"),
    [
        (BALLS.format("2000001/4000000"), (0, 0, 0)),  # 1e-6 apart
        ("(x^2 + y^2 + z^2 - 1/4)*((x - 3/4)^2 + (y - 1/7)^2 + z^2 - 1/10^8)", (3 / 4, 1 / 7, 0)),  # a bubble
        ("x^3 - y^2 - z^2", (0, 0, 0)),
        ("x^2 + y^2 - z^2", (0, 0, 0)),
        ("x^2 + y^2 - z^2 - 1/10^8", (0, 0, 0)),  # a thin neck
        ("x^2 + y^2 - z^2 + 1/10^8", (0, 0, 0)),  # two caps
        ("(z + 1)^2 - x^2 - y^2 - 1/9", (0, 0, -2 / 3)),
        ("(x - 1/2)^2 + y^2 + z^2 - 1/4", (1, 0, 0)),  # touches the wall
        ("x*y", None),
        ("x^2", None),
        ("(x + y/3)^2*(x^2 + y^2 + z^2 - 1/2)", None),
    ],
)
def test_what_is_singular_or_unseen_is_named_or_right(text, place):
    try:
        mesh = boxed(text)
    except pas.MeshError as error:
        assert "no good mesh" in str(error) or "does not change sign" in str(error)
        return
    found = topology(mesh.certificate)
    if place is None:
        assert not found.proved
        return
    if found.proved:
        return
    assert mesh.certificate.places
    off = np.linalg.norm(np.array(mesh.certificate.places) - place, axis=1)
    assert off.min() < 5e-2


def sums_of_balls(seed):
    """Products of spheres, and their number of components where none touch."""
    rng = np.random.default_rng(seed)
    centers = rng.integers(-12, 13, size=(int(rng.integers(1, 4)), 3)) / 16
    radii = rng.integers(1, 8, size=len(centers)) / 16
    text = "*".join(
        f"((x - {a})^2 + (y - {b})^2 + (z - {c})^2 - {r * r})".replace("- -", "+ ")
        for (a, b, c), r in zip(centers.tolist(), radii.tolist(), strict=True)
    )
    apart = all(
        not abs(radii[i] - radii[j]) - 1e-9 <= np.linalg.norm(centers[i] - centers[j]) <= radii[i] + radii[j] + 1e-9
        for i in range(len(centers))
        for j in range(i)
    )
    inside = bool((np.abs(centers) + radii[:, None] < 1).all())
    return text, len(centers) if apart and inside else None


def judge(seed):
    """Whether the mesh of a case was proved; a proof that is wrong fails."""
    text, components = sums_of_balls(seed)
    try:
        mesh = pas.Polynomial(text).surface((-1,) * 3, (1,) * 3).mesh(1e-2)
    except pas.MeshError:
        return False
    if not topology(mesh.certificate).proved:
        assert mesh.certificate.places
        return False
    if components is not None:
        assert (mesh.components, mesh.euler_characteristic) == (components, 2 * components), text
    return True


@pytest.mark.parametrize(("seeds", "least"), [((1, 3, 4, 5, 6, 7), 3), pytest.param((0, 2), 0, marks=pytest.mark.slow)])
def test_generated_cases_are_right_or_undecided(seeds, least):
    assert sum(judge(seed) for seed in seeds) >= least


@pytest.mark.slow
def test_many_generated_cases_are_right_or_undecided():
    assert sum(judge(seed) for seed in range(1000)) >= 400


@pytest.mark.parametrize("degree", range(1, 9))
def test_forms_on_triangles(degree):
    rng = np.random.default_rng(degree)
    f = pas.Polynomial("(x/3 + y/2 - z)*(x + 1/7)^2*(y*z - 2/5)^2*(x - y/9)")
    terms = {e: c for e, c in f.coefficients().items() if sum(e) <= degree} | {(1, 0, 0): 1}
    p = pas.Polynomial(terms)
    corners = rng.uniform(-1, 1, size=(5, 3, 3))
    maker = TriangleForms(p, degree, 1.0)
    places, inverse, _ = lattice(degree)
    forms = inverse @ p(np.einsum("ak,tkx->atx", places, corners))
    inner = np.einsum("ak,tkx->atx", rng.dirichlet(np.ones(3), 40), corners)
    assert maker.value_error < 1e-9
    assert (p(inner) <= forms.max(axis=0) + 1e-12).all()
    assert (p(inner) >= forms.min(axis=0) - 1e-12).all()
    low, high = maker.ranges(corners)
    assert low == pytest.approx(forms.min(axis=0), abs=1e-12)
    assert high == pytest.approx(forms.max(axis=0), abs=1e-12)
    raised = elevation(degree, ELEVATED * degree) @ forms
    nearer = maker.ranges(corners, closer=True)
    assert np.array(nearer) == pytest.approx(np.array([raised.min(axis=0), raised.max(axis=0)]), abs=1e-12)
    assert (nearer[0] >= low - 1e-12).all()
    assert (nearer[1] <= high + 1e-12).all()
    assert (p(inner) <= nearer[1] + 1e-12).all()
    normals = rng.normal(size=(5, 3))
    gradients = np.stack([p.diff(axis)(inner) for axis in range(3)], axis=-1)
    least, size = maker.slopes(corners, normals)
    slopes = maker.gradients(corners)
    assert least == pytest.approx(np.einsum("xkt,tx->kt", slopes, normals).min(axis=0), abs=1e-12)
    assert size == pytest.approx(np.linalg.norm(slopes, axis=0).max(axis=0), abs=1e-12)
    assert ((gradients * normals).sum(axis=-1) >= least - 1e-12).all()
    assert (np.linalg.norm(gradients, axis=-1) <= size + 1e-12).all()
    assert forms[0] == pytest.approx(p(corners[:, 0]), abs=1e-12)
    assert lattice(degree)[0].sum(axis=1) == pytest.approx(1)
    assert elevation(degree, degree + 2).sum(axis=1) == pytest.approx(1)


def test_crossings_are_counted_with_sign():
    mesh = torus()
    ends = np.array([[1.01, 0.02, 0.03], [0.01, 0.02, 0.03], [1.9, 0.1, 0.2], [-1.9, 0.1, 0.2]])
    times, known = crossed(mesh.points, mesh.triangles, np.array([0.013, 0.017, 0.5]), ends)
    assert known.all()
    assert times.tolist() == [-1, 0, 0, 0]
    on_the_mesh = mesh.points[mesh.triangles[3]].mean(axis=0)
    assert not crossed(mesh.points, mesh.triangles, np.array([0.013, 0.017, 0.5]), on_the_mesh[None])[1][0]


def test_simplices_with_common_corners_are_one_union():
    """A triangle, an edge of it and a point of that; a chain of two edges; the largest of each first."""
    a, b, c, d, e, f = np.eye(6)[:, :3] + np.arange(6)[:, None]
    points, edges = np.array([[b]]), np.array([[d, e], [e, e + 9], [a, b]])
    triangles = np.array([[a, b, c]])
    assert _grouped([points, edges, triangles]) == [[2, 1], [4, 3, 0]]
    assert _grouped([np.array([[a], [f]])]) == [[0], [1]]
