"""Sessions: blends that were found before, so that the same contacts up to a similarity are not solved again.

Of the last blends that were found in a session and proved, the contacts, the pieces and their polynomials are kept.
Contacts that an exact similarity (a rotation or reflection with rational entries, a rational scale, a translation)
takes to those of such a blend, in whatever order, get its surface moved by that map.  The map is found from points and
normals of the contacts' curves, and then every polynomial is compared exactly.

Guaranteed: verdicts are carried over soundly.  An exact similarity takes cells to cells, planes to planes, the centre
to the centre and rays to rays; divisibility of polynomials, and signs on cells, do not change under an affine map, nor
does the sign of the derivative along rays from the centre.  So each claim holds of the image iff it holds of the
original.  The usual energy and the limits of fairness have no unit and do not change.

Not guaranteed: that solving anew would have rounded in the same way.  Not recognised: similarities that are irrational,
and of contacts in one plane those whose scale is.  Not kept: what was wished with points, handles, a basis, another
normalisation or another energy than `CurvatureVariation`, what was not proved, and blends on a partition or layout that
was given.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import cache
from itertools import permutations
from threading import Lock
from typing import Self

from flint import fmpq, fmpq_mat

from pas.algebra.affine import ORIGIN, Affine, reflection, scaling, translation
from pas.algebra.inputs import whole
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import UNITS, Vector, cross, dot, minus, rational, square_root, three
from pas.blending.solving import solve
from pas.blending.space import Space
from pas.certify.certificate import Certificate
from pas.contacts.contact import Contact
from pas.contacts.rims import Rim
from pas.errors import GeometryError
from pas.fairing.energies.curvature_variation import CurvatureVariation
from pas.fairing.wishes import MeanAlpha, Wishes
from pas.piecewise import PiecewiseSurface
from pas.pipeline.chosen import Attempt, B, ChosenBlend

USUAL, MOST = 64, 10_000
"""Blends that are kept if nothing else is said, a few hundred kilobytes each, and that may be asked for."""


@dataclass(frozen=True)
class Found:
    """What is kept of a blend: no mutable part of it is shared."""

    surface: PiecewiseSurface
    rims: tuple[Rim, ...]
    certificate: Certificate
    dimension: int
    energy: float
    attempts: tuple[Attempt, ...]
    wishes: Wishes

    @classmethod
    def of(cls, blend: ChosenBlend) -> Found:
        """The entry of a proved blend; raises `GeometryError` where a contact has no plane curve."""
        s = blend.surface
        own = PiecewiseSurface(s.partition.moved(Affine(UNITS, ORIGIN)), s.contacts, s.order, s.patches, s.degree)
        return cls(
            own,
            tuple(c.rim for c in s.contacts),
            s.certificate,
            blend.dimension,
            blend.energy,
            blend.attempts,
            blend.wishes,
        )

    def matched(self, contacts: Sequence[Contact], given: Sequence[Rim]) -> Match | None:
        """The exact similarity from this blend's contacts to others with their rims; None where none is found."""
        places = {rim.center for rim in given}
        for map_, scale in similarities(self.rims, given):
            if {map_.exact(rim.center) for rim in self.rims} != places:
                continue
            ours = [(map_.polynomial(c.surface), map_.polynomial(c.clip)) for c in self.surface.contacts]
            numbers = [n for contact in contacts if (n := _counterpart(contact, ours)) is not None]
            if sorted(numbers) == list(range(len(ours))):
                turned = [Contact(c.surface, ours[i][1], c.near) for c, i in zip(contacts, numbers, strict=True)]
                return Match(self, map_, scale, tuple(numbers), tuple(turned))
        return None


