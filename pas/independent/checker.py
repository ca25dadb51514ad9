"""`pas check --independent`: the claims of a blend, proved again from its project file by other means.

Exact rational arithmetic alone.  Each claim is stated here as a definition, with why what is computed implies it; the
claims are those of `pas.certify.proofs`, and one more on the region.  Terms: R is the union of the cells, o the centre,
g the patch of each cell; contact i has a surface f and a clip h.  Its clip faces are the faces of R in the plane h = 0.
A contact without clip faces may be the opening: then h = q is a cone with apex o, and Q is the set q <= 0.  The surface
is S, the zeros of g in R, or in R and Q where there is an opening.

Region.  Claim: R holds each ray from o, or each in a convex cone, from o as far as one of its outer faces, in one cell.
Computed: cells lie on either side of common faces, interior faces in planes through o, outer ones look at o, and a ray
in general position leaves through one of them only.  The outer faces then cover the sphere of directions, or the cone,
once: the number of times is that of a map without folds, and the same everywhere.

Face.  Claim: two patches agree up to derivatives of order k.  Computed: with t, the barycentric coordinate across the
face, their difference has no terms up to t^k.

Contact.  Claim: V(f, h) has in R one part at which S ends, all of it regular, and there g = alpha f + O(h^(k+1)) with
alpha > 0 (Garrity and Warren 1991).  Computed in clip faces: f > 0 on their border, the gradient of f along the face is
not 0 where f = 0, h < 0 on the side of R, and, as series in t, alpha = g / f exists up to t^k: f_0 divides g_0, then
g_1 - alpha_0 f_1, and so on; factors of f_0 that are positive on the face may divide alpha, since the curve is
elsewhere.  Computed for the opening: see `_opening`.

One sheet.  Claim: a ray from o meets S once at most, and at an angle.  Computed: g < 0 at o, and along rays g rises
wherever it is 0.

Enclosed.  Claim: where S is on the border of R, or of R and Q, it is on the curve of a contact.  That border lies in
the triangles that one cell only has, whatever they are called, and in q = 0.  Computed for each such triangle: it is a
clip face on which g is a positive multiple of the product of the f clipped there, so that g = 0 on their curves alone;
or it passes through o and is outside of Q but for o, where g < 0; or g > 0 on it.  On q = 0 it was computed that g is
a positive multiple of f (see `_opening`).  A contact that is neither clipped nor the one opening leaves this undecided.

Lemmas that both checkers use: positive coefficients of a Bernstein form (of g + t f where f = 0 matters) bound a
polynomial, and membership in the ideal <f, h^(k+1)> at the points of a curve is contact of order k there.

Undecided: clips that are neither planes nor cones through which a region is open, and curves met in part only where no
factor over the rationals tells the parts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import combinations, count, product
from math import prod
from pathlib import Path
from typing import Any, NamedTuple, Unpack

from flint import fmpq, fmpq_mat, fmpq_mpoly

from pas.algebra.inputs import shown
from pas.errors import ProjectFileError
from pas.exchange.files import read_project, understood
from pas.independent.reading import Face, Surface
from pas.independent.signs import ONE, PROVED, REFUTED, RING, UNDECIDED, ZERO, Point, Query, on_simplex, positive
from pas.limits import WorkLimits, limited

SIDE_BUDGET = 100_000
"""Coefficients for questions on the way: the sign of a factor, a place where a contact is missed."""


class Finding(NamedTuple):
    """The outcome of a claim; `witness`: an exact point where it fails, or the ends of a segment on which it does."""

    claim: str
    status: str
    reason: str
    witness: tuple[Point, ...] = ()

    @property
    def proved(self) -> bool:
        """Whether the claim holds beyond doubt."""
        return self.status == PROVED

    def __str__(self) -> str:
        where = ("", "; at ", "; between ")[len(self.witness)]
        points = " and ".join(f"({x}, {y}, {z})" for x, y, z, _ in self.witness)
        return f"{self.claim:<14} {self.status:<9} {self.reason}{where}{points}"

    def to_record(self) -> dict[str, Any]:
        """A JSON-ready form; coordinates are strings such as "1/3"."""
        return self._asdict() | {"witness": [[str(c) for c in point[:3]] for point in self.witness]}


@limited("proving by the independent checker", "")
def check_independently(path: str | Path, *, edited: bool = False, **limits: Unpack[WorkLimits]) -> list[Finding]:
    """Prove again what the project file of a blend claims.

    Raises `ProjectFileError` for a file that is none, was changed (unless `edited`), or holds no blend.
    """
    content, name = read_project(path, edited=edited), Path(path).name
    if content.get("kind", "blend") != "blend":
        raise ProjectFileError(f"{name}: the independent checker reads blends, and this holds {shown(content['kind'])}")
    with understood(name):
        surface = Surface(content.get("surface"))
    region, contacts = _region(surface), [_contact(surface, number) for number in range(len(surface.contacts))]
    pairs = sorted({(a.patch, b.patch) for a, b in surface.inner if a.patch != b.patch})
    faces = [_smooth(surface, *pair) for pair in pairs]
    return [region, *contacts, *faces, _one_sheet(surface, region), _enclosed(surface, contacts)]


def _region(surface: Surface) -> Finding:
    """The cells cover a region around the centre once, and each is seen undivided from it."""
    claim, centre = "region", surface.centre
    for face, *others in surface.faces:
        if face in surface.sides:
            continue
        side, *beyond = (_det(*f.corners, f.off) for f in (face, *others))
        seen = _det(*face.corners, centre) * side if centre else 0
        if side == 0 or len(others) > 1 or (others and side * beyond[0] >= 0):
            return Finding(claim, REFUTED, "cells are flat or overlap", (_inside(face),))
        if centre and (seen != 0 if others else seen <= 0):
            reason = "an interior face misses the centre, or an outer face does not look at it"
            return Finding(claim, REFUTED, reason, (_inside(face),))
    if not centre or not surface.cells:
        return Finding(claim, UNDECIDED, "there is no centre to look from")
    if surface.open and not surface.sides:
        return Finding(claim, REFUTED, "the region is not open at its centre", (centre,))
    for flank in surface.sides:
        inner = _det(*flank.corners, flank.off)
        outside = tuple(p for cell in surface.cells for p in cell if _det(*flank.corners, p) * inner < 0)
        if outside or inner == 0:
            return Finding(claim, REFUTED, "the cells fill no convex cone around the centre", outside[:1])
    first = surface.outer[0].corners
    for s in count(1):  # the directions a + s b + s^2 c meet the plane of the centre and an edge twice at most
        way = (a + s * b + s * s * c - (1 + s + s * s) * o for a, b, c, o in zip(*first, centre, strict=True))
        ray, at = tuple(way), [face.corners for face in surface.outer]
        turns = [[_det(centre, *t) for t in ((a, b, c), (ray, b, c), (a, ray, c), (a, b, ray))] for a, b, c in at]
        if all(value != 0 for turn in turns for value in turn):
            break
    times = sum(min(volume * u for u in turn) > 0 for volume, *turn in turns)
    if times != 1:
        return Finding(claim, REFUTED, f"the cells surround the centre {times} times", (centre,))
    return Finding(claim, PROVED, "the cells surround the centre once")


def _contact(surface: Surface, number: int) -> Finding:
    """GC^k along the contact's curve in its clip faces: a closed regular curve, alpha > 0, h < 0 on this side."""
    claim, faces, (f, h) = f"contact {number + 1} GC^{surface.order}", surface.clipped[number], surface.contacts[number]
    if not faces and surface.sides and surface.centre and h.total_degree() == 2:
        return _opening(surface, number, claim, surface.centre)
    if not faces:
        return Finding(claim, UNDECIDED, "no outer face lies in its clip, or the clip is no plane")
    behind = tuple(face.off for face in faces if h(*face.off) > 0)
    if behind:
        return Finding(claim, REFUTED, "its clip is turned round: h > 0 on the blend's side", behind[:1])
    looks = [(face.corners, *_quotient(surface, number, face)) for face in faces]
    order = min(len(alpha) for _, _, alpha, _, _ in looks) - 1
    if order < surface.order:
        missed = [Query(c, -rest * rest, f0) for c, f0, _, _, rest in looks if not rest.is_zero()]
        status, witness = positive(missed, SIDE_BUDGET)
        reason = f"it is met with GC^{order} only" if order >= 0 else "it is not met at all"
        if status != REFUTED:
            return Finding(claim, UNDECIDED, f"{reason}, but perhaps not on its clip face")
        return Finding(claim, REFUTED, reason, witness)
    if positive([Query(c, f0) for c, f0, *_ in looks])[0] != REFUTED:
        return Finding(claim, UNDECIDED, "no point of its clip face is known to be on or inside it")
    edges = Counter(edge for face in faces for edge in combinations(face.corners, 2))
    others = [cell for i, cell in enumerate(surface.cells) if i not in {face.cell for face in faces}]
    steps = {
        "its curve is closed inside its clip face": [Query(e, on_simplex(f, e)) for e, n in edges.items() if n == 1],
        "its clip cuts it at an angle": [Query(c, _slope(f0), f0) for c, f0, *_ in looks],
        "it is met, with alpha > 0 on its curve": [Query(c, alpha[0], f0) for c, f0, alpha, _, _ in looks],
    }
    found = next((f for f in (_shown(claim, *step) for step in steps.items()) if not f.proved), None)
    inside = [Query(cell, on_simplex(f * f, cell), on_simplex(h, cell)) for cell in others]
    if found is None and positive(inside, SIDE_BUDGET)[0] != PROVED:
        return Finding(claim, UNDECIDED, "its clip may cut it inside the region as well")
    return found or Finding(claim, PROVED, "; ".join(steps))


