"""The proofs and the measurements of a generatrix blend; the status of each verdict says which it is.

Contact (G1): along its boundaries the blend has the tangents C' and 3 l T, T a combination of W and C'.  For rational
data it is proved that these lie in the surface's tangent plane and span it: C' . N = W . N = 0 identically, no zero
of C' or W in [0, 1], l > 0 and |lambda| < 1; an exact blend is also looked at itself, from its components.
Ellipses in closed form have rounded vectors; what that does is bounded for all s.  For other numeric data the
greatest angle between the two tangent planes is measured.

Sense: open exact curves run the same way if their chords make an acute angle; where that agrees with what was found
in aligning them, it is the proof.  Otherwise the finding, by samples of the curves, is a measurement.

Regularity: exact blends by `pas.parametric.regularity`.  Else along many generatrices for all t at once: the
normal is a polynomial in t of degree 2m - 1, whose Bernstein coefficients must be on one side of a plane
through the origin (halving t where they are not); between generatrices the turn of the normal is measured.

Simple: exact blends that do not bend too far are proved to be so (`is_injective`).  Else crossings of the triangles of
a mesh.  A crossing is followed to a double point of the surface itself,
P(s, t) = P(s', t'), by Newton's method, and reported with it.

A surface is proved to take no point twice as follows: if for two vectors a, b the symmetric part of the matrix

    ( a . P_s   a . P_t )
    ( b . P_s   b . P_t )

is positive definite on the whole (convex) square, then for two places that differ by (u, v) the number
(u a + v b) . (P - P') is the mean of this form at (u, v) along the way between them, hence positive: P != P'
(the monotone case of Gale and Nikaido 1965).  With a, b dual to the mean tangents the matrix is near the unit
matrix for surfaces that do not bend too far.  The two inequalities are proved by Bernstein branch and bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np
from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.lengths import exponent, lengths
from pas.algebra.rational import dot, exact, rational, to_float, to_fraction
from pas.algebra.rational_function import GENERATORS, ONE, RationalFunction, total
from pas.arrays import Floats
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.contacts.ends import triple
from pas.mesh.crossings import crossings
from pas.parametric.common_zeros import avoids_origin
from pas.parametric.generatrix.align import alignment
from pas.parametric.generatrix.form import GeneratrixForm
from pas.parametric.generatrix.paths import NAMES
from pas.parametric.maps import ParametricMap
from pas.parametric.nets import PlacedNets
from pas.parametric.regularity import positive_on_unit_square, regularity
from pas.verdicts import Status, Verdict, Verdicts

EFFORT = 4_000
"""Rectangles that proofs of exact blends may examine."""


@dataclass(frozen=True)
class GeneratrixCertificate(Verdicts):
    """All verdicts about one blend.

    `contacts`: G1 with each surface.  `sense`: the curves run the same way round.  `regular`: the normal vanishes
    nowhere.  `simple`: the blend does not cross itself.
    """

    contacts: tuple[Verdict, Verdict]
    sense: Verdict
    regular: Verdict
    simple: Verdict
    partly_measured = True

    __repr__ = brief

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        return (*self.contacts, self.sense, self.regular, self.simple)


def certify(blend: GeneratrixForm) -> GeneratrixCertificate:
    """All verdicts."""
    contacts = contact_verdict(blend, 0), contact_verdict(blend, 1)
    return GeneratrixCertificate(contacts, sense_verdict(blend), regular_verdict(blend), simple_verdict(blend))


def contact_verdict(blend: GeneratrixForm, number: int) -> Verdict:
    """G1 with surface `number`."""
    boundary = blend.boundaries[number]
    claim = f"G1 with {boundary.name}"
    if boundary.exact is not None:
        if not boundary.exact.lies_in_plane:
            return Verdict(Status.REFUTED, claim, "the curve or the vector given is not in the tangent plane")
        if blend.surface.is_exact and not _touches(blend, number):
            return Verdict(Status.REFUTED, claim, "the tangent planes of the exact blend differ")
        reason = "both tangents are perpendicular to the surface's normal identically, and span its tangent plane"
        return Verdict(Status.PROVED, claim, reason)
    bounds = None if boundary.bounds is None else boundary.bounds()
    if bounds is None or bounds.angle > 1e-9:  # larger ones come from badly scaled data
        return _measured_contact(blend, number, claim)
    # the blend's tangent plane is spanned by C' and N x C', so its angle with the surface's is that of C'
    reason = (
        f"for all s, by exact arithmetic on the rounded curve, its tangent planes differ from the surface's by "
        f"{np.degrees(bounds.angle):.1e} degrees at most, and it is {bounds.distance:.1e} off the surface at most"
    )
    return Verdict(Status.PROVED, f"{claim}, to rounding", reason)


def _touches(blend: GeneratrixForm, number: int) -> bool:
    """Whether P(s, i) is the curve and P_s, P_t there are perpendicular to N, from the components alone."""
    boundary = blend.boundaries[number]
    exact = boundary.exact
    assert exact is not None
    s = RationalFunction.quotient(1 - GENERATORS[0] if boundary.backwards else GENERATORS[0], ONE, NAMES)
    end = RationalFunction.quotient(ONE * number, ONE, NAMES)

    def at_end(order: tuple[int, int]) -> list[RationalFunction]:
        return [c.diff(*order).substitute(s, end) for c in blend.surface.components]

    on = at_end((0, 0)) == list(exact.curve)
    return on and all(dot(at_end(order), exact.normal).is_zero for order in ((1, 0), (0, 1)))


def _measured_contact(blend: GeneratrixForm, number: int, claim: str) -> Verdict:
    boundary, samples = blend.boundaries[number], 257
    s = np.linspace(0.0, 1.0, samples)
    places, points = np.stack([s, np.full(samples, float(number))], axis=-1), boundary(s)
    sines = lengths(np.cross(blend.surface.normals(places), boundary.normals(s)))
    gaps = lengths(blend.surface(places) - points)
    if not (np.isfinite(sines).all() and np.isfinite(gaps).all()):
        i = int(np.flatnonzero(~np.isfinite(sines + gaps))[0])
        return Verdict(Status.UNDECIDED, claim, f"numeric data; at s = {s[i]:.5g} the blend has no tangent plane")
    worst = float(np.degrees(np.arcsin(min(1.0, float(sines.max())))))
    reason = (
        f"numeric data, at {samples} points: the tangent planes differ by {worst:.1e} degrees at most, the "
        f"curves by {gaps.max():.1e}"
    )
    tilted = worst > 1e-3  # degrees
    if tilted or gaps.max() > 1e-6 * float(np.ptp(points, axis=0).max()):
        i = int(sines.argmax() if tilted else gaps.argmax())
        return Verdict(Status.FAILS_MEASURED, claim, reason, triple(points[i]))
    return Verdict(Status.HOLDS_MEASURED, claim, reason)


def sense_verdict(blend: GeneratrixForm) -> Verdict:
    """Whether the curves run the same way."""
    # judged anew of the curves as they run now, since a blend from a file brings its own alignment
    found = alignment(*blend.boundaries, blend.frames.signs, turn=False)
    claim, proof = "the two curves run the same way", ""
    same = _chords_agree(blend)
    if same is not None and same is not found.opposed:
        proof = f"their chords make {'an acute' if same else 'an obtuse'} angle"
    reason = proof or found.reason
    if found.opposed:
        reason += ": the blend is twisted; reverse one curve, or let them be aligned (align=True)"
        return Verdict(Status.REFUTED if proof else Status.FAILS_MEASURED, claim, reason)
    reason += "; the second was reversed" if blend.alignment.reversed else ""
    return Verdict(Status.PROVED if proof else Status.HOLDS_MEASURED, claim, reason)


def _chords_agree(blend: GeneratrixForm) -> bool | None:
    """Whether the chords of two open exact curves make an acute angle (exactly); None where that says nothing."""
    chords = []
    for boundary in blend.boundaries:
        if boundary.closed or boundary.exact is None:
            return None
        sign = -1 if boundary.backwards else 1
        chords.append([(c.at(1, 0) - c.at(0, 0)) * sign for c in boundary.exact.curve])
    product = dot(*chords)
    return None if product == 0 else bool(product > 0)


def regular_verdict(blend: GeneratrixForm) -> Verdict:
    """Whether the normal vanishes nowhere."""
    claim, number = "regular", 256
    if blend.surface.is_exact:
        exact = regularity(blend.surface, EFFORT)
        if exact.status in (Status.PROVED, Status.REFUTED):
            return Verdict(exact.status, claim, exact.reason, exact.witness, exact.measure)
    s = blend.frames.parameters(number)
    controls, slopes = blend.frames.at(s).controls(blend.shape)
    forms = _normal_forms(*(np.ldexp(c, -exponent(c)) for c in (controls, slopes)))
    points, normals = blend.frames.sheet(blend.shape, (number, 33))
    if not (np.isfinite(points).all() and np.isfinite(forms).all()):
        return Verdict(Status.UNDECIDED, claim, "the blend is not finite on all generatrices tried; change l1, l2")
    halvings = 8
    zero = _vanishing(forms, halvings)
    if zero is not None:
        place = s[zero[0]], zero[1]
        where = "s = {:.5g}, t = {:.5g}".format(*place)
        reason = f"the normal vanishes (to {halvings} halvings of t) near {where}; change l1, l2"
        return Verdict(Status.FAILS_MEASURED, claim, reason, triple(blend.surface(place)))
    sizes = np.linalg.norm(normals, axis=-1)
    angle, where_most = _largest_turn(normals, blend.closed)
    measured = (
        f"on {number} generatrices the normal vanishes for no t, its least length is "
        f"{sizes.min() / np.median(sizes):.2g} of the median, and between neighbours it turns by {angle:.3g} degrees "
        "at most"
    )
    if angle >= 90.0:
        reason = measured + ": the blend folds over; change l1, l2"
        return Verdict(Status.FAILS_MEASURED, claim, reason, triple(points[where_most]))
    return Verdict(Status.HOLDS_MEASURED, claim, measured)


def _normal_forms(controls: Floats, slopes: Floats) -> Floats:
    """Bernstein coefficients in t of P_s x P_t / m: (n, 2m, 3)."""
    m = len(controls) - 1
    legs = np.diff(controls, axis=0)
    forms = np.zeros((controls.shape[1], 2 * m, 3))
    for i, j in np.ndindex(m + 1, m):
        weight = comb(m, i) * comb(m - 1, j) / comb(2 * m - 1, i + j)
        forms[:, i + j] += weight * np.cross(slopes[i], legs[j])
    return forms


def _vanishing(forms: Floats, halvings: int) -> tuple[int, float] | None:
    """Of curves of vectors (n, k, 3), Bernstein forms in t, the number of one that may meet the origin, and t near."""

    def judge(arcs: PlacedNets, _: int) -> Fates:
        return np.where(avoids_origin(arcs.table, arcs.off.max(axis=(1, 2))), int(Fate.SETTLED), int(Fate.SPLIT))

    rows, off = np.arange(len(forms)), 1e-13 * np.abs(forms).max(axis=(1, 2), keepdims=True)
    start = np.stack([0 * rows, rows], axis=1)  # the second place, never halved, tells the curve
    whole = PlacedNets(forms[:, :, None], off + np.zeros((*forms.shape[:2], 1)), start, 0 * start)
    limits, task = Limits(halvings, 1 << 20), "looking for vanishing normals"
    left = search(whole, judge, lambda arcs: arcs.halves(0), limits, task).open
    if not len(left):
        return None
    place, row = left.start[left.start[:, 1].argmin()].tolist()
    return row, (place + 0.5) / 2**halvings


def _largest_turn(normals: Floats, closed: bool) -> tuple[float, tuple[int, int]]:
    """The greatest angle in degrees between normals (n, m, 3) of neighbours in s, and where."""
    rows = np.concatenate([normals, normals[:1]]) if closed else normals
    with np.errstate(all="ignore"):
        rows = rows / np.linalg.norm(rows, axis=-1, keepdims=True)
    cosine = np.nan_to_num((rows[1:] * rows[:-1]).sum(axis=-1), nan=-1.0)
    i, j = np.unravel_index(int(cosine.argmin()), cosine.shape)
    return float(np.degrees(np.arccos(np.clip(cosine[i, j], -1.0, 1.0)))), (int(i), int(j))


def is_safe(blend: GeneratrixForm, size: tuple[int, int]) -> bool:
    """Whether on a mesh of this size no triangles cross and no normal turns by a right angle between neighbours."""
    normals = blend.frames.sheet(blend.shape, size)[1]
    turns = (_largest_turn(normals, blend.closed), _largest_turn(normals.swapaxes(0, 1), False))
    if max(angle for angle, _ in turns) >= 90.0:
        return False
    mesh = blend.gridded(size)
    return not len(crossings(mesh.points, mesh.triangles)[0])


def simple_verdict(blend: GeneratrixForm, size: tuple[int, int] = (160, 40)) -> Verdict:
    """Whether the blend does not cross itself: on a mesh, and at double points found from its crossings."""
    claim = "does not cross itself"
    if blend.surface.is_exact and is_injective(blend.surface, EFFORT):
        return Verdict(Status.PROVED, claim, "the map from the square is monotone with respect to its mean tangents")
    mesh = blend.gridded(size)
    pairs, where = crossings(mesh.points, mesh.triangles)
    on = f"a mesh of {size[0]} x {size[1]} points ({len(mesh.triangles)} triangles)"
    if not len(pairs):
        return Verdict(Status.HOLDS_MEASURED, claim, f"on {on} no triangles cross")
    assert mesh.parameters is not None
    found = double_point(blend.surface, mesh.parameters[mesh.triangles[pairs, 0]], blend.closed)
    if found is None:
        reason = f"on {on} {len(pairs)} pairs of triangles cross, but no double point of the surface was found"
        return Verdict(Status.FAILS_MEASURED, claim, reason, triple(where[0]), len(pairs))
    (s, t), (u, v) = found[0]
    reason = (
        f"P({s:.5g}, {t:.5g}) = P({u:.5g}, {v:.5g}) to {found[2]:.1e}; {len(pairs)} pairs of triangles cross on "
        f"{on}; shorten l1, l2 (see largest_safe), or lead the blend round by a middle curve"
    )
    return Verdict(Status.FAILS_MEASURED, claim, reason, triple(found[1]), len(pairs))


def double_point(surface: ParametricMap, pairs: Floats, closed: bool) -> tuple[Floats, Floats, float] | None:
    """Two places (2, 2) of one point of a surface over [0, 1]^2 near one of some pairs (k, 2, 2), the point, the gap.

    By Newton's method from twelve of the pairs; None where it finds none.  Where `closed` the first parameter goes
    round.
    """
    places = pairs[np.linspace(0, len(pairs) - 1, min(12, len(pairs))).astype(int)]
    for _ in range(25):
        points, tangents = surface(places), surface.tangents(places)
        slopes = np.concatenate([tangents[:, 0], -tangents[:, 1]], axis=1).swapaxes(1, 2)
        gap = (points[:, 0] - points[:, 1])[..., None]
        places = places - (np.linalg.pinv(slopes) @ gap)[..., 0].reshape(-1, 2, 2)
        places[..., 0] = places[..., 0] % 1.0 if closed else np.clip(places[..., 0], 0.0, 1.0)
        places[..., 1] = np.clip(places[..., 1], 0.0, 1.0)
    points = surface(places)
    gaps = lengths(points[:, 0] - points[:, 1])
    extent = float(np.ptp(points, axis=(0, 1)).max()) or 1.0
    apart = np.abs(places[:, 0] - places[:, 1])
    apart[:, 0] = np.minimum(apart[:, 0], 1 - apart[:, 0]) if closed else apart[:, 0]
    good = np.flatnonzero((gaps < 1e-9 * extent) & (apart.max(axis=1) > 1e-3))
    return (places[good[0]], points[good[0], 0], float(gaps[good[0]])) if len(good) else None


def is_injective(surface: ParametricMap, effort: int = 4_000) -> bool:
    """Whether it is proved that an exact surface over [0, 1]^2 takes no point twice; False says nothing.

    Each coordinate is scaled exactly by the size of its mean slopes (at 5 x 5 places) first: that changes nothing.
    """
    along, across = ([c.diff(*order) for c in surface.components] for order in ((1, 0), (0, 1)))
    places = [fmpq(i, 4) for i in range(5)]
    try:
        means = [
            [sum((rational(f.at(u, v)) for u in places for v in places), fmpq(0)) / 25 for f in pair]
            for pair in zip(along, across, strict=True)
        ]
    except ValueError:  # a pole
        return False
    sizes = [max(map(abs, row)) or fmpq(1) for row in means]
    tangents = np.array([[to_float(x / size) for x in row] for row, size in zip(means, sizes, strict=True)])
    duals = np.linalg.pinv(tangents)
    if not np.abs(duals).max(axis=1).min() > 0:
        return False
    first, second = ([x / size for x, size in zip(_short(row), sizes, strict=True)] for row in duals)
    a, d = _product(first, along), _product(second, across)
    mixed = _product(first, across) + _product(second, along)
    return positive_on_unit_square(a, effort) and positive_on_unit_square(4 * a * d - mixed * mixed, effort)


def _short(vector: Floats) -> list[fmpq]:
    """A rational vector near, with short numbers: any vectors near will do."""
    scale = exact(2.0 ** np.round(np.log2(np.abs(vector).max())))
    return [rational(to_fraction(exact(float(x)) / scale).limit_denominator(64)) * scale for x in vector]


def _product(vector: Sequence[fmpq], functions: Sequence[RationalFunction]) -> RationalFunction:
    return total([f * x for f, x in zip(functions, vector, strict=True)])
