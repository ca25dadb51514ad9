"""A solid's tree read leaf by leaf: what it says for given truths of its inequalities, and what that rests on.

Leaves that are polynomials have signs, known exactly.  Of others, distances from curves and faces
(`pas.solid.tube`, `pas.solid.shell`), it is known that small boxes are certainly inside or outside.  Boxes that may
meet a curve and of which they do not say so are halved until they are small; between the values that a linear form has
in those left the truth is unknown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from flint import arb, ctx, fmpq

from pas.algebra.curve import SpaceCurve
from pas.algebra.monomials import Floats
from pas.algebra.polynomial import Polynomial
from pas.algebra.roots import FIRST_BITS, RealRoot, bounds, rational_root
from pas.algebra.zeros import RealZero, value_at
from pas.bernstein.search import Boxes, Fate, Fates, Limits, search
from pas.solid.functions import Pieces
from pas.solid.tree import Atom, Bools, Node, ScalarField, Tree, complement

Truth = Callable[[int], bool | None]
"""Whether the inequality of a leaf holds; None where that is not known."""


@dataclass(frozen=True)
class Leaf:
    """The inequality `function <= 0`, or `>= 0` where `outside`, with the name of its face.

    `number` is the place of a polynomial among the reading's polynomials; multiples share one, with
    their `sign`.  It is -1 for other functions.
    """

    function: Polynomial | ScalarField
    number: int
    sign: int
    face: str
    outside: bool

    def holds(self, sign: int) -> bool:
        """Whether it holds where the polynomial of its number has a sign (not 0)."""
        return (sign * self.sign < 0) != self.outside


@dataclass(frozen=True)
class Branch:
    """A union or an intersection of leaves, by number, and branches."""

    parts: tuple[int | Branch, ...]
    union: bool


class LeafTree:
    """The leaves of a tree and how they combine; piecewise polynomials are read cell by cell."""

    def __init__(self, tree: Tree) -> None:
        self.leaves: list[Leaf] = []
        self.polynomials: list[Polynomial] = []
        self._numbers: dict[str, int] = {}
        self.code = self._read(tree)

    def _read(self, tree: Tree) -> int | Branch:
        if isinstance(tree, Node):
            return Branch(tuple(map(self._read, tree.parts)), tree.union)
        if isinstance(tree.function, Pieces):
            return self._read(_by_cells(tree, tree.function))
        number, sign = self._number(tree.function) if isinstance(tree.function, Polynomial) else (-1, 1)
        self.leaves.append(Leaf(tree.function, number, sign, tree.face, tree.outside))
        return len(self.leaves) - 1

    def _number(self, polynomial: Polynomial) -> tuple[int, int]:
        primitive = polynomial.primitive()
        number = self._numbers.setdefault(str(primitive), len(self.polynomials))
        if number == len(self.polynomials):
            self.polynomials.append(primitive)
        return number, 1 if polynomial.raw.coeffs()[0] > 0 else -1

    def says(self, truth: Truth) -> bool | None:
        """Whether points with these truths are in the solid; None where that is not known."""
        return _says(self.code, truth)

    def rests_on(self, says: bool, truth: Truth, fixed: Callable[[int], bool]) -> set[int]:
        """Leaves that are not `fixed` and on which what the tree `says` rests; none if it is certain.

        Of several ways in which it could be certain, the one with the fewest such leaves.
        """
        return _rests_on(self.code, says, truth, fixed)

    def matters(self, leaf: int, truth: Truth) -> bool:
        """Whether the tree may depend on a leaf: none of its branches is settled by others."""
        return _matters(self.code, leaf, truth) is True


def _by_cells(atom: Atom, pieces: Pieces) -> Tree:
    """The union of the pieces' cells, each as far as the inequality holds in it."""
    cells = []
    for polynomial, walls in pieces.cells:
        cell = [Atom(polynomial, atom.face), *(Atom(w, "", outside=True) for w in walls)]
        cells.append(Node(tuple(cell), union=False))
    whole = Node(tuple(cells), union=True)
    return complement(whole) if atom.outside else whole


def _says(code: int | Branch, truth: Truth) -> bool | None:
    if isinstance(code, int):
        return truth(code)
    result: bool | None = not code.union
    for part in code.parts:
        found = _says(part, truth)
        if found is code.union:
            return code.union
        if found is None:
            result = None
    return result


def _rests_on(code: int | Branch, says: bool, truth: Truth, fixed: Callable[[int], bool]) -> set[int]:
    if isinstance(code, int):
        return set() if fixed(code) else {code}
    if says is not code.union:
        return {leaf for part in code.parts for leaf in _rests_on(part, says, truth, fixed)}
    best: set[int] | None = None
    for part in code.parts:
        if _says(part, truth) is says:
            found = _rests_on(part, says, truth, fixed)
            if not found:
                return found
            best = found if best is None or len(found) < len(best) else best
    assert best is not None
    return best


