"""Ways to break a surface of which everything is true, each with what is true afterwards.

Every function takes a random generator and returns a `Known`.  What a break leaves true and what it
makes false follows from the construction (its docstring says how); where it does not, the truth is
UNKNOWN, and a witness still has to be right.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import prod
from random import Random

from adversarial.exact_checks import Point, along_plane, exact, meets, order_across
from adversarial.surface_bases import Known, Truth, base, quadric, sound, with_contacts, with_faces, with_polynomials
from adversarial.surface_disguises import extreme
from adversarial.surface_factors import SIZES, ball_factor, cubed, plane_factor, point_factor, positive_factor, turned
from adversarial.surface_places import circle_point, distance2, in_hull, mean, walls
from flint import fmpq

import pas
from pas import Contact, Partition, PiecewiseSurface, Polynomial
from pas.algebra.inputs import HIGHEST_SURFACE_DEGREE

HOLDS, FAILS, UNKNOWN = Truth.HOLDS, Truth.FAILS, Truth.UNKNOWN
VARIABLES = tuple(map(Polynomial, "xyz"))
Break = Callable[[Random], Known]

NEGLIGIBLE = 10**20
"""What is added changes no inequality if it is so many times smaller than the surface's values: planes with long
coefficients make even 10^-30 large."""

TRIES = 100
"""Faces that are tried on one surface: some have none whose jump stays within the highest degree."""


def jump(random: Random) -> Known:
    """One patch plus `c pi^m` times what vanishes to order k+1 on its other faces and its clips.

    Exactly one face becomes C^(m-1); for m = k + 1 none does.
    """
    known = with_faces(random, 6)
    surface, k = known.surface, known.surface.order
    for _ in range(TRIES):
        number = random.randrange(len(surface.partition.interior_faces))
        face = surface.partition.interior_faces[number]
        piece = random.choice((face.first, face.second))
        bump = untouched(known, piece, leave=number)
        if bump is None:
            continue
        m = random.randint(0, k + 1)
        extra = Polynomial(random.choice(["1", "x + 1/7", "y - z + 3"]))
        if order_across(Polynomial(0), extra, face.plane) >= 0:
            extra = Polynomial(1)
        if bump.degree + m + extra.degree <= HIGHEST_SURFACE_DEGREE:
            break
    else:
        return jump(random)
    c, tiny = amplitude(random)
    term = c * face.plane**m * bump * extra
    tiny = tiny and negligible(term, surface)
    changed = added(surface, {piece: term})
    faces = tuple(FAILS if i == number and m <= k else HOLDS for i in range(len(known.faces)))
    others = HOLDS if tiny else UNKNOWN
    return known.but(
        changed, f"a jump {float(c):.3g} pi^{m} at face {number + 1}", faces=faces, sheet=others, enclosed=others
    )


def one_coefficient(random: Random) -> Known:
    """One coefficient of one patch off by 1e-40 or more.

    What that breaks is found by power series (see `exact_checks`).
    """
    known = with_faces(random) if random.random() < 0.7 else base(random)
    f = known.surface
    piece = random.randrange(len(f.patches))
    exponent = random.choice([(0, 0, 0), (1, 0, 0), (0, 0, f.order), (f.order + 1, 0, 0), (1, 1, 1), (0, 2, 0)])
    c, tiny = amplitude(random)
    changed = with_polynomials(
        f, [p + Polynomial({exponent: c}) if i == piece else p for i, p in enumerate(f.polynomials)]
    )
    story = f"coefficient {exponent} of patch {piece + 1} off by {float(c):.3g}"
    return examined(known.but(changed, story), tiny)


def higher_order(random: Random) -> Known:
    """The same patches, with an order claimed that is one higher, one lower, or much higher."""
    known = base(random)
    f = known.surface
    order = max(0, f.order + random.choice((1, 1, 1, -1, 3)))
    changed = PiecewiseSurface(f.partition, f.contacts, order, f.patches)
    return examined(known.but(changed, f"claimed to be GC^{order}"), True)


def other_contact(random: Random) -> Known:
    """A contact of another radius, or another surface through the same curve."""
    known = with_contacts(random)
    f = known.surface
    number = random.randrange(len(f.contacts))
    old = f.contacts[number]
    c, _ = amplitude(random)
    add = random.choice([Polynomial(abs(c)), c * old.clip, c * old.clip ** (f.order + 1), c * old.clip**f.order])
    contacts = list(f.contacts)
    contacts[number] = Contact(old.surface + add, old.clip)
    changed = PiecewiseSurface(f.partition, contacts, f.order, f.patches)
    result = examined(known.but(changed, f"contact {number + 1} is another surface, off by {float(c):.3g}"), True)
    # beside a curve of another radius the surface leaves the region elsewhere
    return result.but(changed, "", enclosed=HOLDS if add.degree > 0 else FAILS)


def scaled_contact(random: Random) -> Known:
    """Contact polynomials and clips times positive numbers of any size: all stays true."""
    known = with_contacts(random)
    f = known.surface
    contacts = [Contact(c.surface * extreme(random), c.clip * extreme(random)) for c in f.contacts]
    return known.but(PiecewiseSurface(f.partition, contacts, f.order, f.patches), "contacts scaled")


def turned_contact(random: Random) -> Known:
    """A contact that is negative outside: the surface is on its wrong side."""
    known = with_contacts(random)
    f = known.surface
    number = random.randrange(len(f.contacts))
    contacts = [Contact(-c.surface, c.clip) if i == number else c for i, c in enumerate(f.contacts)]
    truths = tuple(FAILS if i == number else HOLDS for i in range(len(contacts)))
    changed = PiecewiseSurface(f.partition, contacts, f.order, f.patches)
    return known.but(changed, f"contact {number + 1} turned round", contacts=truths, enclosed=UNKNOWN)


def lowered(random: Random) -> Known:
    """All patches less `lambda prod h_i^(k+1)`, so that one point of a wall, or the centre, is off.

    Contacts, faces and what happens in the clip planes stay.
    """
    known = base(random, 7)
    f, k = known.surface, known.surface.order
    keep = prod((c.clip ** (k + 1) for c in f.contacts), start=Polynomial(1))
    where = random.choice(("wall", "wall", "centre"))
    if where == "wall":
        face = random.choice(walls(known))
        p = in_hull(known.surface.partition, face.vertices, random)
        piece = face.piece
    else:
        p, piece = exact(f.partition.center), 0
    gap = random.choice([*SIZES, Fraction(0)]) * random.choice((1, 1, -1))
    value = f.polynomials[piece].at(p)
    target = -gap if where == "wall" else gap
    changed = with_polynomials(f, [q + keep * ((target - value) / keep.at(p)) for q in f.polynomials])
    truths: dict[str, object] = {"sheet": UNKNOWN, "enclosed": UNKNOWN}
    if target <= 0 and where == "wall":
        truths["enclosed"] = FAILS
    if target >= 0 and where == "centre":
        truths["sheet"] = FAILS
    return known.but(changed, f"moved to the value {float(target):.3g} at a point: {where}", **truths)


def lowered_alpha(random: Random) -> Known:
    """All patches less `lambda f_i prod h_j^(k+1)`, j other than i, so that alpha is off at a point of clip face i.

    Contacts, faces and what happens in the other clip planes stay.
    """
    while True:
        known = with_contacts(random)
        f, k = known.surface, known.surface.order
        number = random.randrange(len(f.contacts))
        contact, join = f.contacts[number], f.joins[number]
        others = prod((c.clip ** (k + 1) for i, c in enumerate(f.contacts) if i != number), start=Polynomial(1))
        on_curve = random.random() < 0.5
        p = (
            circle_point(contact, random)
            if on_curve
            else in_hull(known.surface.partition, random.choice(join.faces).vertices, random)
        )
        if p is not None and others.degree < 8:
            break
    gap = random.choice([*SIZES, Fraction(0)])
    value = alpha_at(f, join.pieces[0], contact, p)
    changed = added(f, dict.fromkeys(range(len(f.patches)), contact.surface * others * ((-gap - value) / others.at(p))))
    truths = {"sheet": UNKNOWN, "enclosed": UNKNOWN if on_curve and gap == 0 else FAILS}
    truths["contacts"] = tuple(
        (FAILS if on_curve else UNKNOWN) if i == number else HOLDS for i in range(len(f.contacts))
    )
    story = f"alpha is {float(-gap):.3g} at a point of clip face {number + 1}{', on the curve' if on_curve else ''}"
    return known.but(changed, story, **truths)


def local_sheet(random: Random) -> Known:
    """One patch lowered inside its piece alone, so that it is barely negative at a point p outside.

    The bump vanishes on faces, clip faces and walls, and at a point before p on the ray where f > 0:
    the ray goes up, down and up again.
    """
    while True:
        known = with_faces(random, 5)
        f = known.surface
        piece = random.randrange(len(f.patches))
        patch, center = f.polynomials[piece], exact(f.partition.center)
        cell = random.choice([c for c, owner in enumerate(f.partition.piece_of) if owner == piece])
        p = in_hull(known.surface.partition, f.partition.cells[cell], random)
        q = mean([center, p], [1, random.choice((9, 30))])
        bump = untouched(known, piece)
        planes = {w.plane.primitive() for w in walls(known) if w.piece == piece}
        bump = prod(planes, start=bump) * (distance2(center) - distance2(center).at(q))
        if patch.at(q) > 0 and bump.at(p) != 0 and bump.degree <= 12:
            break
    gap = random.choice([*SIZES, Fraction(0)])
    changed = added(f, {piece: bump * ((-gap - patch.at(p)) / bump.at(p))})
    return known.but(changed, f"patch {piece + 1} lowered to {float(-gap):.3g} at a point", sheet=FAILS)


def touching_quadric(random: Random) -> Known:
    """An ellipsoid that stays off the walls of a polytope, touches them or cuts them, by 1e-40 or more."""
    return quadric(random, random.choice([*SIZES, Fraction(0)]) * random.choice((1, 1, -1)))


def inflection(random: Random) -> Known:
    """A surface with one ray that is tangent to it at one point, e = 0; for e > 0 none is.

    f = (x-1)^3 + c (x-1) z^2 + e (x-1) - y has on f = 0 the slope `(x-1)^2 (2x+1) + c z^2 (2x-1) + e`
    along rays: positive for x > 1/2 but where e <= 0, at (1, 0, 0); for x < 1/2 and |y| < 1/8 f < 0.
    """
    e = random.choice([*SIZES[2:], Fraction(0)]) * random.choice((1, -1))
    c = Fraction(random.randint(1, 5), 2)
    x, y, z = VARIABLES
    f = (x - 1) ** 3 + c * (x - 1) * z * z + e * (x - 1) - y
    low = tuple(-Fraction(1, random.randint(17, 30)) for _ in range(3))
    high = (1 + Fraction(1, random.randint(2, 20)), *(Fraction(1, random.randint(17, 30)) for _ in range(2)))
    box = pas.SingleCell(low, high, (0, 0, 0))
    groups = random.choice([[tuple(range(12))], [(2 * i, 2 * i + 1) for i in range(6)]])
    region = Partition(box.vertices, box.cells, (0, 0, 0), groups)
    known = sound(
        PiecewiseSurface.from_polynomials(region, (), 1, [f] * len(groups)), f"inflection with slope {float(e):.3g}"
    )
    return known.but(known.surface, "", sheet=HOLDS if e > 0 else FAILS, enclosed=FAILS)


def examined(known: Known, tiny: bool) -> Known:
    """Contacts and faces by power series; the inequalities as they were where the change is tiny.

    A proof has margins above 1e-16 of every polynomial, so a change by 1e-30 leaves it true.
    """
    f = known.surface
    faces = tuple(
        HOLDS if order_across(f.polynomials[i.first], f.polynomials[i.second], i.plane) >= f.order else FAILS
        for i in f.partition.interior_faces
    )
    contacts = []
    for contact, join in zip(f.contacts, f.joins, strict=True):
        met = all(meets(f.polynomials[piece], contact.surface, contact.clip, f.order) for piece in join.pieces)
        contacts.append((HOLDS if tiny else UNKNOWN) if met else FAILS)
    others = {} if tiny else {"sheet": UNKNOWN, "enclosed": UNKNOWN}
    return known.but(f, "", faces=faces, contacts=tuple(contacts), **others)


def added(surface: PiecewiseSurface, terms: dict[int, Polynomial]) -> PiecewiseSurface:
    """Some patches plus polynomials (in the user's coordinates)."""
    zero = Polynomial(0)
    return with_polynomials(surface, [p + terms.get(i, zero) for i, p in enumerate(surface.polynomials)])


def untouched(known: Known, piece: int, leave: int | None = None) -> Polynomial | None:
    """What vanishes to order k+1 on a piece's interior faces (all but `leave`) and in its clip planes.

    None where the plane of the face to leave carries another face of the piece.
    """
    f, k = known.surface, known.surface.order
    faces = f.partition.interior_faces
    planes = {i.plane.primitive() for n, i in enumerate(faces) if piece in (i.first, i.second) and n != leave}
    if leave is not None and faces[leave].plane.primitive() in planes:
        return None
    clips = {c.clip.primitive() for c, join in zip(f.contacts, f.joins, strict=True) if piece in join.pieces}
    return prod((p ** (k + 1) for p in planes | clips), start=Polynomial(1))


def negligible(term: Polynomial, surface: PiecewiseSurface) -> bool:
    """Whether what is added is, everywhere in the region, nothing beside the surface's largest value at its corners."""
    corners = surface.partition.vertices
    reach = max(abs(c) for v in corners for c in v)
    bound = sum((abs(c) * reach ** sum(e) for e, c in term.raw.to_dict().items()), fmpq(0))
    return bool(bound * NEGLIGIBLE < max(abs(p.raw(*v)) for p in surface.polynomials for v in corners))


def amplitude(random: Random) -> tuple[Fraction, bool]:
    """A number of any size and sign, and whether it is too small to change an inequality."""
    exponent = random.choice((0, 2, 5, 12, 30, 40, 300))
    return Fraction(random.choice((1, -1)) * random.randint(1, 9), 10**exponent), exponent >= 30


def alpha_at(surface: PiecewiseSurface, piece: int, contact: Contact, p: Point) -> Fraction:
    """The value at a point of the clip plane of the factor with which a patch is a multiple of its contact there."""
    patch, f = (parts[0] for parts in along_plane(contact.clip, surface.polynomials[piece], contact.surface))
    quotient, remainder = divmod(patch.raw, f.raw)
    assert remainder.is_zero()
    return Polynomial.from_raw(quotient).at(p)


BREAKS: dict[str, Break] = {
    f.__name__: f
    for f in (
        *(ball_factor, point_factor, positive_factor, plane_factor, turned, cubed),
        *(jump, one_coefficient, higher_order, other_contact, scaled_contact, turned_contact),
        *(lowered, lowered_alpha, local_sheet, touching_quadric, inflection),
    )
}
