"""One test for each rule of each certificate: broken alone, it changes its verdict and no other.

Every wall, face, cell, piece, contact, clip face, order and sign that the surfaces below have is
broken by itself, and what a partition must be is denied one cell or face at a time.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from functools import cache
from itertools import permutations, product
from math import prod

import pytest
from adversarial.exact_checks import Point, exact, onto, witness_flaws
from adversarial.surface_bases import Known, corner, least_on_triangle, proved_surface, sides, single
from adversarial.surface_breaks import added, untouched
from adversarial.surface_places import distance2, holds, mean, walls

import pas
from pas import Certificate, Contact, Partition, PiecewiseSurface, Polynomial, Status, Verdict
from pas.certify.proofs import face_verdict, sheet_verdict

PROVED, REFUTED, UNDECIDED = Status.PROVED, Status.REFUTED, Status.UNDECIDED
TINY = Fraction(1, 10**30)
X = tuple(map(Polynomial, "xyz"))


@cache
def base(name: str) -> tuple[Known, Certificate]:
    """A proved surface and its certificate."""
    known = {
        "corner GC^1": lambda: corner(0),
        "corner GC^2": lambda: corner(1),
        "elbow in 6 pieces": lambda: sides("elbow", 6),
        "tube": lambda: with_order(single("tube"), 1),
        "tube in 12 pieces": lambda: with_order(sides("tube", 12), 1),
    }[name]()
    return known, known.surface.certify()


def with_order(known: Known, order: int) -> Known:
    f = known.surface
    return proved_surface(PiecewiseSurface(f.partition, f.contacts, order, f.patches), known.story)


def named(certificate: Certificate) -> dict[str, Verdict]:
    """The verdicts by what they are about: "contact 1", "face 1", "one sheet", "enclosed"."""
    contacts = {f"contact {i}": v for i, v in enumerate(certificate.contacts, start=1)}
    faces = {f"face {i}": v for i, v in enumerate(certificate.faces, start=1)}
    return contacts | faces | {"one sheet": certificate.one_sheet, "enclosed": certificate.enclosed}


def changes(name: str, surface: PiecewiseSurface) -> dict[str, Verdict]:
    """The verdicts that are no longer proved; every witness is right."""
    _, before = base(name)
    after = surface.certify()
    assert [*named(before)] == [*named(after)]
    assert list(witness_flaws(surface, after)) == []
    assert not after.proved or all(v.proved for v in named(after).values())
    return {key: verdict for key, verdict in named(after).items() if not verdict.proved}


ORDERS = {"corner GC^1": 1, "corner GC^2": 2, "elbow in 6 pieces": 1, "tube": 1, "tube in 12 pieces": 1}
FACES = {"corner GC^1": 6, "corner GC^2": 6, "elbow in 6 pieces": 12, "tube": 0, "tube in 12 pieces": 18}
CONTACTS = {"corner GC^1": 3, "corner GC^2": 3, "elbow in 6 pieces": 2, "tube": 2, "tube in 12 pieces": 2}
CELLS = {"corner GC^1": 6, "corner GC^2": 6, "elbow in 6 pieces": 12, "tube": 12, "tube in 12 pieces": 12}
PIECES = {"corner GC^1": 6, "corner GC^2": 6, "elbow in 6 pieces": 6, "tube": 1, "tube in 12 pieces": 12}
WALLS = {"corner GC^1": 9, "corner GC^2": 9, "elbow in 6 pieces": 8, "tube": 8, "tube in 12 pieces": 8}
CLIP_FACES = {"corner GC^1": 3, "corner GC^2": 3, "elbow in 6 pieces": 4, "tube": 4, "tube in 12 pieces": 4}


def each(counts: dict[str, int], but: str = "") -> list[tuple[str, int]]:
    return [(name, number) for name, count in counts.items() for number in range(count) if name != but]


@pytest.mark.parametrize("name", ORDERS)
def test_nothing_is_left_out(name):
    """The counts above, which the other tests run through, are all that the surfaces have."""
    known, certificate = base(name)
    assert certificate.proved
    f = known.surface
    assert f.order == ORDERS[name]
    assert len(f.partition.interior_faces) == len(certificate.faces) == FACES[name]
    assert len(f.contacts) == len(certificate.contacts) == CONTACTS[name]
    assert (len(f.partition.cells), len(f.patches)) == (CELLS[name], PIECES[name])
    assert len(walls(known)) == WALLS[name]
    assert len(f.partition.outer_faces) == WALLS[name] + CLIP_FACES[name]


@pytest.mark.parametrize(("name", "number"), each(FACES))
@pytest.mark.sampled(3)
def test_each_face_at_each_power(name, number):
    """A patch plus pi^m: exactly C^(m-1) across the one face, whichever of its patches it is."""
    known, _ = base(name)
    k = ORDERS[name]
    face = known.surface.partition.interior_faces[number]
    for m, piece in product(range(k + 2), (face.first, face.second)):
        term = TINY * face.plane**m * untouched(known, piece, leave=number)
        surface = added(known.surface, {piece: term})
        verdicts = [face_verdict(surface, i) for i in range(FACES[name])]
        assert [i for i, v in enumerate(verdicts) if not v.proved] == ([number] if m <= k else [])
        if m <= k:
            assert verdicts[number].status is REFUTED
            assert ("not continuous" if m == 0 else f"C^{m - 1} only") in verdicts[number].reason
        if m == k and piece == face.first:
            assert set(changes(name, surface)) == {f"face {number + 1}"}


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("name", "number"), each(CONTACTS))
def test_each_contact_at_each_power_on_each_piece(name, number):
    """A patch plus h^m: it meets the one contact with exactly GC^(m-1), and without m = 0 no clip face differs."""
    known, _ = base(name)
    k = ORDERS[name]
    contact, join = known.surface.contacts[number], known.surface.joins[number]
    assert set(join.pieces) == {face.piece for face in join.faces}
    for m, piece in product(range(k + 2), join.pieces):
        others = divided(untouched(known, piece), contact.clip ** (k + 1))
        broken = changes(name, added(known.surface, {piece: TINY * contact.clip**m * others}))
        expected = {f"contact {number + 1}"} | ({"enclosed"} if m == 0 else set()) if m <= k else set()
        assert set(broken) == expected
        if m <= k:
            verdict = broken[f"contact {number + 1}"]
            assert verdict.status is REFUTED
            assert ("not meet the contact at all" if m == 0 else f"GC^{m - 1} only") in verdict.reason


def divided(product: Polynomial, factor: Polynomial) -> Polynomial:
    quotient, remainder = divmod(product.raw, factor.raw)
    assert remainder.is_zero()
    return Polynomial.from_raw(quotient)


@pytest.mark.parametrize(("name", "number"), each(CELLS, but="corner GC^2"))
@pytest.mark.sampled(3)
def test_a_bubble_in_each_cell(name, number):
    """All patches times a small ball inside the cell: the surface has a second sheet, there alone."""
    known, _ = base(name)
    region = known.surface.partition
    p = mean([exact(v) for v in region.corners(region.cells[number])], [1, 1, 1, 1])
    room = min(abs(float(plane.at(p))) / norm(plane) for plane in region.planes(number))
    r = Fraction(room).limit_denominator(1000) * Fraction(7, 8)
    bubble = distance2(p) - r**2
    broken = changes(name, times(known, bubble))
    assert set(broken) == {"one sheet"}
    assert broken["one sheet"].status is REFUTED
    assert bubble.at(exact(broken["one sheet"].witness)) <= r**2 / 10**9


@pytest.mark.parametrize(("name", "number"), each(PIECES, but="corner GC^2"))
@pytest.mark.sampled(3)
def test_a_second_sheet_in_each_piece(name, number):
    """One patch alone comes down to zero again, between the surface and the walls of its piece."""
    known, _ = base(name)
    f, region = known.surface, known.surface.partition
    patch, center = f.polynomials[number], exact(region.center)
    cell = next(c for c, piece in enumerate(region.piece_of) if piece == number)
    p, q = between_surface_and_wall(patch, center, [exact(v) for v in region.corners(region.cells[cell])])
    planes = {wall.plane for wall in walls(known) if wall.piece == number}
    bump = prod(planes, start=untouched(known, number)) * (distance2(center) - distance2(center).at(q))
    broken = changes(name, added(f, {number: bump * ((-patch.at(p) - Fraction(1, 50)) / bump.at(p))}))
    assert set(broken) == {"one sheet"}
    assert broken["one sheet"].status is REFUTED
    assert any(holds(region, c, exact(broken["one sheet"].witness)) for c in region.pieces[number])


def between_surface_and_wall(patch: Polynomial, center: Point, corners: list[Point]) -> tuple[Point, Point]:
    """A point of a cell in the middle of where a patch is positive, and one before it on the same ray."""
    end = max((mean(corners, w) for w in product((1, 20), repeat=4)), key=lambda e: (patch.at(e), e))
    shares = [i for i in range(1, 100) if patch.at(mean([center, end], [100 - i, i])) > 0]
    assert patch.at(end) > 0
    first = min(shares)
    p, q = ((first + (99 - first) * part // 8) for part in (4, 2))
    return mean([center, end], [100 - p, p]), mean([center, end], [100 - q, q])


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("name", "number"), each(WALLS, but="corner GC^2"))
def test_each_wall_is_reached_alone(name, number):
    """One patch is lowered on one wall; it is unchanged on all other walls, faces and clip faces."""
    known, _ = base(name)
    wall = walls(known)[number]
    region = known.surface.partition
    corners = [exact(v) for v in region.corners(wall.vertices)]
    others = {w.plane for w in walls(known) if w.piece == wall.piece and w.plane != wall.plane}
    bump = prod(others, start=untouched(known, wall.piece))
    p = mean(corners, [3, 4, 5])
    patch = known.surface.polynomials[wall.piece]
    broken = changes(name, added(known.surface, {wall.piece: bump * ((-Fraction(1, 9) - patch.at(p)) / bump.at(p))}))
    assert {"enclosed"} <= set(broken) <= {"enclosed", "one sheet"}
    assert broken["enclosed"].status is REFUTED
    assert wall.plane.at(onto(wall.plane, exact(broken["enclosed"].witness))) == 0
    assert abs(wall.plane.at(exact(broken["enclosed"].witness))) < 1e-12


@pytest.mark.parametrize("where", ["outside", "inside", "on the curve"])
@pytest.mark.parametrize(("name", "number"), each(CLIP_FACES, but="corner GC^2"))
@pytest.mark.sampled(3)
def test_alpha_on_each_clip_face(name, number, where):
    """All patches times a small ball on a clip face: alpha is negative there, off the curve or on it."""
    known, _ = base(name)
    f = known.surface
    face, contact = [(face, i) for i, join in enumerate(f.joins) for face in join.faces][number]
    surface = f.contacts[contact].surface
    candidates = [
        mean([exact(v) for v in f.partition.corners(face.vertices)], w) for w in product((1, 2, 3, 5), repeat=3)
    ]
    key = {"outside": lambda p: -surface.at(p), "inside": surface.at, "on the curve": lambda p: abs(surface.at(p))}
    p = min(candidates, key=key[where])
    broken = changes(name, times(known, distance2(p) - Fraction(1, 40) ** 2))
    expected = {"one sheet", "enclosed"} | ({f"contact {contact + 1}"} if where == "on the curve" else set())
    assert set(broken) == expected
    assert {v.status for v in broken.values()} == {REFUTED}
    for key in expected - {"one sheet"}:
        assert distance2(p).at(exact(broken[key].witness)) < Fraction(1, 39) ** 2


@pytest.mark.parametrize(("name", "number"), each(CONTACTS))
def test_each_contact_turned_round(name, number):
    known, _ = base(name)
    f = known.surface
    contacts = [Contact(-c.surface, c.clip) if i == number else c for i, c in enumerate(f.contacts)]
    broken = changes(name, PiecewiseSurface(f.partition, contacts, f.order, f.patches))
    assert set(broken) == {f"contact {number + 1}", "enclosed"}
    assert {v.status for v in broken.values()} == {REFUTED}


@pytest.mark.parametrize(("name", "number"), each(PIECES, but="corner GC^2"))
def test_the_centre_in_each_piece(name, number):
    """One patch alone is not negative at the centre."""
    known, _ = base(name)
    f = known.surface
    center = exact(f.partition.center)
    lift = -f.polynomials[number].at(center)
    for value in (Fraction(0), Fraction(1, 10**40), Fraction(1, 9)):
        verdict = sheet_verdict(added(f, {number: Polynomial(lift + value)}))
        assert verdict.status is REFUTED
        assert "centre" in verdict.reason
        assert verdict.witness == pytest.approx([float(c) for c in center])


@pytest.mark.parametrize("name", ORDERS)
def test_orders_beyond_what_was_built_are_refuted(name):
    """Lower orders are proved; what is higher fails for the patches of corners, which were built for no more."""
    known, certificate = base(name)
    f = known.surface
    for order in range(ORDERS[name]):
        assert PiecewiseSurface(f.partition, f.contacts, order, f.patches).certify().proved
    if "corner" in name:
        higher = PiecewiseSurface(f.partition, f.contacts, ORDERS[name] + 1, f.patches).certify()
        assert {v.status for v in higher.contacts} == {REFUTED}
        assert REFUTED in {v.status for v in higher.faces}
        assert higher.one_sheet == certificate.one_sheet
        assert higher.enclosed == certificate.enclosed


@pytest.mark.parametrize("name", ["corner GC^1", "tube"])
def test_a_certificate_is_proved_if_each_verdict_is(name):
    _, certificate = base(name)
    many = len(certificate.contacts) + len(certificate.faces) + 2
    for i in range(many):
        for status in (REFUTED, UNDECIDED):
            record = certificate.to_record()
            told = [v for part in record.values() for v in (part if isinstance(part, list) else [part])]
            assert len(told) == many
            told[i]["status"] = status.value
            changed = Certificate.from_record(record)
            assert not changed.proved
            assert len(changed.refuted) == (status is REFUTED)


def times(known: Known, factor: Polynomial) -> PiecewiseSurface:
    f = known.surface
    return PiecewiseSurface.from_polynomials(f.partition, f.contacts, f.order, [factor * p for p in f.polynomials])


def norm(plane: Polynomial) -> float:
    return sum(float(plane.diff(i).at((0, 0, 0))) ** 2 for i in range(3)) ** 0.5


# Walls without contacts: spindles from the centre through one outer triangle.

REGIONS = {
    "six tetrahedra": (lambda: pas.SixTetrahedra((1, 0, 0), [(2, 0, 0), (0, 1, 0), (0, 0, "3/2")]), 12),
    "box": (lambda: pas.SingleCell((0, -1, 0), (2, 1, 3), (1, "1/4", 1)), 12),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("name", "number"), [(n, i) for n, (_, count) in REGIONS.items() for i in range(count)])
def test_each_outer_triangle_is_reached_alone(name, number):
    """A spindle ends before the triangle, touches it, or goes through it: enclosed, undecided, refuted."""
    make, count = REGIONS[name]
    region = make()
    assert len(region.outer_faces) == count
    face = region.outer_faces[number]
    center = exact(region.center)
    m = mean([exact(v) for v in region.corners(face.vertices)], [2, 3, 4])
    for gap, status in (("1/100", PROVED), ("0", UNDECIDED), ("-1/100", REFUTED)):
        f = spindle(center, m, face.plane, Fraction(gap))
        for other in region.outer_faces:
            least = least_on_triangle(f, [exact(v) for v in region.corners(other.vertices)])
            assert (least > 0) == (other != face or status is PROVED)
        surface = PiecewiseSurface.from_polynomials(region, (), 1, [f] * len(region.pieces))
        certificate = surface.certify()
        assert certificate.one_sheet.proved
        assert all(v.proved for v in certificate.faces)
        assert certificate.enclosed.status is status
        assert list(witness_flaws(surface, certificate)) == []
        if status is REFUTED:
            witness = exact(certificate.enclosed.witness)
            assert abs(face.plane.at(witness)) < 1e-12
            assert f.at(onto(face.plane, witness)) < 0


def spindle(center: Point, end: Point, plane: Polynomial, gap: Fraction) -> Polynomial:
    """A thin ellipsoid around the segment from a centre to a point, with smallest value `gap` on a plane there."""
    way = [b - a for a, b in zip(center, end, strict=True)]
    length2 = sum(w * w for w in way)
    along = sum((w * (v - c) for w, v, c in zip(way, X, center, strict=True)), Polynomial(0)) / length2
    across = distance2(center) - length2 * along**2
    square = 400 * across / length2 + 4 * (along - Fraction(9, 20)) ** 2
    far = [tuple(e + s * u for e, u in zip(end, step, strict=True)) for step in in_plane(plane) for s in (-50, 50)]
    least = min(least_on_triangle(square, [end, far[i], far[j]]) for i, j in ((0, 2), (2, 1), (1, 3), (3, 0)))
    return square - least + gap


def in_plane(plane: Polynomial) -> tuple[Point, Point]:
    """Two independent directions in a plane."""
    a, b, c = (plane.diff(i).at((0, 0, 0)) for i in range(3))
    ways = [(b, -a, Fraction(0)), (c, Fraction(0), -a), (Fraction(0), c, -b)]
    first, second = sorted(ways, key=lambda w: -sum(x * x for x in w))[:2]
    return first, second


# Contacts in a box: the curve leaves its face, the clip is tangent.

TURNS = [(p, s) for p in permutations(range(3)) if p[1] < p[2] for s in (1, -1)]


def turned(text: str, axes: tuple[int, ...], sign: int) -> Polynomial:
    """A polynomial with x, y, z replaced by coordinates in another order, the first with a sign."""
    new = [Polynomial(0)] * 3
    for i, axis in enumerate(axes):
        new[i] = X[axis] * (sign if i == 0 else 1)
    return Polynomial(text).compose(*new)


@pytest.mark.parametrize("edge", ["y", "-y", "z", "-z"])
@pytest.mark.parametrize(("axes", "sign"), TURNS)
def test_a_curve_that_leaves_its_face_through_each_edge(axes, sign, edge):
    """A tube along each axis in either direction, cut off by one wall: its one end is no closed curve."""
    box = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    moved = edge.replace("-", "") + ("+" if edge[0] == "-" else "-") + "(x + 1)*7/20"
    text = f"({moved})^2 + {'z' if edge[-1] == 'y' else 'y'}^2 - 4/25"
    f = turned(text, axes, sign)
    contacts = [Contact(f, turned("x - 1", axes, sign)), Contact(f, turned("-x - 1", axes, sign))]
    surface = PiecewiseSurface.from_polynomials(box, contacts, 1, [f])
    certificate = surface.certify()
    assert [v.status for v in certificate.contacts] == [REFUTED, PROVED]
    assert "edges" in certificate.contacts[0].reason
    assert certificate.enclosed.status is REFUTED
    at_edge = turned(f"{edge} - 1", axes, sign)
    assert abs(at_edge.at(exact(certificate.contacts[0].witness))) < 1e-12
    assert list(witness_flaws(surface, certificate)) == []


@pytest.mark.parametrize(("axes", "sign"), TURNS)
@pytest.mark.parametrize(
    "curve",
    [
        "16*(y^2 + z^2)^2 - 4*(y^2 - z^2)",  # a figure eight
        "4*y^2 + 4*z^2 - (z^2 + y^2)^2*16 - 1/4",  # a circle, twice
        "(y^2 + z^2 - 1/4)*((y - 1/4)^2 + z^2)",  # a circle and a point inside it
    ],
)
def test_a_tangent_clip_is_not_proved(curve, axes, sign):
    """The contact's curve has a singular point, where the clip plane touches its surface; alpha = 1 everywhere."""
    box = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    text = f"{curve} + (x - 1)*(y^2 + z^2 + 1)" if "16 -" not in curve else f"-({curve}) + (x - 1)/9"
    f = turned(text, axes, sign)
    surface = PiecewiseSurface.from_polynomials(box, [Contact(f, turned("x - 1", axes, sign))], 1, [f])
    assert surface.certify().contacts[0].status is not PROVED