@dataclass(frozen=True)
class Match:
    """A kept blend, the similarity from it to other contacts, and the number of its contact for each of these."""

    found: Found
    map_: Affine
    scale: fmpq
    numbers: tuple[int, ...]
    contacts: tuple[Contact, ...]

    def blend(self, blends: type[B], timings: dict[str, float]) -> B:
        """The blend of the other contacts as one of a class, with the verdicts carried over."""
        old = self.found.surface
        partition = old.partition.moved(self.map_)
        local = partition.frame.affine.inverse.after(self.map_).after(old.partition.frame.affine)
        patches = [local.polynomial(p) * self.scale for p in old.patches]
        surface = PiecewiseSurface(partition, self.contacts, old.order, patches, old.degree)
        surface.certificate = self.certificate  # carried over, see above

        @cache
        def space() -> Space:
            return solve(surface.placed, surface.degree)

        return blends(
            surface=surface,
            find_coefficients=lambda: [rational(c) for c in space().coordinates(surface.polynomials)],
            energy=self.found.energy,
            timings=timings,
            attempts=self.found.attempts,
            wishes=self.found.wishes,
            find_space=space,
            found_dimension=self.found.dimension,
        )

    @property
    def certificate(self) -> Certificate:
        """The carried-over verdicts, those on contacts in the order of the other contacts."""
        ours = self.found.certificate
        claims = [verdict.claim for verdict in ours.contacts]
        turned = (replace(ours.contacts[i], claim=claim) for i, claim in zip(self.numbers, claims, strict=True))
        return replace(ours, contacts=tuple(turned))


def _counterpart(contact: Contact, ours: Sequence[tuple[Polynomial, Polynomial]]) -> int | None:
    """Which of some (surface, clip) a contact is: up to a positive factor of the surface and any factor of the clip."""
    for number, (surface, clip) in enumerate(ours):
        factors = _factor(contact.surface, surface), _factor(contact.clip, clip)
        if factors[0] is not None and factors[0] > 0 and factors[1] is not None:
            return number
    return None


def _factor(one: Polynomial, other: Polynomial) -> fmpq | None:
    """The constant that `one` is `other` times; None where there is none."""
    factor = one.raw.leading_coefficient() / other.raw.leading_coefficient()
    return factor if one.raw == other.raw * factor else None


class Session:
    """Keeps the last `most` blends while it is open, so that they are not solved again.

        elbow = [pas.Pipe((1, 0, 0), "1/3", 1), pas.Pipe((0, 1, 0), "1/3", 1)]
        with pas.Session():  # the second and the third are moved, not solved
            blends = [pas.blend([pipe.translate((3 * i, 0, 0)) for pipe in elbow], 1) for i in range(3)]

    What is recognised is exact, see `pas.pipeline.session`, and takes some ten milliseconds in place of seconds.  The
    last session that was opened in a thread serves its blends; one session may be open in several threads.  Raises
    `ValueError` and `TypeError` for a wrong number.
    """

    def __init__(self, most: int = USUAL) -> None:
        self.most = whole(most, "most", 0, MOST)
        self._kept: OrderedDict[tuple[Hashable, int], Found] = OrderedDict()
        self._counter = 0
        self._lock = Lock()

    def __enter__(self) -> Self:
        _OPEN.set((*_OPEN.get(), self))
        return self

    def __exit__(self, *_: object) -> None:
        _OPEN.set(_OPEN.get()[:-1])

    def __repr__(self) -> str:
        return f"<Session with {len(self)} of {self.most} blends>"

    def __len__(self) -> int:
        return len(self._kept)

    def find(self, contacts: Sequence[Contact], key: Hashable) -> Match | None:
        """A blend of the same contacts, up to a similarity, that was found under the same key."""
        with self._lock:
            candidates = [(name, found) for name, found in reversed(self._kept.items()) if name[0] == key]
        try:
            given = [contact.rim for contact in contacts]
        except GeometryError:
            return None
        for name, found in candidates:
            match = found.matched(contacts, given)
            if match is not None:
                with self._lock:
                    if name in self._kept:
                        self._kept.move_to_end(name)
                return match
        return None

    def keep(self, blend: ChosenBlend, key: Hashable) -> None:
        """Keep a blend that is proved and was chosen by the usual energy; another is not kept."""
        usual = type(blend.plate) is CurvatureVariation  # which has no unit
        if not usual or not self.most or not blend.surface.looked_into or not blend.certificate.proved:
            return
        try:
            found = Found.of(blend)
        except GeometryError:
            return
        with self._lock:
            self._counter += 1
            self._kept[key, self._counter] = found
            while len(self._kept) > self.most:
                self._kept.popitem(last=False)


