"""Networks of struts: exact classes of nodes, proved bodies, watertight meshes, files, and what is wrong with one."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import chain, combinations, pairwise, permutations, product
from types import SimpleNamespace

import manifold3d
import networkx
import numpy as np
import pytest
import trimesh
from conftest import ROOT

import pas
from pas import network, solid
from pas.algebra.rational import vector
from pas.cli import main
from pas.network import nodes, rings
from pas.network.blocks import status
from pas.network.classes import NodeKind, kinds_of, turn
from pas.network.clearance import clearance
from pas.network.covers import NodeCovers, Separation, _held, reach_of
from pas.network.near import nearest_points
from pas.network.nodes import placed_ends
from pas.network.overlaps import NodeSolid
from pas.network.part import NetworkPart
from pas.network.problems import nearest
from pas.settings import MeshSettings

BLOCKS = {
    ("cubic", 10): (1331, 3630, 2300),
    ("BCC", 8): (1241, 4096, 2856),
    ("octet", 6): (1099, 5616, 4518),
    ("Kelvin", 5): (1800, 3300, 1501),
    ("diamond", 5): (1162, 2000, 839),
}
"""Nodes, struts and genus of blocks of so many cells."""

CLASSES = {"cubic": (4, 27), "BCC": (4, 27), "octet": (4, 27), "Kelvin": (2, 30), "diamond": (3, 12)}
"""Classes and kinds of their nodes."""


@pytest.mark.parametrize(("name", "cells"), BLOCKS)
def test_blocks_of_lattices(name, cells):
    net = network.lattice(name, cells)
    nodes, struts, genus = BLOCKS[name, cells]
    assert (len(net.points), len(net.edges), net.pieces) == (nodes, struts, 1)
    assert struts - nodes + 1 == genus
    assert np.ptp(net.points, axis=0).tolist() == [cells] * 3
    assert np.ptp(net.lengths) < 1e-12
    found = kinds_of(net)
    assert (len(found.classes), len(found.kinds)) == CLASSES[name]
    assert sum(one.count for one in net.classes()) == nodes
    assert not net.check()


def test_symmetries_of_classes():
    found = {len(one.struts): one.symmetries for one in network.lattice("octet", 2).classes()}
    assert found == {12: 48, 8: 8, 5: 4, 3: 6}
    assert {len(c.struts): c.symmetries for c in network.lattice("BCC", 1).classes()} == {8: 48, 1: 0}


def drawn(seed, struts=5):
    """A node whose struts have random vectors, and the same node turned by a signed permutation, as two networks."""
    generator = np.random.default_rng(seed)
    vectors = generator.integers(-9, 10, (struts, 3))
    matrix = np.eye(3, dtype=int)[generator.permutation(3)] * generator.choice([-1, 1], 3)
    order = generator.permutation(struts)
    edges = np.stack([np.zeros(struts, dtype=int), np.arange(1, struts + 1)], axis=1)
    radii = generator.integers(1, 3, struts)
    first = network.Network(np.vstack([[0, 0, 0], vectors]), edges, radii.tolist(), 1)
    second = network.Network(np.vstack([[0, 0, 0], (vectors @ matrix.T)[order]]), edges, radii[order].tolist(), 1)
    return first, second


@pytest.mark.parametrize("seed", range(12))
def test_nodes_that_are_turned_are_one_class(seed):
    first, second = (kinds_of(net) for net in drawn(seed))
    one, other = first.kinds[first.of[0]], second.kinds[second.of[0]]
    assert one.form.key == other.form.key
    matrix = turn(one, other).floats[0]
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
    images = one.vectors[list(one.form.order)] @ matrix.T
    np.testing.assert_allclose(images, other.vectors[list(other.form.order)], atol=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_the_frame_of_a_node_is_the_least_of_all(seed):
    (vectors, labels), flat = np.random.default_rng(seed).integers(-2, 3, (2, 6, 3)), (1, 1, seed % 2)
    arms = {tuple(v): sizes for v, sizes in zip((vectors * flat).tolist(), abs(labels).tolist(), strict=True) if any(v)}
    kind = NodeKind(tuple((v, *sizes) for v, sizes in arms.items()))
    rank = int(np.linalg.matrix_rank(kind.vectors))
    told = [
        tuple((*kind.arms[i][1:], v @ v, *(v @ kind.vectors[j] for j in f[:n]))
              for n, (i, v) in enumerate(zip(f, kind.vectors[list(f)], strict=True)))
        for f in permutations(range(len(arms)), rank) if np.linalg.matrix_rank(kind.vectors[list(f)]) == rank
    ]  # fmt: skip
    assert (kind.form.key[0], kind.form.rank) == (min(told), rank)


def test_a_node_of_many_struts_has_its_form_at_once():
    signs = np.array([*product((1, -1), repeat=3)])
    kinds = ((1, 2, 3), (1, 1, 0), (1, 0, 0))
    ends = {tuple((s * p).tolist()) for v in kinds for p in permutations(v) for s in signs}
    begun = time.process_time()
    kind = NodeKind(tuple((end, 0, 0, 0) for end in sorted(ends)))
    assert (len(kind.arms), kind.form.symmetries) == (66, 48)
    assert time.process_time() - begun < 1  # 5 s where all frames are tried


def test_rotations_that_permute_no_axes_are_found():
    turned = np.array([[3, 4, 0], [-4, 3, 0], [0, 0, 5]])  # a rotation, five times
    vectors = np.array([[1, 2, 3], [-2, 1, 0], [1, -1, 4]])
    edges = [(0, 1), (0, 2), (0, 3)]
    both = (np.vstack([[0, 0, 0], v]) for v in (5 * vectors, vectors @ turned.T))
    one, other = (kinds_of(network.Network(points, edges, 1, 1)) for points in both)
    assert one.kinds[one.of[0]].form.key == other.kinds[other.of[0]].form.key


def test_nodes_that_differ_in_a_radius_are_not_one_class():
    points, edges = [(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)], [(0, 1), (0, 2), (0, 3)]
    one = kinds_of(network.Network(points, edges, 1, 1))
    other = kinds_of(network.Network(points, edges, [1, 1, 2], 1))
    assert one.kinds[one.of[0]].form.key != other.kinds[other.of[0]].form.key


def test_nodes_with_arms_as_long_are_not_one_class():
    ends = [(3, 0, 0), (0, 3, 0), (0, 0, 3)]
    both = (network.Network([(0, 0, 0), *ends, last], [(0, n) for n in range(1, 5)], 1, 1)
            for last in ((4, 4, 2), (-4, -4, 2)))  # fmt: skip
    one, other = map(kinds_of, both)
    assert one.kinds[one.of[0]].form.key != other.kinds[other.of[0]].form.key


@cache
def frame():
    """The edges of a cube, and beside it a line of two struts: nodes of three kinds."""
    points = [*np.ndindex(2, 2, 2), (3, 0, 0), (3, 1, 0), (3, 2, 0)]
    edges = [(a, b) for a in range(8) for b in range(a) if np.abs(np.subtract(points[a], points[b])).sum() == 1]
    edges += [(8, 9), (9, 10)]
    return network.Network(points, edges, ["1/10"] * len(edges), "1/64")


@cache
def part():
    return frame().blend(1, "lowest")


def test_a_body_is_proved():
    found = part()
    assert found.certificate.proved, found.certificate
    assert found.genus == 5
    assert [(len(one.struts), one.count, one.symmetries) for one in found.classes] == [(3, 8, 6), (1, 2, 0), (2, 1, 0)]
    assert [found.blend_of(one) is None for one in found.classes] == [False, True, True]


TEE = [(0, 0, 0), (0, 4, 0), (0, -4, 0), (-4, 0, 0)]
"""The points of a node of three struts and its neighbours."""


@cache
def tee():
    """The blends of that node, and how far it is from its point: on the side without a strut, and at most."""
    found = network.Network(TEE, [(0, 1), (0, 2), (0, 3)], "1/4", "1/4096").blend(1, "lowest")
    (blend,) = found.blends.values()
    points = blend.surface.mesh(1).points / 4096
    return found.blends, points[:, 0].max(), np.linalg.norm(points, axis=1).max()


def covers(points, struts):
    """What holds some nodes, all of which are that one turned or need no blend."""
    net = network.Network(points, struts, "1/4", "1/4096")
    return NodeCovers(placed_ends(net, 1), tee()[0])


def moved(x, y=0, sign=1):
    """The points of the tee elsewhere, or of its image in a plane."""
    return [(x + sign * px, y + py, pz) for px, py, pz in TEE]


def test_no_mesh_is_needed_to_prove_a_body(monkeypatch):
    monkeypatch.setattr(network.NetworkPart, "pieces", None)
    assert replace(part()).certificate.proved


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("gap", "proved"), [(0.002, 1), (0.2, 1), (-0.45, 0), (-0.2, 0), (-0.002, 0), (-0.499, 0)])
def test_nodes_that_meet_are_not_proved_to_be_apart(gap, proved):
    """By a hair, far into one another, or nearly one in the place of the other; so by whichever comes first."""
    both = covers([*TEE, *moved(2 * tee()[1] + gap, sign=-1)], [(0, 1), (0, 2), (0, 3), (4, 5), (4, 6), (4, 7)])
    found = both.apart(np.array([0, 4]), both.nodes, np.array([1, 0]))
    assert [apart.proved for apart in found] == [proved] * 2
    assert all(
        both.node(n, a).holds(one.common) for one, a in zip(found, (0, 4), strict=True) for n in (0, 4) if not proved
    )


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("gap", "proved"), [(0.005, 1), (0.2, 1), (-0.4, 0), (-0.002, 0), (-0.2, 0)])
def test_a_strut_that_meets_a_node_is_not_proved_to_be_apart(gap, proved):
    """By a hair, or through the middle; nor is one that begins there."""
    x = tee()[1] + 0.25 + gap
    others = [(x, 1, 0), (x, -1, 0), (x, 0, 0), (x + 2, 0, 0)]
    found = covers([*TEE, *others], [(0, 1), (0, 2), (0, 3), (4, 5), (6, 7)])
    apart = found.apart(np.array([0, 0]), found.struts, np.array([3, 4]))
    assert [one.proved for one in apart] == [proved] * 2
    assert proved or all(solid.holds(apart[0].common) for solid in (found.node(0, 0), found.strut(3, 0)))


STAR = np.array([(0, 0, 0), (4, 0, 0), (-2, 3.5, 0), (-2, -3.5, 0)])
"""The points of a node of three struts in a plane, from which it rises farther than they are thick, by some 11 %."""


def stars(height, *rod):
    """Two such nodes, one turned and this much higher, and perhaps a rod; radii are 1/4."""
    points = [*STAR, *(STAR * (-1, 1, 1) + (0, 0, height)), *rod]
    edges = [(n, n + m) for n in (0, 4) for m in (1, 2, 3)] + [(8, 9)][: len(rod)]
    return network.Network(points, edges, "1/4", "1/1024")


@pytest.mark.parametrize(("height", "proved"), [(0.53, False), (0.5625, True)])
def test_nodes_that_overlap_are_refuted(height, proved):
    """Though their struts do not; with a point that is inside of both, exact, and what to change."""
    net = stars(height)
    assert not net.check()
    found = net.blend(1, "lowest")
    assert found.certificate.proved is proved
    if proved:
        return
    (refuted,) = found.certificate.refuted
    said = (
        r"the nodes 0 and 4, 0\.5303 from one another, overlap at \(.*\); make struts there thinner, or move .* apart"
    )
    assert re.fullmatch(said, refuted.reason)
    assert found.unproved == (network.NetworkProblem("nodes", (0, 4), refuted.reason),)
    (blend,) = found.blends.values()  # of the second node, of which the first is the image in a plane
    assert blend.surface(1024 * (np.array(refuted.witness) - net.points[4])) < 0
    assert blend.surface((-1024, 1024, 1024) * np.array(refuted.witness)) < 0


@pytest.mark.parametrize(("height", "status"), [(0.5156, "REFUTED"), (0.5625, "PROVED")])
def test_a_strut_in_a_node_is_refuted(height, status):
    found = stars(2, (0, -1, -height), (0, 1, -height)).blend(1, "lowest")
    assert found.certificate.verdicts[-1].status is pas.Status[status]
    assert [problem.ids for problem in found.unproved] == [(0, 6)][: status == "REFUTED"]


def test_what_is_inside_of_nodes_and_struts_is_exact():
    """In the cells of a blend, off the discs where its struts begin; of a strut between these, off its surface."""
    part = stars(2).blend(1, "lowest")
    found = NodeCovers(part.kinds, part.blends)
    (blend,) = part.blends.values()
    surface = blend.surface.mesh(10).points
    for node, image in ((4, surface), (0, surface * (-1, 1, 1))):
        inside = [found.node(node, node).holds(vector(point)) for share in (0.99, 1.01) for point in share * image]
        assert inside == [True] * len(image) + [False] * len(image)
    clip = blend.surface.contacts[0].clip
    at = clip.at((0, 0, 0)) / (clip.at((0, 0, 0)) - clip.at((-1, 0, 0)))  # in steps along x, of which it is the image
    node, strut = found.node(0, 0), found.strut(0, 0)
    held = [(node.holds(vector((x, 0, 0))), strut.holds(vector((x, 0, 0)))) for x in (at - 1, at, at + 1, 4095, 4096)]
    assert held == [(True, False), (False, False), (False, True), (False, True), (False, False)]
    assert [node.side(vector((x, 0, 0))) for x in (at - 1, at, at + 1)] == [-1, 0, 1]
    inner, frame_ = vector((1, 2, 3)), node.surface.partition.frame
    zero = frame_.local_point(node.place.inverse.exact(inner))  # where the patches, less their values there, are 0
    patches = [patch - Fraction(str(patch.at(zero))) for patch in node.surface.patches]
    level = SimpleNamespace(local=node.surface.local, partition=node.surface.partition, patches=patches)
    assert NodeSolid(level, node.place).side(inner) == 0
    assert [strut.holds(vector((2000, 0, z))) for z in (255, Fraction(256) - Fraction(1, 10**30), 256)] == [1, 1, 0]


def test_ends_of_struts_are_rounded_inwards():
    kinds = kinds_of(stars(2))
    found = NodeCovers(replace(kinds, arm_ends=np.full((len(kinds.kinds), 3), 1 / 3)), {})
    here, there = found.strut(0, 0).ends
    assert Fraction(1 / 3) < Fraction(1, 3) and 3 * here > 1 and 3 * there < 2


def test_how_far_nodes_reach_is_proved_on_their_polynomials():
    """However near it is wanted to be."""
    found, far = covers([*TEE, (3, 0, 0), (3, 1, 0)], [(0, 1), (0, 2), (0, 3), (4, 5)]), tee()[2]
    assert far <= found.reach[0] < 1.02 * far
    assert not found.reach[1:].any()
    assert far <= reach_of(_held(found.held(0), far / 2)) < 1.1 * far


def test_what_is_proved_of_a_pair_is_so_of_those_that_are_placed_alike():
    """Of a node and its image, which are apart, of two alike as far apart, and of images that are nearer; of struts."""
    x, y = 2 * tee()[1] + 0.1, tee()[1] + 0.35
    nodes = [TEE, moved(x, sign=-1), moved(0, 20), moved(x, 20), moved(0, 40), moved(x - 0.2, 40, -1)]
    rods = [(y, 1, 0), (y, -1, 0), (y - 0.2, 21, 0), (y - 0.2, 19, 0)]
    edges = [(4 * n, 4 * n + m) for n in range(6) for m in (1, 2, 3)]
    found = covers([*chain.from_iterable(nodes), *rods], [*edges, (24, 25), (26, 27)])
    nodes = found.apart(np.array([0, 8, 16]), found.nodes, np.array([1, 3, 5]))
    struts = found.apart(np.array([0, 8]), found.struts, np.array([18, 19]))
    assert [[apart.proved for apart in some] for some in (nodes, struts)] == [[True, False, False], [True, False]]


def test_neighbours_are_apart_that_no_plane_across_their_strut_parts():
    """Each has two struts beside the other one, on the other side."""
    ways, other = np.array([(2, 4, 0.75), (2, 4, -0.75)]), np.array([0.75, 0, 0])
    points = [(0, 0, 0), other, *ways, *(other - ways)]
    net = network.Network(points, [(0, 1), (0, 2), (0, 3), (1, 4), (1, 5)], "1/8", "1/64")
    found = net.blend(1, "lowest")
    reach = NodeCovers(found.kinds, found.blends).reach
    assert reach[0] > 1.25  # and the strut is 0.75 long
    assert found.certificate.proved, found.certificate


def beside(x):
    """That node, and a thin rod beside it."""
    points, edges = [*TEE, (-x, x, 0), (-x, x, 1 / 64)], [(0, 1), (0, 2), (0, 3), (4, 5)]
    return network.Network(points, edges, ["1/4"] * 3 + ["1/256"], "1/4096")


@cache
def blends_beside_a_rod():
    """The blends of such a network, the same ones wherever the rod is."""
    return beside(1.3).blend(1, "lowest").blends


@pytest.mark.parametrize(("x", "inside"), [(0.27, True), (0.28, True), (0.29, False), (0.3, False), (1.3, False)])
def test_a_piece_inside_of_a_node_is_refuted(x, inside, monkeypatch):
    """Where its surface meets none; exactly, beside the node as well; a point on the node's surface tells nothing."""
    found = NetworkPart.of(1, placed_ends(beside(x), 1), blends_beside_a_rod(), None)
    assert [problem.ids for problem in found.unproved] == [(4, 5)] * inside
    assert found.certificate.verdicts[-1].status is (pas.Status.REFUTED if inside else pas.Status.PROVED)
    blend = next(iter(found.blends.values()))
    assert (blend.surface(4096 * np.array([-x, x, 1 / 128])) < 0 and x < 1) == inside
    if inside:
        assert found.certificate.verdicts[-1].witness == pytest.approx((-x, x, 1 / 128), abs=1 / 4096)
    monkeypatch.setattr(NodeSolid, "side", lambda solid, point: 0)
    open_ = replace(found).certificate.verdicts[-1]
    assert (
        open_.proved if x > 1 else open_.reason == "the piece of point 4 and another one may be one inside of the other"
    )