def _opening(surface: Surface, number: int, claim: str, centre: Point) -> Finding:
    """GC^k with a surface f along its curve on a cone h around the centre, all over which alpha > 0.

    Claim: V(f, h) is in R one regular closed curve, all of it the border of S in h = 0, and there g = alpha f up to
    h^(k+1) with alpha > 0.  Computed: the cone h = 0 is in R but for o inside its sides, and the curves of all other
    contacts, hence all that they surround, as the nappe is convex, are inside of it.  So its rays leave R through
    walls, where g > 0, and begin in o, where g < 0.  With alpha > 0 g and f have one sign on them, and one zero.

    By degree in the coordinates from the centre f begins with a number that is not 0, so g / f is a series, modulo
    h^(k+1) the one series alpha with `g = alpha f`; of a member it ends, and g - alpha f is a multiple of h^(k+1).
    """
    (f, h), k = surface.contacts[number], surface.order
    if f(*centre) >= 0 or any(h.derivative(i)(*centre) != 0 for i in range(4)):
        return Finding(claim, UNDECIDED, "the centre is not inside its surface, or its clip is no cone around that")
    if not any(h(*p) < 0 for cell in surface.cells for p in cell):
        return Finding(claim, UNDECIDED, "no point of the region is known to be inside the clip")
    others = [i for i in range(len(surface.contacts)) if i != number]
    if not all(surface.clipped[i] for i in others):
        return Finding(claim, UNDECIDED, "another contact has no clip face, and a region is open through one at most")
    curves = [(face, face.series(surface.contacts[i][0], 0)[0]) for i in others for face in surface.clipped[i]]
    forms, power, parts = _by_degree(f, centre), _by_degree(h, centre)[-1] ** (k + 1), list[Query]()
    alphas = list[fmpq_mpoly]()
    for patch in surface.patches:
        alpha = _series(_by_degree(patch, centre), forms, power)
        if alpha is None:
            return Finding(claim, UNDECIDED, "a patch does not meet it to its order all along the curve")
        alphas.append(alpha.compose(*_seen_from(centre, -1), ctx=RING))
    for i, cell in enumerate(surface.cells):
        parts.append(Query(cell, on_simplex(alphas[surface.patch_of[i]], cell), on_simplex(h, cell)))
    edges = [tuple(p for p in side.corners if p != centre) for side in surface.sides]
    around = [Query(edge, on_simplex(h, edge)) for edge in edges]
    within = [Query(face.corners, -on_simplex(h, face.corners), f0) for face, f0 in curves]
    steps = {
        "its clip is inside the sides of the region": around,
        "the other curves are inside its clip": within,
        "alpha > 0 all over its clip": parts,
    }
    found = next((f for f in (_shown(claim, *step) for step in steps.items()) if not f.proved), None)
    return found or Finding(claim, PROVED, "; ".join(("it is met exactly", *steps)))