TWO = ["(y - 1/2)^2 + z^2 - 1/16", "(y + 1/2)^2 + 2*z^2 - 1/9"]


@pytest.mark.parametrize(("axes", "sign"), TURNS)
@pytest.mark.parametrize("middle", ["0", "(1 - x^2)^2/8"])
@pytest.mark.sampled(3)
def test_two_contacts_in_one_clip_face(axes, sign, middle):
    """Two tubes between two walls, apart or joined: each patch is negative inside both curves, positive outside."""
    box = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    first, second = (turned(text, axes, sign) for text in TWO)
    contacts = [Contact(f, turned(clip, axes, sign)) for clip in ("x - 1", "-x - 1") for f in (first, second)]
    f = first * second - turned(middle, axes, sign)
    certificate = PiecewiseSurface.from_polynomials(box, contacts, 1, [f]).certify()
    assert all(v.proved for v in (*certificate.contacts, certificate.enclosed))
    # with a third curve, which is no contact's
    third = turned("(y - 3/4)^2 + (z - 3/4)^2 + (x - 1)^2 - 1/100", axes, sign)
    certificate = PiecewiseSurface.from_polynomials(box, contacts, 1, [f * third]).certify()
    assert all(v.proved for v in certificate.contacts)
    assert certificate.enclosed.status is REFUTED
    assert third.at(exact(certificate.enclosed.witness)) < 0
    # without one of the contacts it leaves the region there, too
    for number in range(4):
        some = [c for i, c in enumerate(contacts) if i != number]
        certificate = PiecewiseSurface.from_polynomials(box, some, 1, [f]).certify()
        assert all(v.proved for v in certificate.contacts)
        assert certificate.enclosed.status is REFUTED
        assert contacts[number].surface.at(exact(certificate.enclosed.witness)) < 0


