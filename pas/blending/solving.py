"""From contacts in place to the space of all surfaces of a degree that meet them: ways to solve, by name.

"linear": normal forms and remainders of all monomials are zero, one rational matrix.  A single cell is solved in the
user's coordinates, where the numbers are short.  On many cells around a centre homogeneous splines serve, on others the
net of B-coefficients, both with sparse elimination.

"normal-form": `NF(g) = 0` and `NF(grad f_i x grad g) = 0` modulo `<f_i, h_i>`, for GC^0 and GC^1; above, membership in
`<f_i, h_i^(k+1)>` (see `pas.blending.normal_form_system`).

"intersection": the members of the intersection of the contact ideals, by its graded Groebner basis (Warren 1989; Lou,
Feng, Chen and Deng 2002).

"syzygy": `g = gamma_i f_i + beta_i h_i^(k+1)` for all contacts, solved for the multipliers (Xu, Chen and Deng; see
`pas.blending.multipliers`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from flint import fmpq_mat

from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_degree, check_order, shown
from pas.algebra.matrices import Products
from pas.algebra.monomials import count
from pas.algebra.polynomial import Polynomial
from pas.blending.conditions import Conditions
from pas.blending.multipliers import consistency
from pas.blending.net import Net
from pas.blending.normal_form_system import normal_form_system
from pas.blending.place import place
from pas.blending.space import MemberLike, Space
from pas.blending.spherical import solve_on_layout, splines
from pas.contacts.contact import Contact, contact_ideal
from pas.limits import checkpoint
from pas.partition.boxes import SingleCell
from pas.partition.cells import Partition
from pas.partition.layout import Layout
from pas.registry import Registry
from pas.surface.placed import PlacedContacts

Patches = tuple[fmpq_mat, ...] | Products
"""For each piece the patches of a basis in local coordinates, one member a row: (dimension, C(n+3, 3))."""


@dataclass(frozen=True)
class SolvingMethod:
    """One way to find all members of a degree; `several` says whether it serves several pieces.

    All ways find the same space, by different bases.  `solve(placed, degree)` gives a basis: a list of members, each
    one polynomial for each piece in the user's coordinates (or a polynomial alone where there is one piece), or their
    patches.  `placed` has the `partition`, the `contacts` and the `order`.
    """

    name: str
    solve: Callable[[PlacedContacts, int], Patches | Sequence[MemberLike]]
    several: bool = False


def patches_of(placed: PlacedContacts, degree: int, members: Sequence[Sequence[Polynomial]]) -> Patches:
    """The patches of members given by one polynomial for each piece, in the user's coordinates."""
    frame, found = placed.partition.frame, []
    for piece in range(len(placed.partition.pieces)):
        rows = [frame.localise(member[piece]).row(degree) for member in members]
        found.append(fmpq_mat(len(rows), count(degree), [v for row in rows for v in row]))
    return tuple(found)


def _linear(placed: PlacedContacts, degree: int) -> Patches:
    if len(placed.partition.pieces) == 1:
        alone = PlacedContacts(SingleCell(), placed.contacts, placed.order)
        (found,) = Conditions(alone).solve(degree).matrices
        members = [Polynomial.from_row(row, degree).primitive() for row in found.tolist()]
        return patches_of(placed, degree, [(member,) for member in members])
    # Cells above which sparse elimination serves: on C^1 quartics both take 10 to 20 ms with 6 cells, with 48 cells the
    # net 1.3 s and dense elimination 17 s. Homogeneous splines take 0.1 s on a node of 48 cells.
    many_cells = 12
    if len(placed.partition.cells) > many_cells:
        layout = placed.partition.layout
        if layout is None:
            return Net(placed, degree).solve()
        return solve_on_layout(placed.local_contacts, placed.carriers, placed.order, layout, degree)
    return Conditions(placed).solve(degree)


LINEAR = SolvingMethod("linear", _linear, several=True)


def _normal_form(placed: PlacedContacts, degree: int) -> Patches:
    found = normal_form_system(placed.contacts, placed.order, degree).solutions
    return patches_of(placed, degree, [(member.primitive(),) for member in found])


NORMAL_FORM = SolvingMethod("normal-form", _normal_form, several=False)