def _by_degree(p: fmpq_mpoly, centre: Point) -> list[fmpq_mpoly]:
    """The forms of degree 0, 1, ... of a polynomial in the coordinates from the centre."""
    degree, terms = p.total_degree(), p.compose(*_seen_from(centre, 1), ctx=RING).to_dict()
    found: list[dict[tuple[int, ...], Any]] = [{} for _ in range(degree + 1)]
    for e, c in terms.items():
        found[degree - e[3]][(*e[:3], 0)] = c
    return [RING.from_dict(form) for form in found]


def _seen_from(centre: Point, sign: int) -> list[fmpq_mpoly]:
    """The variables moved by the centre, to it (1) or back (-1)."""
    *axes, one = RING.gens()
    return [*(x + sign * c * one for x, c in zip(axes, centre, strict=False)), one]


def _series(g: list[fmpq_mpoly], f: list[fmpq_mpoly], power: fmpq_mpoly) -> fmpq_mpoly | None:
    """alpha with `g = alpha f` modulo a form, all by degree and f_0 a number; None where no polynomial is."""
    found: list[fmpq_mpoly] = []
    for j in range(len(g) + len(f) - 1):
        known = sum((found[i] * f[j - i] for i in range(max(0, j - len(f) + 1), min(j, len(found)))), ZERO)
        rest = divmod((g[j] if j < len(g) else ZERO) - known, power)[1]
        if j < len(g):
            found.append(rest / f[0].leading_coefficient())
        elif not rest.is_zero():
            return None
    last = RING.gens()[3]
    return sum((form * last ** (len(found) - 1 - j) for j, form in enumerate(found)), ZERO)