def test_a_part_without_a_blend_is_not_proved():
    found = replace(part(), blends={})
    assert "the nodes 0, 1, 2 and 5 more: there is no blend of 8 nodes of 3 struts" in str(found.certificate)
    assert found.unproved[0].ids == tuple(range(8))


@pytest.mark.parametrize("axis", range(3))
def test_a_blend_around_another_centre_is_not_that_of_a_node(axis):
    """Of such a one it is not known where the struts beyond its clips are seen."""
    key, blend = next(iter(part().blends.items()))
    for away, proved in (("6.3", True), ("6.4", False)):  # steps of the grid, of which the radius has 6.4
        center = np.full(3, "0", dtype=object)
        center[axis] = away
        surface = SimpleNamespace(partition=SimpleNamespace(center=vector(center)))
        moved = replace(part(), blends={key: SimpleNamespace(surface=surface, certificate=blend.certificate)})
        assert moved._nodes()[0].proved is proved


@cache
def trunk():
    """Struts that are cones: two that fork, one of which bends, and one that goes straight on and widens again."""
    points = [(0, 0, 0), (4, 0, 0), (-3, 4, 0), (4, 4, 0), (4, 8, 0)]
    radii = [("1/2", "1/4"), ("1/2", "3/10"), ("1/4", "1/8"), ("1/8", "1/2")]
    return network.Network(points, [(0, 1), (0, 2), (1, 3), (3, 4)], radii, "1/64")