@lru_cache(maxsize=32)
def intersection(contacts: tuple[Contact, ...], order: int) -> Ideal:
    """The ideal of all polynomials that meet every contact with GC^`order`."""
    first, *others = (contact_ideal(contact, order) for contact in contacts)
    for other in others:
        first = first & other
    return first


def _intersection(placed: PlacedContacts, degree: int) -> Patches:
    found = intersection(placed.contacts, placed.order).members(degree)
    return patches_of(placed, degree, [(member.primitive(),) for member in found])


INTERSECTION = SolvingMethod("intersection", _intersection, several=False)


def _syzygy(placed: PlacedContacts, degree: int) -> Patches:
    members = [solution.patches for solution in consistency(placed).solve(degree)]
    if len(placed.partition.pieces) == 1:
        members = [(patch.primitive(),) for (patch,) in members]
    return patches_of(placed, degree, members)


SYZYGY = SolvingMethod("syzygy", _syzygy, several=True)

METHODS: Registry[SolvingMethod] = Registry(
    "method", {method.name: method for method in (LINEAR, NORMAL_FORM, INTERSECTION, SYZYGY)}
)
"""The methods of `pas.solutions` by name."""


def solve(placed: PlacedContacts, degree: int, method: str = "linear") -> Space:
    """The space of one degree; raises `ValueError` for a method of one's own that gives no basis of it."""
    found = METHODS[method].solve(placed, degree)
    if isinstance(found, Products) or (isinstance(found, tuple) and found and isinstance(found[0], fmpq_mat)):
        return Space(placed, degree, found)
    pieces, rows = len(placed.partition.pieces), list[tuple[Polynomial, ...]]()
    for number, member in enumerate(found):
        parts = member if isinstance(member, list | tuple) else (member,)
        if len(parts) != pieces:
            raise ValueError(
                f"member {number} of the method {method!r} has {len(parts)} polynomials for {pieces} pieces"
            )
        rows.append(tuple(map(Polynomial, parts)))
    table = [[value for polynomial in row for value in polynomial.row(degree)] for row in rows]
    if table and fmpq_mat(table).rank() < len(table):
        raise ValueError(f"the {len(rows)} members of the method {method!r} are not linearly independent")
    return Space(placed, degree, patches_of(placed, degree, rows))


def register_method(method: SolvingMethod) -> SolvingMethod:
    """Make a way to solve known to `pas.solutions` by its name, beside those of Warren 1989 and the others; returns it.

    Raises `ValueError` for a name that is taken, `TypeError` for what is no method.
    """
    if not isinstance(method, SolvingMethod):
        raise TypeError(f"method must be a pas.SolvingMethod, not {shown(method)}")
    return METHODS.register(method)


def check_method(method: Any, partition: Partition) -> str:
    """A method's name, checked against what serves the partition."""
    single = len(partition.pieces) == 1
    served = [name for name, entry in METHODS.items() if single or entry.several]
    if method not in served:
        kind = "a single cell" if single else "several cells"
        raise ValueError(f"method must be one of {', '.join(served)} for {kind}, not {method!r}")
    return str(method)


def dimensions(layout: Layout, contacts: Sequence[Any], order: int, degrees: Iterable[int] | int) -> dict[int, int]:
    """How many surfaces of each degree a layout has that meet contacts; see `Layout.dimensions`.

    Without contacts it is the sum over all degrees d <= n of the dimensions of homogeneous splines of degree d on the
    sphere of directions (Alfeld, Neamtu and Schumaker 1996); contacts are joined to these (see `spherical`).
    """
    check_order(order)
    several = [degrees] if isinstance(degrees, int) else degrees
    if isinstance(several, str) or not isinstance(several, Iterable):
        raise TypeError(f"degrees must be whole numbers, such as range(1, 7), not {several!r}")
    wanted = [check_degree(degree, f"degrees[{i}]") for i, degree in enumerate(several)]
    placed = place(contacts, order, layout) if len(contacts) else None
    table = {}
    for degree in wanted:
        checkpoint(f"counting for degree {degree}")
        if placed is None:
            table[degree] = sum(splines(layout, order, d)[0].nrows() for d in range(degree + 1))
        else:
            table[degree] = solve(placed, degree).dimension
    return table