def _quotient(surface: Surface, number: int, face: Face) -> tuple[fmpq_mpoly, list[fmpq_mpoly], fmpq_mpoly, fmpq_mpoly]:
    """The patch divided by a contact's surface, as series across a clip face.

    f_0; w alpha_0, w^2 alpha_1, ... as far as u = f_0 / w divides, w > 0 on the face; u; and what is left, or 0.
    """
    f, g = (face.series(p, surface.order) for p in (surface.contacts[number][0], surface.patches[face.patch]))
    for w in _denominators(f[0], face.corners):
        u, rest, alpha = divmod(f[0], w)[0], ZERO, list[fmpq_mpoly]()
        for j, value in enumerate(g):
            known = sum((a * f[j - i] * w ** (j - 1 - i) for i, a in enumerate(alpha)), ZERO)
            quotient, rest = divmod(w**j * value - known, u)
            if not rest.is_zero():
                break
            alpha.append(quotient)
        else:
            break
    return f[0], alpha, u, rest


def _denominators(f: fmpq_mpoly, corners: tuple[Point, ...]) -> Iterator[fmpq_mpoly]:
    """1 and, for where that does not do, the product of all factors of f that are positive on a face."""
    yield ONE
    signed = [(sign * p, power) for p, power in f.factor()[1] for sign in (1, -1)]
    yield prod((p**n for p, n in signed if positive([Query(corners, p)], SIDE_BUDGET)[0] == PROVED), start=ONE)