@cache
def trunk_part():
    return trunk().blend(1, "lowest")


def test_struts_may_be_cones():
    found = trunk_part()
    assert found.certificate.proved, found.certificate
    assert [(found.blend_of(one) is None, len(one.struts)) for one in found.classes].count((False, 2)) == 3
    mesh = found.mesh(0.004)
    assert mesh.certificate.proved
    assert mesh.components == 1
    other = manifold3d.Manifold(manifold3d.Mesh(mesh.points.astype(np.float32), mesh.triangles.astype(np.uint32)))
    assert other.volume() == pytest.approx(mesh.volume, rel=1e-5)
    total = sum(body.volume * len(places) for body, places in found.bodies(MeshSettings(0.001)))
    assert total == pytest.approx(found.pieces(0.001).volume, rel=2e-3)  # chords of strips and of cut struts differ
    strips = mesh.triangles[mesh.faces == 1]
    ends, widths = trunk().points[trunk().edges], trunk().widths
    ways = ends[:, 1] - ends[:, 0]
    middles = mesh.points[strips].mean(axis=1)
    along = np.einsum("tei,ei->te", middles[:, None] - ends[:, 0], ways) / (ways**2).sum(axis=1)
    across = middles[:, None] - ends[:, 0] - along[:, :, None] * ways
    off = np.linalg.norm(across, axis=2) - widths[:, 0] - along * np.diff(widths, axis=1)[:, 0]
    nearest = np.abs(off).argmin(axis=1)
    assert 0 < np.abs(off).min(axis=1).max() < 0.004
    radial = across[np.arange(len(strips)), nearest]
    rise = (np.diff(widths, axis=1) / (ways**2).sum(axis=1, keepdims=True) * ways)[nearest]
    normals = radial / np.linalg.norm(radial, axis=1, keepdims=True) - rise
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found_normals = mesh.normals[mesh.faces == 1].mean(axis=1)
    found_normals /= np.linalg.norm(found_normals, axis=1, keepdims=True)
    assert (normals * found_normals).sum(axis=1).min() > 1 - 1e-3


def test_nodes_that_differ_in_a_far_radius_are_not_one_class():
    points, edges = [(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)], [(0, 1), (0, 2), (0, 3)]
    one, other = (kinds_of(network.Network(points, edges, radii, 1)) for radii in ([1, 1, 1], [1, 1, (1, 2)]))
    assert one.kinds[one.of[0]].form.key != other.kinds[other.of[0]].form.key


def test_cones_in_a_line_do_not_go_straight_on():
    points, edges = [(0, 0, 0), (3, 0, 0), (-3, 0, 0)], [(0, 1), (0, 2)]
    for radii in ([(1, 2), 1], [1, (1, 2)], [(1, 2), (1, 2)], [1, 2]):
        assert [kind.blended for kind in kinds_of(network.Network(points, edges, radii, 1)).kinds].count(True) == 1


@pytest.mark.parametrize(
    ("center", "inside"), [((256, 0, 15), True), ((256, 0, 17), False), ((0, 0, 31), True), ((600, 0, 0), False)]
)
def test_centres_are_inside_of_cones(center, inside):
    """Where the surface of a strut, were it to go on, is a double cone, its other half does not count."""
    one = SimpleNamespace(struts=(((256, 0, 0), Fraction(1, 2), Fraction(1, 4)),))
    blend = SimpleNamespace(surface=SimpleNamespace(partition=SimpleNamespace(center=vector(center))))
    assert trunk_part()._seen(one, blend) is inside


def test_its_mesh_is_watertight_and_proved():
    mesh = part().mesh()
    assert mesh.is_closed
    assert mesh.components == part().network.pieces == 2
    assert mesh.euler_characteristic == 2 * mesh.components - 2 * part().genus
    assert mesh.certificate.proved, mesh.certificate
    other = manifold3d.Manifold(manifold3d.Mesh(mesh.points.astype(np.float32), mesh.triangles.astype(np.uint32)))
    assert other.status() == manifold3d.Error.NoError
    assert other.volume() == pytest.approx(part().volume, rel=1e-5) == mesh.volume
    np.testing.assert_allclose(part().bounding_box, mesh.bounding_box)
    across = np.cross(*(mesh.points[mesh.triangles[:, i]] - mesh.points[mesh.triangles[:, 0]] for i in (1, 2)))
    assert ((across[:, None] * mesh.normals).sum(axis=2) > 0).all()


def test_a_node_that_has_no_mesh_is_named():
    def mesh(_):
        raise pas.MeshError("no good mesh was found")

    blends = {key: SimpleNamespace(surface=SimpleNamespace(mesh=mesh)) for key in part().blends}
    with pytest.raises(pas.MeshError, match="the node 0, in steps of the grid: no good mesh was found"):
        replace(part(), blends=blends).mesh()


def test_struts_of_the_mesh_are_on_their_cylinders():
    mesh, tolerance = part().mesh(0.002), 0.002
    middles = mesh.points[mesh.triangles[mesh.faces == 1]].mean(axis=1)
    ends = frame().points[frame().edges]
    pairs = (nearest_points(np.stack([middles] * 2, axis=1), np.broadcast_to(e, (len(middles), 2, 3))) for e in ends)
    apart = np.stack([np.linalg.norm(one - other, axis=1) for one, other in pairs])
    off = np.abs(apart.min(axis=0) - 0.1)
    assert 0 < off.max() < tolerance