def _matters(code: int | Branch, leaf: int, truth: Truth) -> bool | None:
    """True where the leaf is in there and matters, False where it is and does not, None where it is not."""
    if isinstance(code, int):
        return True if code == leaf else None
    for i, part in enumerate(code.parts):
        inside = _matters(part, leaf, truth)
        if inside is not None:
            others = (*code.parts[:i], *code.parts[i + 1 :])
            return inside and all(_says(other, truth) is not code.union for other in others)
    return None


LIMITS = Limits(depth=7, cells=2000)
"""How often the solid's box is cut, and boxes left open at which that ends early."""

SMALL = 1e-12
"""Half of a box about a point, over the extent."""

OVERLAP = 1e-9
"""By which boxes are larger than their share, so that rounding leaves no gap between them."""

Interval = tuple[RealRoot, RealRoot]


class AlongCurve:
    """The leaves of a solid that are no polynomials, along a curve.

    `box()` gives two corners (2, 3) between which the solid lies; it is asked for only where it is needed.
    """

    def __init__(self, leaves: list[Leaf], curve: SpaceCurve, box: Callable[[], Floats]) -> None:
        self._outside = [leaf.outside for leaf in leaves]
        self._fields = {i: leaf.function for i, leaf in enumerate(leaves) if not isinstance(leaf.function, Polynomial)}
        self._box = box() if self._fields else np.zeros((2, 3))
        self._unknown = {i: self._intervals(field, curve) for i, field in self._fields.items()}

    def may_hold(self, point: RealZero) -> bool:
        """False only where the solid certainly does not reach a point."""
        p = np.array(point.point)
        return not self._fields or bool(((p >= self._box[0]) & (p <= self._box[1])).all())

    def holds(self, number: int, point: RealZero) -> bool | None:
        """Whether a leaf holds at a point; None where that is not certain."""
        half = np.full((1, 3), SMALL * np.ptp(self._box))
        inside, outside = self._fields[number].decided(np.array([point.point]), half)
        return bool(inside[0]) != self._outside[number] if inside[0] or outside[0] else None

    def distance(self, number: int, point: RealZero) -> float:
        """About how far the zeros of a leaf's function are from a point; 0 for polynomials."""
        field = self._fields.get(number)
        return 0.0 if field is None else abs(float(field.jets(np.array([point.point]))[0, 0]))

    def cuts(self, number: int) -> list[RealRoot]:
        """The ends of the intervals in which a leaf's truth is unknown."""
        return [end for interval in self._unknown[number] for end in interval]

    def is_fixed(self, number: int, slab: tuple[RealRoot | None, RealRoot | None]) -> bool:
        """Whether a leaf's truth is known in a slab that no end of an interval cuts."""
        low, high = slab
        return not any(
            (high is None or start < high) and (low is None or low < end) for start, end in self._unknown[number]
        )

    def _intervals(self, field: ScalarField, curve: SpaceCurve) -> list[Interval]:
        """Disjoint intervals of the form's values in boxes where a function is not decided."""

        def judge(boxes: Boxes, _: int) -> Fates:
            return np.where(_may_change(field, curve, boxes), Fate.SPLIT, Fate.SETTLED)

        found = search(Boxes.of(self._box), judge, Boxes.eighths, LIMITS, "following a curve past a face").open
        values = sorted(bounds(_over(curve.form, *box)) for box in zip(found.centers, found.halves, strict=True))
        merged: list[tuple[fmpq, fmpq]] = []
        for low, high in values:
            if merged and low <= merged[-1][1]:
                merged[-1] = (merged[-1][0], max(merged[-1][1], high))
            else:
                merged.append((low, high))
        return [(rational_root(low), rational_root(high)) for low, high in merged]


def _may_change(field: ScalarField, curve: SpaceCurve, boxes: Boxes) -> Bools:
    """Which boxes may meet the curve, without that a function says on which side they are."""
    reach = boxes.halves * (1 + OVERLAP)
    inside, outside = field.decided(boxes.centers, reach)
    result = ~(np.asarray(inside) | np.asarray(outside))
    for row in np.flatnonzero(result):
        result[row] = all(_over(p, boxes.centers[row], reach[row]).contains(0) for p in curve.pair)
    return result


def _over(polynomial: Polynomial, center: Floats, half: Floats) -> arb:
    """A ball that holds all values of a polynomial in a box, by its expansion about the centre."""
    shift = [Polynomial({(0, 0, 0): float(c), _unit(i): 1}) for i, c in enumerate(center)]
    with ctx.workprec(FIRST_BITS):
        return value_at(polynomial.compose(*shift), tuple(arb(0, float(h)) for h in half))


def _unit(axis: int) -> tuple[int, int, int]:
    return (int(axis == 0), int(axis == 1), int(axis == 2))