def _slope(f: fmpq_mpoly) -> fmpq_mpoly:
    """The square of the slope as if the triangle's sides were (1, 0) and (0, 1): both vanish together."""
    return sum(((f.derivative(i) - f.derivative(0)) ** 2 for i in (1, 2)), ZERO)


def _smooth(surface: Surface, first: int, second: int) -> Finding:
    """C^k between two patches, on all faces where they meet."""
    claim = f"face {first + 1}|{second + 1} C^{surface.order}"
    difference = surface.patches[second] - surface.patches[first]
    for face in (a for a, b in surface.inner if (a.patch, b.patch) == (first, second)):
        for j, jump in enumerate(face.series(difference, surface.order)):
            if not jump.is_zero():  # a lattice finer than its degree has a point where it does not vanish
                n = jump.total_degree() + 3
                weights = next(w for w in product(range(1, n), repeat=3) if sum(w) == n and jump(*w, 0) != 0)
                return Finding(claim, REFUTED, f"derivative {j} across the face jumps", (_inside(face, weights),))
    return Finding(claim, PROVED, f"the difference has no terms up to t^{surface.order}")


def _one_sheet(surface: Surface, region: Finding) -> Finding:
    """In each cell grad g . (x - centre) > 0 where g = 0, and g < 0 at the centre."""
    claim, centre = "one sheet", surface.centre
    if not centre or not surface.cells:
        return Finding(claim, UNDECIDED, "there is no centre to look from")
    if any(patch(*centre) >= 0 for patch in surface.patches):
        return Finding(claim, REFUTED, "the centre is not inside", (centre,))
    if not region.proved:
        return Finding(claim, UNDECIDED, "the cells were not shown to surround the centre once")
    parts, (*axes, one) = [], RING.gens()
    for number, cell in enumerate(surface.cells):
        g = surface.patches[surface.patch_of[number]]
        radial = sum(((x - centre[i] * one) * g.derivative(i) for i, x in enumerate(axes)), ZERO)
        parts.append(Query(cell, on_simplex(radial, cell), on_simplex(g, cell)))
    return _shown(claim, "grad g . (x - centre) > 0 where g = 0", parts)


def _enclosed(surface: Surface, contacts: list[Finding]) -> Finding:
    """On the border g is positive times the f_0 of the contacts clipped there; but for sides outside of an opening."""
    claim, parts = "enclosed", list[Query]()
    free = [met for faces, met in zip(surface.clipped, contacts, strict=True) if not faces]
    opened = len(free) == 1 and free[0].proved
    if not surface.cells or (free and not (surface.sides and opened)):
        return Finding(claim, UNDECIDED, "there is no region, or a contact without a face in its clip plane")
    for face in surface.outer if opened else (*surface.sides, *surface.outer):
        rest = face.series(surface.patches[face.patch], 0)[0]
        for number in (i for i, faces in enumerate(surface.clipped) if face in faces):
            rest, remainder = divmod(rest, _quotient(surface, number, face)[2])
            if not remainder.is_zero():
                return Finding(claim, UNDECIDED, f"contact {number + 1} is not met on its clip face")
        parts.append(Query(face.corners, rest))
    return _shown(claim, "g > 0 on the walls, alpha > 0 on the clip faces", parts)


def _shown(claim: str, condition: str, parts: list[Query]) -> Finding:
    """The finding that a claim's condition holds, fails or is open."""
    status, witness = positive(parts)
    said = {PROVED: "", REFUTED: "it fails that ", UNDECIDED: "open whether "}
    return Finding(claim, status, said[status] + condition, witness)


def _det(*points: Point) -> fmpq:
    return fmpq_mat([list(p) for p in points]).det()


def _inside(face: Face, weights: tuple[int, ...] = (1, 1, 1)) -> Point:
    """The point of a face with barycentric coordinates of these ratios."""
    columns = zip(*face.corners, strict=True)
    return tuple(sum((w * c for w, c in zip(weights, x, strict=True)), fmpq(0)) / sum(weights) for x in columns)