@pytest.mark.parametrize("count", [13, 24])
@pytest.mark.parametrize("rise", [0.0, 0.5])
def test_strips_are_cut_into_rings_of_their_cone(rise, count):
    vector = np.array([0.0, 0.0, 30.0])

    def ring(count, at, turned):
        angles = 2 * np.pi * np.arange(count) / count + turned
        width = 1 + rise * at / 30
        return np.stack([width * np.cos(angles), width * np.sin(angles), np.full(count, at)], axis=1)

    first, second = ring(24, 2.0, 0.1), ring(20, 28.0, 0.4) - vector
    places = rings.places_of(first, second, vector, count)
    whole, cut = (rings.strip(first, second, vector, rise, count, at) for at in ((), places))
    assert len(whole[0]) == 0 and len(cut[0]) == count * len(places) > 0
    wide = 1 + rise * cut[0][:, 2] / 30
    np.testing.assert_allclose(np.linalg.norm(cut[0][:, :2], axis=1), wide, rtol=1e-14)
    points = np.concatenate([first, second + vector, cut[0]])
    assert least_angle(points[whole[1]]) < 5 < least_angle(points[cut[1]])
    sides = Counter(tuple(sorted(side)) for t in cut[1].tolist() for side in zip(t, t[1:] + t[:1], strict=True))
    assert sorted(set(sides.values())) == [1, 2] and sum(n == 1 for n in sides.values()) == 44
    corners = points[cut[1]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((across[:, None] * cut[2]).sum(axis=2) > 0.9 * np.linalg.norm(across, axis=1)[:, None]).all()


def least_angle(corners):
    """Of triangles (T, 3, 3), in degrees."""
    sides = np.roll(corners, 1, axis=1) - corners
    units = sides / np.linalg.norm(sides, axis=2, keepdims=True)
    return float(np.degrees(np.arccos(-(units * np.roll(units, 1, axis=1)).sum(axis=2))).min())


@pytest.mark.parametrize("even", [True, False])
def test_the_shortest_sides_of_rings_are_seen_from_the_next_one(even):
    """Of a ring some of whose vertices are near one another; an end that is open is an even ring."""
    angles = 2 * np.pi * np.arange(24) / 24
    angles[1::2] -= 0 if even else 0.15
    ring, vector = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1), np.array([0, 0, 40.0])
    for second in (ring, rings.circle(vector / 40, 0)):
        places = rings.places_of(ring, second, vector, 16)
        points, triangles, *_ = rings.strip(ring, second, vector, 0.0, 16, places)
        assert (places[-1] == 1) == (len(second) == 0)
        assert least_angle(np.concatenate([ring, second + vector, points])[triangles]) > 5
        assert 40 * places[0] == pytest.approx(2.48 if even else 1.06, rel=0.01)


def own(strut):
    """The number of points that a strut does not share with its nodes."""
    return len(strut.points) - len(strut.shared)


def test_struts_are_cut_into_rings_where_that_takes_few_triangles(monkeypatch):
    body = network.lattice("cubic", 1, "1/8").blend(degree="lowest")
    cut = body.mesh()
    assert cut.certificate.proved and all(map(own, body.pieces().struts))
    assert least_angle(cut.points[cut.triangles[cut.faces == 1]]) > 5
    monkeypatch.setattr("pas.network.sides.FEW", 0.0)
    plain = NetworkPart.of(1, body.kinds, body.blends, None)
    assert not any(map(own, plain.pieces().struts))
    assert len(plain.mesh().triangles) < len(cut.triangles) < 1.25 * len(plain.mesh().triangles)
    assert plain.volume == pytest.approx(body.volume, rel=1e-3)


def test_rings_of_long_struts_are_as_round_as_the_tolerance_asks():
    """Where rings as round as those of nodes are too many; bodies of files have no small angles there either."""
    body = network.lattice("cubic", 1, "1/12").blend(degree="lowest")
    mesh, (strut, *_) = body.mesh(), body.pieces().struts
    assert own(strut) == 2 * 13 < np.count_nonzero(strut.owners[: len(strut.shared)]) * 2
    assert mesh.certificate.proved and mesh.deviation <= mesh.tolerance
    assert least_angle(mesh.points[mesh.triangles[mesh.faces == 1]]) > 5
    assert all(least_angle(one.points[one.triangles]) > 5 for one, _ in body.bodies(MeshSettings()))
    many = sum(len(one.triangles) * len(places) for one, places in body.bodies(MeshSettings()))
    assert many < 1.25 * len(mesh.triangles)


def test_the_shorter_struts_are_cut_where_all_would_take_too_many_triangles():
    points = np.array([*np.ndindex(2, 2, 2)]) * (1, 1, 8)
    body = network.Network(points, cube().edges, "1/12", "1/64").blend(1, "lowest")
    ways = [np.ptp(body.network.points[strut.copies[0]], axis=0) for strut in body.pieces().struts]
    found = {tuple(way): own(strut) for way, strut in zip(ways, body.pieces().struts, strict=True)}
    assert found[0, 0, 8] == 0 and found[0, 1, 0] == found[1, 0, 0] == 26
    mesh = body.mesh()
    wide = [least_angle(corners[None]) > 5 for corners in mesh.points[mesh.triangles[mesh.faces == 1]]]
    assert 0 < wide.count(False) <= 4 * 48
    nodes = sum(len(piece.triangles) * len(piece.copies) for piece in body.pieces().nodes)
    assert sum(len(s.copies) * 2 * own(s) for s in body.pieces().struts) <= nodes / 4


def test_bodies_in_many_places_make_the_whole(tmp_path):
    bodies = part().bodies(MeshSettings())
    assert sum(len(places) for _, places in bodies) == len(frame().points)
    total = sum(mesh.volume * len(places) for mesh, places in part().bodies(MeshSettings(0.0005)))
    assert total == pytest.approx(part().pieces(0.0005).volume, rel=1e-3)  # chords of strips and of cut struts differ
    path = part().write(tmp_path / "frame.3mf", unit="mm")
    lib3mf = pytest.importorskip("lib3mf")
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    assert model.GetMeshObjects().Count() == len(bodies)
    components = model.GetComponentsObjects()
    assert components.MoveNext()
    found = components.GetCurrentComponentsObject()
    placed = [found.GetComponent(n).GetTransform().Fields[3] for n in range(found.GetComponentCount())]
    np.testing.assert_allclose(sorted(map(tuple, placed)), sorted(map(tuple, frame().points)), atol=1e-6)
    before = path.read_bytes()
    assert part().write(path, unit="mm").read_bytes() == before  # no names at random, no time


def test_glb_files_hold_each_body_once(tmp_path):
    bodies = part().bodies(MeshSettings())
    scene = trimesh.load_scene(part().write(tmp_path / "frame.glb", unit="cm"))
    assert len(scene.geometry) == len(bodies)
    drawn = [scene.geometry[scene.graph[node][1]] for node in scene.graph.nodes_geometry]
    assert len(drawn) == len(frame().points)
    assert sum(len(one.faces) for one in drawn) == sum(len(mesh.triangles) * len(places) for mesh, places in bodies)
    np.testing.assert_allclose(scene.bounds * 100, part().bounding_box, atol=1e-6)
    for mesh, _ in bodies:
        corners = mesh.points[mesh.triangles]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert ((across[:, None] * mesh.normals).sum(axis=2) > 0.9 * np.linalg.norm(across, axis=1)[:, None]).all()


def test_blocks_are_the_mesh(tmp_path, monkeypatch):
    monkeypatch.setattr("pas.network.placing.AT_ONCE", 1000)
    paths = part().write_blocks(tmp_path / "blocks", struts=2)
    assert len(paths) > 2
    counts = [int(np.fromfile(path, "<u4", 1, offset=80)[0]) for path in paths]
    mesh = part().mesh()
    assert sum(counts) == len(mesh.triangles)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("attribute", "<u2")])
    corners = np.concatenate([np.fromfile(path, record, offset=84)["corners"] for path in paths])
    whole = mesh.points[mesh.triangles].reshape(-1, 9).astype("<f4")
    assert sorted(corners.tolist()) == sorted(whole.tolist())
    before = [path.stat().st_mtime_ns for path in paths]
    paths[0].unlink()
    assert part().write_blocks(tmp_path / "blocks", struts=2) == paths
    after = [path.stat().st_mtime_ns for path in paths]
    assert before[1:] == after[1:]
    assert before[0] != after[0]
    assert status(tmp_path / "blocks") == (len(paths), len(paths))
    with pytest.raises(ValueError, match="blocks has blocks of another mesh, or cut otherwise; give another folder"):
        part().write_blocks(tmp_path / "blocks", 0.002, struts=2)
    with pytest.raises(ValueError, match=r"is no folder of blocks, which has a file blocks\.json"):
        status(tmp_path)


def test_an_engine_that_is_lost_is_told(tmp_path):
    """What it had done is there, and the same folder is gone on with."""

    def breaking(function, jobs):
        yield function(jobs[0])
        raise BrokenExecutor

    with pytest.raises(network.EngineLostError, match=r"map= was lost \(BrokenExecutor\) with 1 of [0-9]+ results"):
        part().write_blocks(tmp_path / "blocks", struts=2, map=breaking)
    (tmp_path / "blocks/.block-0-0-0-half.stl").touch()
    done, most = status(tmp_path / "blocks")
    assert done == 1 < most == len(part().write_blocks(tmp_path / "blocks", struts=2))
    assert not [*(tmp_path / "blocks").glob(".*")]
    with pytest.raises(
        network.EngineLostError, match=r"with 0 of 1 results; what was done is whole, and kept in .*kept"
    ):
        bend().blend(1, "lowest", cache=tmp_path / "kept", map=lambda *_: (_ for _ in ()).throw(BrokenExecutor()))


