"""A solid's tree read leaf by leaf: what it says for given truths of its inequalities, and what that rests on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pas.algebra.polynomial import Polynomial
from pas.solid.pieces import Pieces
from pas.solid.tree import Atom, Field, Node, Tree, complement

Truth = Callable[[int], bool | None]
"""Whether the inequality of a leaf holds; None where that is not known."""


@dataclass(frozen=True)
class Leaf:
    """The inequality `function <= 0`, or `>= 0` where `outside`, with the name of its face.

    `number` is the place of a polynomial among the reading's polynomials; multiples share one, with
    their `sign`.  It is -1 for other functions.
    """

    function: Polynomial | Field
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


class Reading:
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
