"""Joints: claims that two faces of a solid continue each other with GC^k along a curve, and their proofs.

What is proved is said in docs/theory/solids.md; contact of order k is that of Garrity and Warren (1991).

Guaranteed: PROVED and REFUTED are exact, for all points of the curve but finitely many, at which the faces
meet as limits do.  The one thing taken on trust is what functions that are no polynomials, such as
distances, say of small boxes.  What cannot be decided is UNDECIDED, with the reason and a place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from pas.algebra.affine import Affine
from pas.algebra.brief import brief
from pas.algebra.components import Components, LostError
from pas.algebra.curve import CurvePart, SpaceCurve, SplitError
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_order, set_fields, short
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.arrays import Floats
from pas.solid.arcs import AlongCurve, Arc, Around, arcs
from pas.solid.functions import by_cells
from pas.solid.germs import Sheets
from pas.solid.tree import Tree
from pas.solid.truths import LeafTree
from pas.verdicts import Status, Verdict


@dataclass(frozen=True)
class Joint:
    """The claim that two faces, by name, meet with GC^`order` along the curve V(g, h).

    It is of the part of that on which all polynomials `within` are positive.
    """

    first: str
    second: str
    along: tuple[Polynomial, Polynomial]
    order: int
    within: tuple[Polynomial, ...] = ()

    __repr__ = brief

    def __init__(
        self,
        first: str,
        second: str,
        along: Sequence[PolynomialLike],
        order: int,
        within: Sequence[PolynomialLike] = (),
    ) -> None:
        if not isinstance(along, Sequence) or isinstance(along, str) or len(along) != 2:
            raise TypeError(f"along must be the two polynomials (g, h) of the joint's curve, not {along!r}")
        g, h = Polynomial(along[0]), Polynomial(along[1])
        common = g.raw.gcd(h.raw)
        if g.is_zero or h.is_zero or not common.is_constant():
            raise ValueError(
                f"along must be two polynomials whose surfaces meet in curves; {g} and {h} share a surface"
            )
        walls = tuple(map(Polynomial, within))
        set_fields(self, first=first, second=second, along=(g, h), order=check_order(order), within=walls)

    def moved(self, map_: Affine) -> Joint:
        """The claim on the image under an affine map."""
        along, within = (tuple(map(map_.polynomial, some)) for some in (self.along, self.within))
        return Joint(self.first, self.second, along, self.order, within)

    @property
    def claim(self) -> str:
        """The claim in words."""
        part = " on a part of the curve" if self.within else ""
        return f"{self.first} meets {self.second} with GC^{self.order}{part}"


def orders(joints: Sequence[Joint]) -> dict[tuple[Polynomial, Polynomial], int]:
    """The curves along which faces are joined, each with the least order that is claimed there; not those of parts of
    which an angle is claimed, where faces cross."""
    found: dict[tuple[Polynomial, Polynomial], int] = {}
    for joint in (joint for joint in joints if joint.order or not joint.within):
        found[joint.along] = min(joint.order, found.get(joint.along, joint.order))
    return found


@dataclass(frozen=True, eq=False)
class Known:
    """Verdicts on joints of the solid with one tree, which were proved while it was made, and hold for no other."""

    tree: Tree
    verdicts: Mapping[Joint, Verdict]


def prove(joint: Joint, tree: Tree, box: Callable[[], Floats], known: Known | None = None) -> Verdict:
    """The verdict on a joint of the solid with that tree: the one that is known of that very tree, or a new one.

    `box()` gives two corners (2, 3) between which the solid lies; it is asked for only where some face is
    no polynomial.
    """
    if known is not None and known.tree is tree and joint in known.verdicts:
        return known.verdicts[joint]
    return _Proof(joint, tree, box).verdict()


@dataclass(frozen=True)
class _Stretch:
    """An arc of a joint's curve, with its borders by number that lie on the first and on the second face."""

    sheets: Sheets
    arc: Arc
    first: frozenset[int]
    second: frozenset[int]

    @property
    def is_joined(self) -> bool:
        """Whether the boundary is the one face on one side and the other on the other."""
        return len(self.arc.borders) == 2 and any(i != j for i in self.first for j in self.second)

    @property
    def is_apart(self) -> bool:
        """Whether both faces are on the boundary, and yet not so."""
        return not self.is_joined and any(i != j for i in self.first for j in self.second)

    def missing(self, joint: Joint) -> str | None:
        """The face that does not continue here where the other ends, if there is one."""
        if self.is_joined or self.is_apart or not self.first | self.second:
            return None
        return joint.first if self.second else joint.second

    @property
    def order(self) -> int | None:
        """The order of contact of the two faces where they are joined; None on one surface."""
        a, b = (border.ray.sheet for border in self.arc.borders)
        return None if a == b else self.sheets.order(a, b)

    @property
    def is_flat(self) -> bool:
        """Whether joined faces that touch go opposite ways from the curve, not the same way in a cusp."""
        a, b = (border.ray for border in self.arc.borders)
        return a.sheet == b.sheet or a.side * b.side * self.sheets.parallel(a.sheet, b.sheet, self.arc.point) < 0