def pipework():
    """A corner of three tubes, one of which goes on straight: with open ends, and made of cones."""
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (8, 0, 0)]
    return network.Network(points, [(0, 1), (0, 2), (0, 3), (1, 4)], "1/2", "1/64"), "1/8"


@pytest.mark.parametrize(
    ("made", "surfaces"),
    [
        (lambda: (cube(), "1/40"), 2),
        pytest.param(pipework, 1, marks=pytest.mark.slow),
        pytest.param(lambda: (trunk(), "1/16"), 1, marks=pytest.mark.slow),
    ],
)
def test_hollow_networks(made, surfaces, tmp_path):
    net, wall = made()
    found = hollow_cube() if net is cube() else net.blend(1, "lowest", wall=wall)
    assert found.certificate.proved, found.certificate
    mesh = found.mesh()
    assert mesh.certificate.proved, mesh.certificate
    assert mesh.components == surfaces
    assert mesh.euler_characteristic == 2 * mesh.components - 2 * found.genus
    full = replace(found, wall=None, hollow={})
    inside = full.pieces(mesh.tolerance).volume - found.cavity.pieces(mesh.tolerance).volume
    assert found.volume == pytest.approx(mesh.volume) == pytest.approx(inside)
    across = np.cross(*(mesh.points[mesh.triangles[:, i]] - mesh.points[mesh.triangles[:, 0]] for i in (1, 2)))
    assert ((across[:, None] * mesh.normals).sum(axis=2) > 0).all()
    bodies = found.bodies(MeshSettings())
    assert all(body.is_closed for body, _ in bodies)
    assert sum(body.volume * len(places) for body, places in bodies) == pytest.approx(mesh.volume, rel=2e-2)
    for body, _ in bodies:
        corners = body.points[body.triangles]
        out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert ((out[:, None] * body.normals).sum(axis=2) > 0).all()
    again = pas.load(found.save(tmp_path / "a.pas.json"))
    assert again.certificate.proved
    assert (again.mesh().points == mesh.points).all()


@cache
def cube():
    """The cube of the frame alone."""
    return network.Network(frame().points[:8], frame().edges[:12], "1/10", "1/64")


@cache
def hollow_cube():
    """It with a wall."""
    return cube().blend(1, "lowest", wall="1/40")


@pytest.mark.slow
def test_a_wall_has_its_thickness_between_straight_struts():
    """Rings of the mesh at open ends are as thick as the wall, and cylinders inside are of the radius that is left."""
    net, wall = pipework()
    found = net.blend(1, "lowest", wall=wall)
    points = found.mesh().points
    ends = np.linalg.norm(points[np.abs(points[:, 0] - 8) < 1e-9][:, 1:], axis=1)
    assert set(ends.round(9)) == {0.5, 0.375}
    swapped = {key: replace(blend, outer=blend.inner, inner=blend.outer) for key, blend in found.hollow.items()}
    said = str([*replace(found, hollow=swapped)._inside()])
    assert "the cavity of 1 node of 3 struts, 6 symmetries is not proved" in said
    with pytest.raises(ValueError, match="a wall of 1/2 leaves no cavity in struts of the radius 1/2; give a thinner"):
        net.blend(wall="1/2")
    with pytest.raises(ValueError, match="wall must be positive"):
        net.blend(wall=0)


def test_meshes_of_a_wall_may_meet():
    """What is coarser than the wall is thick is not proved to be apart."""
    found = hollow_cube()
    mesh = found.mesh(0.03)
    said = {v.claim: v for v in mesh.certificate.verdicts}
    assert said["the topology of every node"].proved
    assert not said["both sides of the wall are apart"].proved
    assert next(mesh._apart(1e-3)).proved
    unknown = pas.Verdict(pas.Status.UNDECIDED, "thickness", "not known")
    thin = {key: SimpleNamespace(thicker_than=lambda _: unknown) for key in found.hollow}
    assert not next(replace(mesh, part=replace(found, hollow=thin))._apart(1e-3)).proved


def test_short_struts_are_shared():
    """Clips that would overlap leave 1/32 of the strut between them."""
    net = network.Network([(0, 0, 0), (2, 0, 0), (0, 2, 0), (2, 2, 0), (0, 5, 1)],
                          [(0, 1), (0, 2), (1, 3), (2, 4)], "9/10", "1/8")  # fmt: skip
    ends = placed_ends(net, 1).ends.sum(axis=1)
    assert (ends <= 62 / 64).all()
    assert ends.max() > 0.9


def test_a_cache_is_gone_on_from(tmp_path, monkeypatch):
    net = network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1), (0, 2)], "1/8", "1/8")
    with ThreadPoolExecutor(1) as engine:
        first = net.blend(1, "lowest", cache=tmp_path / "kept", map=engine.map)
    monkeypatch.setattr("pas.network.nodes.blend", None)
    monkeypatch.chdir(tmp_path)
    with ThreadPoolExecutor(1) as engine:  # which gives futures, and relative names
        second = net.blend(1, "lowest", cache="kept", map=lambda f, jobs: [engine.submit(f, job) for job in jobs])
    assert second.certificate.proved
    assert (second.mesh().points == first.mesh().points).all()
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match=r"a folder is needed, and .*file is a file"):
        net.blend(1, cache=tmp_path / "file")
    with pytest.raises(ValueError, match="give the folder as cache="):
        net.blend(1, map=lambda function, items: [function(item) for item in items])


@cache
def bend():
    """Two struts at a right angle."""
    return network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1), (0, 2)], "1/8", "1/8")


@cache
def bent():
    """Its body."""
    return bend().blend(1, "lowest")


def test_files_of_a_cache_are_those_of_their_nodes(tmp_path):
    """One that was put in the place of another is told, not believed."""
    bend().blend(1, "lowest", cache=tmp_path / "bend")
    (mine,) = (tmp_path / "bend").iterdir()
    for foreign in (*part().blends.values(), solid.ball((0, 0, 0), 1)):
        foreign.save(mine)
        with pytest.raises(pas.ProjectFileError, match="is no blend of the struts after which it is named; remove it"):
            bend().blend(1, "lowest", cache=tmp_path / "bend")


def test_struts_that_leave_side_by_side_do_not_go_straight_on(tmp_path):
    """Not in a file either in which a strut was turned around."""
    points, edges = [(0, 0, 0), (1, 0, 0), (-2, 0, 0)], [(0, 1), (0, 2)]
    straight = network.Network(points, edges, "1/8", "1/8")
    assert not any(kind.blended for kind in kinds_of(straight).kinds)
    folded = network.Network([*points[:2], (2, 0, 0)], edges, "1/8", "1/8")
    assert [kind.blended for kind in kinds_of(folded).kinds].count(True) == 1
    with pytest.raises(network.NetworkError, match="the node 0:"):
        placed_ends(folded, 1)
    path = straight.blend().save(tmp_path / "a.pas.json")
    content = json.loads(path.read_text())
    content["content"]["points"][2] = [16, 0, 0]
    path.write_text(json.dumps(content))
    with pytest.raises(pas.ProjectFileError, match="the node 0:"):
        pas.load(path, edited=True)


def test_a_file_is_of_a_graph_of_struts(tmp_path):
    path = bend().blend(1, "lowest").save(tmp_path / "a.pas.json")
    content = json.loads(path.read_text())
    content["content"]["points"][2] = content["content"]["points"][1]
    path.write_text(json.dumps(content))
    with pytest.raises(pas.ProjectFileError, match="the points 1 and 2 are in one place"):
        pas.load(path, edited=True)


def test_networks_are_cut_off_flat():
    """By a plane through the middle of the frame's cube, which takes half of it and all of the line beside."""
    half = part().mesh() & solid.box((-1, -1, -1), (2, 2, "1/2")).mesh()
    assert half.is_closed
    assert half.components == 1
    cap = half.triangles[half.faces == half.names.index("box z+")]
    assert set(half.points[cap][..., 2].ravel()) == {0.5}
    assert half.volume == pytest.approx(cube().blend(1, "lowest").volume / 2, rel=1e-3)


def test_foams():
    foam = network.voronoi(12, "1/100", seed=1)
    assert foam.pieces == 1
    assert (foam.points > -1e-9).all() and (foam.points < 1 + 1e-9).all()
    assert not {p.kind for p in foam.check()} - {"too short", "angle too small", "crossing"}
    mended, changes = foam.repair(collapse=True)
    assert not mended.check()
    assert len(changes) > 0
    assert len(mended.edges) < len(foam.edges)
    assert mended.pieces == 1