def key_of(wishes: Wishes, *others: Hashable) -> Hashable | None:
    """The key under which blends are the same for the same contacts; None for wishes that are not kept."""
    plain = Wishes(energy=wishes.energy, limits=wishes.limits)
    usual = wishes.energy is None or type(wishes.energy) is CurvatureVariation
    if not usual or wishes != plain or wishes.normalize != MeanAlpha():
        return None
    return (wishes.energy, wishes.limits, *others)


_OPEN: ContextVar[tuple[Session, ...]] = ContextVar("sessions", default=())
"""The sessions that are open in a thread, the last one last."""


def open_session() -> Session | None:
    """The session that is open, if any."""
    return next(reversed(_OPEN.get()), None)


def keep_blends(most: int = USUAL) -> None:
    """Open a session without end, or with 0 none: the former name of `pas.Session`, kept for one version.

    Raises `ValueError` and `TypeError` for a wrong number.
    """
    _OPEN.set((Session(most),) if whole(most, "most", 0, MOST) else ())


def similarities(before: Sequence[Rim], after: Sequence[Rim]) -> Iterator[tuple[Affine, fmpq]]:
    """Exact similarities with their scales that may take centres and normals of some rims to those of others, in
    whatever order.

    As many rims as span the space, or the plane that all lie in, are tried in all places.  Where all are on one
    line, a reflection takes the one line to the other.
    """
    if len(before) != len(after):
        return
    sizes = range(2, len(before) + 1)
    ranks = [fmpq_mat([list(v) for v in _vectors(before[:size])]).rank() for size in sizes]
    base = before[: sizes[ranks.index(max(ranks))]]
    for chosen in permutations(after, len(base)):
        for map_, scale in linear_maps(_vectors(base), _vectors(chosen)):
            yield translation(minus(chosen[0].center, map_.exact(base[0].center))).after(map_), scale


def _vectors(rims: Sequence[Rim]) -> list[Vector]:
    """Vectors that move with rims: differences of centres, and the first of these along the normals."""
    first, *others = rims
    ways = [minus(other.center, first.center) for other in others]
    shares = (dot(ways[0], rim.normal) / dot(rim.normal, rim.normal) for rim in rims)
    return [*ways, *(three(share * c for c in rim.normal) for share, rim in zip(shares, rims, strict=True))]


def linear_maps(before: list[Vector], after: list[Vector]) -> list[tuple[Affine, fmpq]]:
    """The linear similarities that take some vectors to others, and their scales, which are rational.

    A reflection for each vector takes it where it is to go (Householder 1958) and keeps those before it.  Of vectors in
    one plane the reflection in that does as well.
    """
    square = dot(after[0], after[0]) / dot(before[0], before[0])
    scale, pairs = square_root(square), list(zip(before, after, strict=True))
    if scale**2 != square or any(dot(a, after[0]) != dot(b, before[0]) * square for b, a in pairs):
        return []
    map_ = scaling(scale, ORIGIN)
    for old, new in pairs:
        if any(way := minus(map_.direction(old), new)):
            map_ = reflection(way, ORIGIN).after(map_)
    normals = [normal for _, new in pairs if any(normal := cross(after[0], new))]
    maps = [map_, *(reflection(normal, ORIGIN).after(map_) for normal in normals[:1])]
    return [(m, scale) for m in maps if all(m.direction(old) == new for old, new in pairs)]