class _Proof:
    """All that is found out about one joint."""

    def __init__(self, joint: Joint, tree: Tree, box: Callable[[], Floats]) -> None:
        self.joint, self.names = joint, tuple(dict.fromkeys((joint.first, joint.second)))
        self.solid = LeafTree(by_cells(tree))
        self.curve = SpaceCurve(*joint.along)
        self.nearby = AlongCurve(self.solid.leaves, self.curve, box)
        self.sheets: list[Sheets] = []
        self.stretches: list[_Stretch] = []
        self.is_reduced = True
        parts = [self.curve.whole]
        while parts:
            part = parts.pop()
            try:
                self._look(part)
            except SplitError as splits:
                parts += part.split(splits.polynomial)

    def _look(self, part: CurvePart) -> None:
        if part.ideal.is_whole_ring:
            return
        if part.turns is None:
            self.is_reduced = False
            return
        sheets = Sheets(part, self.solid.polynomials)
        found = arcs(sheets, self.solid, self.nearby, self.names, self.joint.within)
        self.sheets.append(sheets)
        for arc in (a for a in found if all(a.point.sign(wall) > 0 for wall in self.joint.within)):
            first, second = (
                frozenset(i for i, border in enumerate(arc.borders) if name in border.names)
                for name in (self.joint.first, self.joint.second)
            )
            self.stretches.append(_Stretch(sheets, arc, first, second))

    def verdict(self) -> Verdict:
        """The first of all rules that does not hold refutes, unless something is not known."""
        rules = (self._curve, self._faces, self._contact, self._sides, self._coverage, self._doubts, self._singular)
        found = next((verdict for rule in rules if (verdict := rule()) is not None), None)
        return Verdict(Status.PROVED, self.joint.claim, self._grounds()) if found is None else found

    def _refuted(self, reason: str, stretch: _Stretch | None = None) -> Verdict:
        place = None if stretch is None else stretch.arc.point.point
        return Verdict(Status.REFUTED, self.joint.claim, reason, place)

    def _undecided(self, reason: str, place: tuple[float, float, float] | None = None) -> Verdict:
        return Verdict(Status.UNDECIDED, self.joint.claim, reason, place)

    @cached_property
    def _known(self) -> list[_Stretch]:
        return [s for s in self.stretches if s.arc.unknown is None]

    @cached_property
    def _joined(self) -> list[_Stretch]:
        return [s for s in self._known if s.is_joined]

    def _curve(self) -> Verdict | None:
        """The two polynomials cut out a real curve."""
        if not self.is_reduced:
            g, h = (short(str(polynomial)) for polynomial in self.joint.along)
            reason = f"{g} and {h} touch all along a part of the curve; take two that cross there"
            return self._undecided(reason)
        where = " there" if self.joint.within else ""
        reason = f"the curve has no real points{where}, or isolated ones only"
        return None if self.stretches else self._refuted(reason)

    def _faces(self) -> Verdict | None:
        """Both faces lie on the curve, somewhere."""
        for name in self.names:
            numbers = [
                n for leaf, (n, _) in zip(self.solid.leaves, self.solid.signed, strict=True) if leaf.face == name
            ]
            if not any(number in sheets.factors for number in numbers for sheets in self.sheets):
                if any(number < 0 for number in numbers):
                    return self._undecided(f"{name} is no polynomial")
                return self._refuted(f"they do not meet there: {name} does not hold the curve")
        return None

    def _contact(self) -> Verdict | None:
        """Where they are joined they have contact of the order claimed, and do not turn back."""
        orders = [(stretch.order, stretch) for stretch in self._joined if stretch.order is not None]
        lowest, where = min(orders, key=lambda pair: pair[0], default=(self.joint.order, None))
        if lowest < self.joint.order:
            return self._refuted(f"they meet with GC^{lowest} there", where)
        cusp = next((s for s in self._joined if self.joint.order > 0 and not s.is_flat), None)
        reason = "the two faces go the same way from the curve, in a cusp"
        return None if cusp is None else self._refuted(reason, cusp)

    def _sides(self) -> Verdict | None:
        """Nowhere are both on the boundary without the solid on one side of them."""
        for stretch in self._known:
            if stretch.is_apart:
                number = len(stretch.arc.borders)
                reason = f"the solid is on opposite sides of the two faces: its boundary has {number} pieces there"
                return self._refuted(reason, stretch)
        return None

    def _coverage(self) -> Verdict | None:
        """They are joined somewhere, and wherever on such a component one of them ends."""
        gaps = [s for s in self._known if s.missing(self.joint)]
        if not self._joined:
            if len(self._known) < len(self.stretches):
                return None
            both = all(any(getattr(s, name) for s in self._known) for name in ("first", "second"))
            reason = "go along different parts of the curve" if both else "do not both reach the curve"
            return self._refuted(f"the regions of the two faces {reason}", gaps[0] if gaps else None)
        if not gaps:
            return None
        try:
            found = Components(self.curve).of([(s.arc.plane, s.arc.point) for s in self._known])
        except LostError as lost:
            reason = "a face is missing on a part of the curve; whether that belongs to the joint cannot be told"
            return self._undecided(reason, lost.place)
        joined = {component for component, s in zip(found, self._known, strict=True) if s.is_joined}
        for component, stretch in zip(found, self._known, strict=True):
            name = stretch.missing(self.joint)
            if name is not None and component in joined:
                reason = f"on a part of the curve {name} is missing: the boundary goes on without it"
                return self._refuted(reason, stretch)
        return None

    def _doubts(self) -> Verdict | None:
        """The borders are known along all of the curve."""
        unknown = [(s.arc.unknown, s.arc.point) for s in self.stretches if s.arc.unknown is not None]
        if not unknown:
            return None
        number, point = min(unknown, key=lambda pair: self.nearby.distance(*pair))
        is_polynomial = self.solid.signed[number][0] >= 0
        reason = "is singular all along the curve" if is_polynomial else "may cross the curve, and is no polynomial"
        return self._undecided(f"{self.solid.leaves[number].face or 'a wall'} {reason}", point.point)

    def _singular(self) -> Verdict | None:
        """Neither has a singular point on the curve."""
        for sheets in {id(s.sheets): s.sheets for s in self._joined}.values():
            for number, leaf in enumerate(self.solid.leaves):
                polynomial, _ = self.solid.signed[number]
                if leaf.face not in self.names or polynomial not in sheets.factors:
                    continue
                for point in sheets.singular_points(polynomial):
                    if Around(sheets, self.solid, self.nearby, point, (None, None)).may_matter(number):
                        return self._undecided(f"{leaf.face} is singular at a point of the curve", point.point)
        return None

    def _grounds(self) -> str:
        """Membership in the ideal of the claim, where it is so, and the order."""
        (g, h), power = self.joint.along, self.joint.order + 1
        orders = [s.order for s in self._joined if s.order is not None]
        exactly = f"exactly GC^{min(orders)}" if orders else "the same surface"
        carriers = {s.sheets.polynomials[border.ray.sheet] for s in self._joined for border in s.arc.borders}
        if power <= 12 and all(map(Ideal(g, h**power).contains, carriers)):
            return f"both in <{short(str(g))}, ({short(str(h))})^{power}>, {exactly}"
        return f"they have contact all along the curve, {exactly}"


def verdict_list(verdicts: Sequence[Verdict]) -> str:
    """A table of the claimed joints; says so where none was claimed."""
    if not verdicts:
        return "joints: none claimed, none proved"
    width = max(len(v.claim) for v in verdicts)
    lines = [f"  {v.claim:<{width}}  {v.status.value:<9}  {v.reason}" for v in verdicts]
    return "\n".join([f"joints: {sum(v.proved for v in verdicts)} of {len(verdicts)} proved", *lines])