def test_repair_joins_struts_that_are_too_near_at_their_ends():
    """A strut shorter than those at its ends are thick, which cross; the shorter of two at a narrow angle; and no more:
    diagonals of a square stay."""
    link = [(0, 0, 0), (95, 0, 0), (-340, 940, 0), (435, 940, 0)]
    mended, changes = network.Network(link, [(0, 1), (0, 2), (1, 3)], 50, 1).repair(collapse=True)
    assert changes == ("strut 0, 95 long, became a point",)
    assert mended.edges.tolist() == [[0, 1], [0, 2]]
    narrow = network.Network([(0, 0, 0), (100, 0, 0), (0, 100, 0), (200, 10, 0)], [(0, 1), (0, 2), (0, 3)], 5, 1)
    mended, changes = narrow.repair(collapse=True)
    assert changes == ("strut 0, 100 long, became a point",)
    assert len(mended.edges) == 2
    points, edges, _ = WRONG["crossing"]
    mended, changes = network.Network(points, edges, "1/20", "1/1000").repair(collapse=True)
    assert changes == ()
    assert len(mended.edges) == len(edges)


@pytest.mark.parametrize("length", [24, 30, 40])
def test_a_short_strut_leaves_both_of_its_ends_what_they_need(length):
    """The struts at its second end are narrow and their clips far, which asks for more than there is of it."""
    points = [(0, 0, 0), (length, 0, 0), (-60, 80, 0), (-60, -80, 0), (10, 0, 100), (400, 40, 0), (400, -40, 0)]
    net = network.Network(points, [(0, 1), (0, 2), (0, 3), (0, 4), (1, 5), (1, 6)], 8, 1)
    kinds = placed_ends(net, 1)
    assert (kinds.ends * net.lengths[:, None] >= nearest(kinds) - 1e-9).all()
    assert kinds.ends[0].sum() <= 62 / 64


def test_a_network_without_struts_has_no_classes():
    empty = network.Network([(0, 0, 0)], [], [])
    assert empty.classes() == ()
    assert len(empty.repair(collapse=True)[0].points) == 0
    assert [problem.kind for problem in empty.check(whole=True)] == ["empty", "isolated"]


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match=r"a folder is needed, and .*file is a file"):
        part().write_blocks(tmp_path / "file")


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
WRONG = {
    "loop": (SQUARE, [(0, 1), (1, 1), (1, 2), (2, 3)], "strut 1 begins and ends at point 1"),
    "duplicate": (SQUARE, [(0, 1), (1, 2), (2, 3), (1, 0)], "the struts 0 and 3 join the same points"),
    "isolated": (SQUARE, [(0, 1), (1, 2)], "point 3 has no strut"),
    "angle too small": ([*SQUARE, (2, 0.1, 0)], [(0, 1), (0, 2), (0, 3), (0, 4)], "at 2.8[0-9]* degrees; 10 are"),
    "too short": ([*SQUARE, (0.1, 0.1, 0)], [(0, 1), (0, 4), (0, 3), (4, 2)], "strut 1 from point 0 to 4 is"),
    "crossing": ([*SQUARE, (1, 1, 1)], [(0, 2), (1, 3), (0, 4), (1, 4), (3, 4)], "the struts 0 and 1 pass at 0 from"),
}


CLOSE = [
    *[(-2, -32, 18), (98, -22, -178), (237, 117, 51), (152, 155, 30), (48, 76, -19), (-19, -9, 11), (0, 0, 0)],
    *[(37, 182, -77), (34, 39, -274), (44, 28, -99), (-63, -24, -30), (-77, 5, 52), (-114, 31, 80), (14, -87, 56)],
    (46, -194, 2),
]
CLOSE_EDGES = [
    *[(0, 5), (0, 6), (0, 13), (0, 14), (1, 8), (1, 9), (2, 4), (3, 4), (3, 7), (5, 6), (5, 10), (5, 11), (4, 6)],
    *[(4, 12), (6, 9), (7, 4), (8, 9), (4, 9), (10, 11), (11, 12), (13, 14)],
]
"""A node of a foam, and what is within two struts of it: clips that share short struts leave its four no room."""


def close(radius="2048/315"):
    return network.Network(CLOSE, CLOSE_EDGES, radius, 1)


@cache
def without_room():
    """What is said of it, before anything is solved."""
    with pytest.MonkeyPatch.context() as patch, pytest.raises(network.NetworkError) as caught:
        patch.setattr(nodes, "blend", None)
        close().blend()
    return caught.value


def test_nodes_without_room_are_told_before_anything_is_solved():
    error = without_room()
    (problem,) = error.problems
    assert (problem.kind, problem.ids, problem.struts) == ("no blend", (6,), (9,))
    assert "the node 6: no layout keeps these 4 contacts apart" in str(error)
    assert "repair(collapse=error.struts), --collapse" in str(error)
    assert placed_ends(close(5), 1).ends.sum(axis=1).max() < 1


def test_struts_that_are_named_become_points():
    """As an error offers them, until every node has room; several in a row become one point."""
    mended, changes = close().repair(collapse=without_room().struts)
    assert changes[0] == "strut 9, 23.73 long, became a point"
    assert (len(mended.points), len(mended.edges)) == (14, 19)
    assert placed_ends(mended, 1).ends.sum(axis=1).max() < 1
    row = network.Network([(0, 0, 0), (10, 0, 0), (20, 0, 0), (120, 0, 0)], [(0, 1), (1, 2), (2, 3)], 1, 1)
    mended, changes = row.repair(collapse=[1, 0])
    assert mended.points.tolist() == [[10, 0, 0], [120, 0, 0]]
    assert changes[:2] == ("strut 0, 10 long, became a point", "strut 1, 10 long, became a point")
    with pytest.raises(ValueError, match="collapse must be a whole number from 0 to 2"):
        row.repair(collapse=[3])
    for wrong in (2, "1", None):
        with pytest.raises(TypeError, match=f"collapse must be true, false or the numbers of struts, not {wrong!r}"):
            row.repair(collapse=wrong)
    with pytest.raises(TypeError, match="join must be True or False, not 'yes'"):
        row.repair(join="yes")


def test_struts_that_cross_are_joined():
    """The diagonals of a square end in its middle, with the radius that a cone has there; those that pass at a
    distance half way between; of two that cross a third in turn both."""
    points, edges, _ = WRONG["crossing"]
    net = network.Network(points, edges, [("1/20", "1/10"), *["1/20"] * 4], "1/1000")
    mended, changes = net.repair(join=True)
    assert changes == ("the struts 0 and 1, which crossed, end in a point between them",)
    assert mended.check() == ()
    assert mended.points[-1].tolist() == [0.5, 0.5, 0]
    assert len(mended.edges) == len(edges) + 2
    assert {mended.radii[s] for s in mended.sizes[[0, 5]].ravel()} == {
        Fraction(1, 20),
        Fraction(3, 40),
        Fraction(1, 10),
    }
    apart = network.Network([(-100, 0, 0), (100, 0, 0), (0, -100, 6), (0, 100, 6)], [(0, 1), (2, 3)], 4, 1)
    mended, _ = apart.repair(join=True)
    assert mended.points[-1].tolist() == [0, 0, 3]
    ladder = [*apart.points, (50, -100, 0), (50, 100, 0)]
    for rail in ((0, 1), (1, 0)):  # each of which would be cut in a wrong place if it were cut at both rungs at once
        mended, changes = network.Network(ladder, [rail, (2, 3), (4, 5)], 4, 1).repair(join=True)
        assert len(changes) == 2
        assert mended.check() == ()
        assert (mended.pieces, len(mended.edges)) == (1, 7)


def test_struts_that_cross_in_one_point_end_in_one():
    """The diagonals of a cube, two and two at a time."""
    corners = list(product((0, 1), repeat=3))
    edges = [
        (a, b) for a, b in combinations(range(8), 2) if np.abs(np.subtract(corners[a], corners[b])).sum() in (1, 3)
    ]
    mended, changes = network.Network(corners, edges, "1/20", "1/1024").repair(join=True)
    assert (len(changes), len(mended.points), mended.check()) == (2, 9, ())
    assert mended.points[8].tolist() == [0.5, 0.5, 0.5]
    assert mended.valence[8] == 8


JOINED = {
    "an end on a strut": (
        [(-100, 0, 0), (100, 0, 0), (20, 6, 0), (20, 100, 0)],
        [[-100, 0, 0], [20, 6, 0], [100, 0, 0]],
    ),
    "two ends": ([(-100, 0, 0), (0, 0, 0), (6, 2, 0), (100, 50, 0)], [[-100, 0, 0], [3, 1, 0]]),
    "far from the ends": (
        [(-100, 0, 0), (100, 0, 0), (20, -30, 2), (20, 100, 2)],
        [[-100, 0, 0], [20, 0, 1], [100, 0, 0]],
    ),
}