# Pieces and partitions.


def octahedron() -> tuple[list[Point], list[tuple[int, ...]]]:
    v = [
        tuple(map(Fraction, p))
        for p in ((0, 0, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    ]
    return v, [(0, a, b, c) for a in (1, 2) for b in (3, 4) for c in (5, 6)]


@pytest.mark.parametrize("cell", range(8))
def test_a_piece_with_faces_in_several_planes(cell):
    """One octant against the other seven as one piece: they share faces in three planes, each with its verdict."""
    v, cells = octahedron()
    region = Partition(v, cells, v[0], [(cell,), tuple(i for i in range(8) if i != cell)])
    assert len(region.interior_faces) == 3
    ball = Polynomial("x^2 + y^2 + z^2 - 1/9")
    for number, face in enumerate(region.interior_faces):
        others = prod((f.plane**2 for i, f in enumerate(region.interior_faces) if i != number), start=Polynomial(1))
        for m in range(3):
            for changed in (0, 1):
                patches = [ball, ball]
                patches[changed] = ball + TINY * others * face.plane**m
                certificate = PiecewiseSurface.from_polynomials(region, (), 1, patches).certify()
                expected = [REFUTED if i == number and m < 2 else PROVED for i in range(3)]
                assert [v.status for v in certificate.faces] == expected
                assert certificate.one_sheet.proved
                assert certificate.enclosed.proved


def partitions() -> dict[str, tuple[list, list, tuple]]:
    corner_ = pas.SixTetrahedra()
    box = pas.SingleCell((0, 0, 0), (1, 2, 3))
    v, cells = octahedron()
    return {
        "octahedron": (v, cells, v[0]),
        "six tetrahedra": (list(corner_.vertices), list(corner_.cells), corner_.center),
        "box": (list(box.vertices), list(box.cells), box.center),
    }


ALL_CELLS = [(name, i) for name, (_, cells, _) in partitions().items() for i in range(len(cells))]


@pytest.mark.parametrize(("name", "number"), ALL_CELLS)
def test_each_cell_left_out_doubled_flattened_or_repeated(name, number):
    vertices, cells, center = partitions()[name]
    assert len(Partition(vertices, cells, center).cells) == len(cells)
    others = [c for i, c in enumerate(cells) if i != number]
    with pytest.raises(pas.GeometryError, match="not inside the region"):
        Partition(vertices, others, center)
    with pytest.raises(pas.GeometryError, match="overlap"):
        Partition(vertices, [*cells, cells[number]], center)
    copies = [*vertices, *(vertices[i] for i in cells[number])]
    again = tuple(range(len(vertices), len(copies)))
    with pytest.raises(pas.GeometryError):  # the same cell with vertices of its own
        Partition(copies, [*cells, again], center)
    a, b, c, _ = cells[number]
    flat = [*vertices, mean([exact(vertices[i]) for i in (a, b, c)], [1, 1, 1])]
    with pytest.raises(pas.GeometryError, match=f"cell {number + 1} of the partition is flat"):
        Partition(flat, [(a, b, c, len(vertices)) if i == number else d for i, d in enumerate(cells)], center)


@pytest.mark.parametrize(("name", "number"), ALL_CELLS)
def test_each_cell_must_be_in_one_piece(name, number):
    vertices, cells, center = partitions()[name]
    singles = [(i,) for i in range(len(cells))]
    for pieces in (
        [p for p in singles if p != (number,)],
        [*singles, (number,)],
        [*singles[:-1], (len(cells) - 1, number)],
        [(len(cells),) if p == (number,) else p for p in singles],
    ):
        with pytest.raises(ValueError, match=f"hold each of the {len(cells)} cells once"):
            Partition(vertices, cells, center, pieces)


@pytest.mark.parametrize(
    ("name", "number"), [(n, i) for n, (_, c, _) in partitions().items() for i in range(12) if i < len(c)]
)
def test_a_cell_behind_each_outer_face(name, number):
    """Put onto an outer face, a cell does not touch the centre: the face between is not in a plane through it."""
    vertices, cells, center = partitions()[name]
    face = Partition(vertices, cells, center).outer_faces[number]
    corners = [exact(vertices[i]) for i in face.vertices]
    top = tuple(2 * a - b for a, b in zip(mean(corners, [1, 1, 1]), exact(center), strict=True))
    bigger = [*cells, (*face.vertices, len(vertices))]
    assert len(Partition([*vertices, top], bigger).cells) == len(bigger)
    with pytest.raises(pas.GeometryError, match="does not pass through its centre"):
        Partition([*vertices, top], bigger, center)


@pytest.mark.parametrize("name", partitions())
def test_a_third_cell_at_each_inner_triangle(name):
    """Smaller than the one on its side and within it, with a vertex of its own: they overlap behind the face."""
    vertices, cells, center = partitions()[name]
    region = Partition(vertices, cells, center)
    assert region.inner_triangles
    for triangle, *owners in region.inner_triangles:
        for owner in owners:
            inside = mean([exact(v) for v in region.corners(region.cells[owner])], [1, 1, 1, 1])
            with pytest.raises(pas.GeometryError, match="overlap"):
                Partition([*vertices, inside], [*cells, (*triangle, len(vertices))])


@pytest.mark.parametrize("corner_", range(4))
def test_the_centre_of_one_cell_is_in_front_of_each_face(corner_):
    vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    weights = [0 if i == corner_ else 1 for i in range(4)]
    on_face = mean([exact(map(Fraction, v)) for v in vertices], weights)
    inside = mean([exact(map(Fraction, v)) for v in vertices], [1 if w == 0 else 10**30 for w in weights])
    beyond = tuple(2 * a - b for a, b in zip(on_face, inside, strict=True))
    assert Partition(vertices, [(0, 1, 2, 3)], inside).center is not None
    for center in (on_face, beyond):
        with pytest.raises(pas.GeometryError, match="not inside the region"):
            Partition(vertices, [(0, 1, 2, 3)], center)


def test_a_gap_between_cells_with_vertices_of_their_own():
    """Eight octants that do not share vertices: no face is shared, though together they fill the region."""
    v, cells = octahedron()
    points = [v[i] for cell in cells for i in cell]
    with pytest.raises(pas.GeometryError, match="not inside the region"):
        Partition(points, [tuple(range(4 * i, 4 * i + 4)) for i in range(8)], v[0])


def test_every_face_of_a_partition_is_inner_or_outer():
    for vertices, cells, center in partitions().values():
        region = Partition(vertices, cells, center)
        count = Counter(f.cell for f in region.outer_faces)
        count.update(c for _, *owners in region.inner_triangles for c in owners)
        assert count == dict.fromkeys(range(len(cells)), 4)
        assert {frozenset((f.first, f.second)) for f in region.interior_faces} == {
            frozenset(owners) for _, *owners in region.inner_triangles
        }