@pytest.mark.parametrize("name", JOINED)
def test_struts_that_end_near_others_are_joined_there(name):
    points, way = JOINED[name]
    mended, changes = network.Network(points, [(0, 1), (2, 3)], 4, 1).repair(join=True)
    assert len(changes) == 1
    assert mended.check() == ()
    along = [mended.points[edge].tolist() for edge in mended.edges]
    assert all(any(piece in ([a, b], [b, a]) for piece in along) for a, b in pairwise(way))


@pytest.mark.parametrize("end", [(100, 7, 0), (-100, 7, 0)])
def test_struts_that_would_meet_at_too_small_an_angle_are_not_joined(end):
    """Side by side, and from the same end on."""
    net = network.Network([(-100, 0, 0), (100, 0, 0), end, (-end[0], 6, 0)], [(0, 1), (2, 3)], 4, 1)
    assert net.repair(join=True, collapse=True)[1] == ()


@pytest.mark.slow  # 13 blends
def test_a_command_collapses_what_has_no_room(tmp_path, capsys):
    source = close().write(tmp_path / "close.npz")
    how = ["network", "build", str(source), "--grid", "1", "--degree", "lowest", "-o", str(tmp_path / "close.3mf")]
    assert main(how) == 2
    assert "the node 6: no layout keeps these 4 contacts apart" in capsys.readouterr().err
    assert main([*how, "-o", str(tmp_path / "mended.npz"), "--collapse"]) == 0
    assert len(network.Network.read(tmp_path / "mended.npz").points) == 14
    assert "strut 9, 23.73 long, became a point" in capsys.readouterr().out


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_wrong_is_said_with_numbers(kind):
    points, edges, sentence = WRONG[kind]
    net = network.Network(points, edges, "1/20", "1/1000")
    found = [problem for problem in net.check() if problem.kind == kind]
    assert len(found) == 1
    assert re.search(sentence, found[0].sentence)
    with pytest.raises(network.NetworkError, match=sentence) as caught:
        net.blend()
    assert found[0] in caught.value.problems


def test_what_is_asked_of_a_whole():
    net = network.Network([*SQUARE, (5, 5, 5), (6, 5, 5)], [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)], "1/20")
    assert not net.check()
    assert [p.kind for p in net.check(whole=True)] == ["dangling", "dangling", "disconnected"]
    assert "there are 2 pieces that do not meet, of the points [" in str(net.check(whole=True)[-1])


def cleared(net, reach=0.0, ends=0.0):
    """The verdict on what meets, of nodes that reach so far and struts that are straight from and to such ends."""
    kinds = kinds_of(net)
    table = np.zeros((len(kinds.kinds), 3))
    table[kinds.of[net.edges], kinds.slots] = ends
    found = NodeCovers(replace(kinds, arm_ends=table), {})
    beside = lambda *pairs: [Separation(False)] * len(pairs[-1])  # noqa: E731
    vars(found).update(reach=np.broadcast_to(reach, len(net.points)), apart=beside)
    return clearance(net, found)[0]


def test_what_comes_near_is_seen():
    """Two struts that pass, a strut by the ball of a node, and the balls of two nodes."""
    points = [(0, 0, 0), (4, 0, 0), (2, -2, 0.3), (2, 2, 0.3)]
    net = network.Network(points, [(0, 1), (2, 3)], "1/10", "1/10")
    assert cleared(net).proved
    touching = cleared(net.with_radius("3/20"))
    assert touching.status is pas.Status.UNDECIDED
    assert "the struts 0 and 1, 0.3 from one another, may meet" in touching.reason
    reach = [1.95, 0, 0, 0]
    assert cleared(net, reach, [[0, 0], [0.8, 0]]).proved  # what is not straight is of the nodes there
    assert not cleared(net, reach, [[0, 0], [0, 0.4]]).proved
    assert "the node 0 and the strut 1, 2.022 from its point, may meet" in cleared(net, reach).reason
    far = network.Network([*points[:2], (2, -2, 3), (2, 2, 3)], [(0, 1), (2, 3)], "1/10", "1/10")
    assert cleared(far, 1.9).proved
    assert "the nodes 0 and 1, 4 from one another, may meet" in cleared(far, 2.01).reason
    assert "(and 1 more like this)" in cleared(far, 2.01).reason


@pytest.mark.parametrize("height", [0.0, 0.3])
def test_struts_that_overlap_are_refuted(height):
    """With a point that is inside of both, where these are straight; where they are no more it is undecided."""
    net = network.Network([(0, 0, 0), (4, 0, 0), (2, -2, height), (2, 2, height)], [(0, 1), (2, 3)], "1/5", "1/10")
    found = cleared(net, 0, 0.25)
    assert found.status is pas.Status.REFUTED
    x, y, z = found.witness
    assert np.hypot(y, z) < 0.2 > np.hypot(x - 2, z - height)
    assert cleared(net, 0, [[0.1, 0.6], [0, 0]]).status is pas.Status.UNDECIDED


@pytest.mark.parametrize(("radii", "status"), [(("1/100", "1/2"), "REFUTED"), (("1/2", "1/100"), "UNDECIDED")])
def test_cones_that_overlap_are_refuted_where_they_are_thick(radii, status):
    points = [(0, 0, 0), (4, 0, 0), (3.5, -2, 0.3), (3.5, 2, 0.3)]
    net = network.Network(points, [(0, 1), (2, 3)], [radii, "1/100"], "1/10")
    assert cleared(net).status is pas.Status[status]


def test_the_end_of_a_strut_in_another_is_refuted():
    net = network.Network([(0, 0, 0), (4, 0, 0), (2, 0.1, 0), (2, 2, 1)], [(0, 1), (2, 3)], "1/5", "1/10")
    assert cleared(net).status is pas.Status.REFUTED


def test_a_file_with_struts_that_overlap_is_refuted(tmp_path):
    points = [(0, 0, 0), (1, 0, 0), (0, 0, 1), (1, 0, 1)]
    path = network.Network(points, [(0, 1), (2, 3)], "1/8", "1/8").blend().save(tmp_path / "a.pas.json")
    content = json.loads(path.read_text())
    content["content"]["points"][2:] = [[4, 4, 1], [4, -4, 1]]
    path.write_text(json.dumps(content))
    (refuted,) = pas.load(path, edited=True).certificate.refuted
    assert refuted.reason.startswith("the struts 0 and 1, 0.125 from one another, overlap at (0.5, 0, 0.0625); make ")


def test_an_error_tells_one_of_each_kind():
    """However many there are of another."""
    points = [(n, 0, 0) for n in range(20)] + [(0, 1, 0), (1, 2, 0)]
    edges = [(n, n) for n in range(20)] + [(20, 21), (21, 20)]
    with pytest.raises(network.NetworkError) as caught:
        network.Network(points, edges, "1/20").blend()
    assert str(caught.value) == (
        "strut 0 begins and ends at point 0 (and 19 more like this); the struts 20 and 21 join the same points"
    )
    assert len(caught.value.problems) == 21
    crossed = network.Network(
        [*SQUARE, (1, 1, 1), (5, 0, 0), (6, 0, 0), (6, 0.1, 0)],
        [(0, 2), (1, 3), (0, 4), (5, 6), (5, 7)],
        "1/20",
        "1/10",
    )
    assert [problem.kind for problem in crossed.check()] == ["angle too small", "crossing"]


def test_repair_says_what_it_does():
    points = [*SQUARE, (0, 0, 0), (7, 7, 7)]
    net = network.Network(points, [(0, 1), (1, 0), (1, 2), (2, 2), (4, 3)], ["1/20", "1/10", "1/20", "1/20", "1/20"])
    mended, changes = net.repair()
    assert not mended.check()
    assert type(mended) is network.Network
    assert mended.points.tolist() == [list(map(float, p)) for p in SQUARE]
    assert [len(mended.edges), mended.thickness.max()] == [3, 0.1]
    assert changes == (
        "point 4 became point 0, where it is",
        "strut 3 was a loop and went",
        "strut 0 was there twice and went",
        "point 5 had no strut and went",
    )


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".3mf", ".pas.json"])
@pytest.mark.parametrize("made", [part, trunk_part])
def test_graphs_in_files(made, suffix, tmp_path):
    net = made().network
    path = (made().save if suffix == ".pas.json" else net.write)(tmp_path / f"frame{suffix}")
    again = pas.load(path).network if suffix == ".pas.json" else network.Network.read(path, grid="1/64")
    ours, theirs = (
        {(*map(tuple, ends), *r) for ends, r in zip(n.points[n.edges].tolist(), n.widths.tolist(), strict=True)}
        for n in (net, again)
    )
    assert ours == theirs
    assert again.radii == net.radii


def test_lines_of_obj_files_and_graphs_of_networkx(tmp_path):
    file = tmp_path / "a.obj"
    file.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nl 2 1 3\n")
    net = network.Network.read(file, "1/10")
    assert net.edges.tolist() == [[1, 0], [0, 2]]
    graph = networkx.Graph()
    graph.add_node("a", pos=(0, 0, 0))
    graph.add_node("b", pos=(0, 0, 1))
    graph.add_edge("a", "b", radius="1/5")
    assert network.Network.of_graph(graph).radii == (pytest.approx(0.2),)
    with pytest.raises(pas.ProblemFileError, match=r"a\.obj has no radii; give radius="):
        network.Network.read(file)
    graph.add_node("c", pos=(1, 0, 0))
    graph.add_edge("b", "c")
    with pytest.raises(ValueError, match="edge 'b', 'c' has no 'radius'; give it one, or radius="):
        network.Network.of_graph(graph)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (([(0, 0)], [], 1), r"points must have the shape \(N, 3\), not \(1, 2\)"),
        (([(0, 0, float("nan"))], [], 1), "point 0 is not finite"),
        ((SQUARE, [(0, 7)], 1), "edges must be numbers of the 4 points, from 0 on; 7 is none"),
        ((SQUARE, [(0.0, 1.0)], 1), "edges must be whole numbers"),
        ((SQUARE, [(0, 1)], 0), "radius must be positive"),
        ((SQUARE, [(0, 1)], [1, 2]), "one for each of the 1 struts, not 2"),
        ((SQUARE, [(0, 1)], ["-1"]), r"radii\[0\] must be positive"),
        ((SQUARE, [(0, 1)], [(1, 2, 3)]), r"radii\[0\] must be one number, or one for each end, not \(1, 2, 3\)"),
        ((SQUARE, [(0, 1)], 1, "1/10000000"), "the grid 1/10000000 is too fine: a strut is 10000000 steps long"),
    ],
)
def test_wrong_arguments(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        network.Network(*arguments)


def test_wrong_names_and_files(tmp_path):
    with pytest.raises(ValueError, match="no unit cell 'octett'; is 'octet' meant"):
        network.lattice("octett", 2)
    with pytest.raises(ValueError, match=r"a network is read from one of \.npz, \.csv, \.obj, \.3mf, not from a\.stl"):
        network.Network.read("a.stl")
    bad = tmp_path / "a.csv"
    bad.write_text("x1,y1,z1,x2,y2,z2\n0,0,0,1,0,0\n0,0,0,1,0\n")
    with pytest.raises(pas.ProblemFileError, match=r"a\.csv, line 3: a strut is x, y, z of both ends"):
        network.Network.read(bad, 1)


@pytest.mark.parametrize("wall", [[], pytest.param(["--wall", "1/32"], marks=pytest.mark.slow)])
def test_the_command(wall, tmp_path, capsys):
    assert main(["network", "classes", "octet", "--cells", "2"]) == 0
    assert "13 nodes of 12 struts, 48 symmetries" in capsys.readouterr().out
    graph = network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1), (0, 2)], "1/8", "1/8").write(tmp_path / "a.csv")
    assert main(["network", "check", str(graph)]) == 0
    assert main(["network", "check", str(graph), "--whole"]) == 1
    out = [str(tmp_path / name) for name in ("b.3mf", "b.npz")]
    command = ["network", "build", str(graph), "--degree", "lowest", "--grid", "1/8", "-o", out[0], "-o", out[1]]
    assert main(command) == 0
    text = capsys.readouterr().out
    assert "every node meets its struts with GC^1: proved" in text
    assert f"\nwritten:\n  {out[0]}\n  {out[1]}\n" in text
    blocks = [
        "network",
        "build",
        str(graph),
        "--degree",
        "lowest",
        "--grid",
        "1/8",
        "--blocks",
        str(tmp_path / "blocks"),
    ]
    assert main([*blocks, *wall]) == 0
    assert ("the cavity is inside: proved" in capsys.readouterr().out) == bool(wall)
    assert main([*blocks, *wall]) == 2
    assert "blocks has blocks of an earlier run; go on with it by --resume, or empty it" in capsys.readouterr().err
    assert main([*blocks, *wall, "--resume"]) == 0
    assert main(["network", "status", str(tmp_path / "blocks")]) == 0
    assert "1 of 1 blocks are written" in capsys.readouterr().out
    for wrong, sentence in (
        (["--workers", "2"], "workers hand blends over in files: give a folder that all of them see as --cache"),
        (["--workers", "2", "--scheduler", "tcp://a:1"], "--workers starts processes here, --scheduler takes those of"),
        (["--workers", "0", "--cache", str(tmp_path)], "--workers must be a whole number from 1 to 10000, not 0"),
    ):
        assert main([*blocks, "--resume", *wrong]) == 2
        assert sentence in capsys.readouterr().err
    assert main(["network", "chek", str(graph)]) == 2
    assert "there is no action 'chek' on networks; is 'check' meant?" in capsys.readouterr().err


def test_what_is_not_proved_is_printed(tmp_path, capsys):
    """With the numbers of points and struts."""
    graph = beside(0.28).write(tmp_path / "a.npz")
    command = ["network", "build", str(graph), "--degree", "lowest", "--grid", "1/4096", "-o", str(tmp_path / "a.3mf")]
    command += ["--cache", str(tmp_path / "kept")]
    assert main(command) == 1
    assert (
        "\nnot proved: the piece of point 4 and another one overlap at (-0.28, 0.28, 0.0078" in capsys.readouterr().out
    )
    assert main([*command, "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["unproved"][0]["ids"] == [4, 5]


@pytest.mark.parametrize("cells", ["4x4", "4,4", "two", "1.5", "4,,4", "-1"])
def test_numbers_of_cells_that_are_none(cells, capsys):
    assert main(["network", "check", "cubic", f"--cells={cells}"]) == 2
    assert capsys.readouterr().err == (f"pas: --cells must be one whole number or three, as 4 or 4,4,2, not {cells}\n")


def test_no_file_of_several_is_left_where_one_fails(tmp_path, capsys, monkeypatch):
    graph = bend().write(tmp_path / "a.csv")
    out = [str(tmp_path / name) for name in ("b.stl", "b.npz")]
    monkeypatch.setattr(network.Network, "write", lambda *_: (_ for _ in ()).throw(OSError("the disk is full")))
    assert (
        main(["network", "build", str(graph), "--degree", "lowest", "--grid", "1/8", "-o", out[0], "-o", out[1]]) == 1
    )
    assert "the disk is full" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


@pytest.mark.parametrize("suffix", [".3mf", ".glb", ".stl", ".npz", ".csv", "/"])
def test_a_full_disk_leaves_nothing(suffix, tmp_path):
    """No process ends (as that of lib3mf did), no file is left, and the sentence names it; "/" stands for blocks."""
    resource = pytest.importorskip("resource")
    if suffix in (".3mf", ".glb"):
        pytest.importorskip("lib3mf" if suffix == ".3mf" else "trimesh")
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    write = bend().write if suffix in (".npz", ".csv") else bent().write
    resource.setrlimit(resource.RLIMIT_FSIZE, (200 if suffix == "/" else 50, usual[1]))
    try:
        with pytest.raises(OSError, match=r"so that nothing was written to: .*(a\.|block-0-0-0)"):
            bent().write_blocks(tmp_path) if suffix == "/" else write(tmp_path / f"a{suffix}")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    assert [path.name for path in tmp_path.iterdir()] == ["blocks.json"] * (suffix == "/")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cubic", "BCC", "octet", "Kelvin", "diamond"])
def test_blocks_of_a_thousand_nodes(name):
    cells, ratio = {"cubic": (10, 0.25), "BCC": (8, 0.2), "octet": (6, 0.14), "Kelvin": (5, 0.25),
                    "diamond": (5, 0.3)}[name]  # fmt: skip
    net = network.lattice(name, cells)
    net = net.with_radius(str(round(ratio * float(net.lengths[0]), 3)))
    found = net.blend()
    assert found.certificate.proved, found.certificate
    assert not found.unfair
    mesh = found.mesh()
    assert mesh.is_closed
    assert mesh.euler_characteristic == 2 - 2 * BLOCKS[name, cells][2]


@pytest.mark.slow
def test_the_examples(tmp_path):
    script = ROOT / "examples/networks/networks.py"
    subprocess.run(
        [sys.executable, script, "kelvin_ball", "-o", tmp_path], env=os.environ | {"PYTHONPATH": str(ROOT)}, check=True
    )
    assert {path.name for path in tmp_path.iterdir()} == {"kept", "kelvin_ball.3mf", "kelvin_ball.png"}
