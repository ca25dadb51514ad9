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

Conditions on few cells, as "linear" has them.  Two patches that share a face in the plane `pi = 0` meet with C^k iff
`pi^(k+1)` divides their difference; a patch g meets a contact (f, h) with GC^k iff g lies in `<f, h^(k+1)>` (Garrity
and Warren 1991).  Both are linear, and the unknowns are chosen so that most conditions hold by construction:

- the pieces are joined by a spanning tree of their adjacency, rooted at a piece with a contact;
- the root's patch is a combination of `m - NF(m)` over the monomials m that are not standard
  modulo `<f, h^(k+1)>` (all of the ideal in degree <= n);
- across each face of the tree, child = parent + alpha * pi^(k+1) with alpha free, of degree
  n-k-1.

The faces outside the tree and the other contacts give the equations: remainders modulo
`pi^(k+1)` and normal forms are zero.  The map from unknowns to patches is injective, so the
dimension of the nullspace is that of the space of surfaces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from math import lcm
from operator import and_
from typing import Any

from flint import fmpq, fmpq_mat

from pas.algebra.ideal import Ideal
from pas.algebra.inputs import check_degree, check_order, shown
from pas.algebra.matrices import Products, whole_rows
from pas.algebra.monomials import count, exponents, positions
from pas.algebra.nullspace import integral_nullspace
from pas.algebra.polynomial import Polynomial
from pas.blending.multipliers import consistency, spanning_tree
from pas.blending.net import Column, Net, equations_on_layout, solve_on_layout, splines
from pas.blending.normal_form_system import normal_form_system
from pas.blending.place import place
from pas.blending.space import MemberLike, Space
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
        (found,) = solve_along_tree(alone, degree).matrices
        members = [Polynomial.from_row(row, degree).primitive() for row in found.tolist()]
        return patches_of(placed, degree, [(member,) for member in members])
    # Above so many cells homogeneous splines serve, and above so many pieces sparse elimination: on C^1 quartics both
    # ways take 10 to 20 ms with 6 pieces, with 48 the net 1.3 s and dense elimination 17 s. Splines take 0.1 s on a
    # node of 48 cells. Around a plate with two pipes, 2 pieces of 28 cells, members of degree 6 take the net 10 s and
    # the tree 0.02 s.
    many = 12
    layout = placed.partition.layout if len(placed.partition.cells) > many else None
    if layout is not None:
        return solve_on_layout(placed.local_contacts, placed.carriers, placed.order, layout, degree)
    return Net(placed, degree).solve() if len(placed.partition.pieces) > many else solve_along_tree(placed, degree)


def fewest_members(placed: PlacedContacts, degree: int) -> int:
    """A lower bound of the dimension of the space on a layout, for the price of its equations; 0 elsewhere."""
    layout = placed.partition.layout
    if layout is None:
        return 0
    tables, rows = equations_on_layout(placed.local_contacts, placed.carriers, placed.order, layout, degree)
    return max(0, int(tables[0].nrows()) - len(rows))


LINEAR = SolvingMethod("linear", _linear, several=True)


def _normal_form(placed: PlacedContacts, degree: int) -> list[Polynomial]:
    return [member.primitive() for member in normal_form_system(placed.contacts, placed.order, degree).solutions]


NORMAL_FORM = SolvingMethod("normal-form", _normal_form, several=False)


@lru_cache(maxsize=32)
def intersection(contacts: tuple[Contact, ...], order: int) -> Ideal:
    """The ideal of all polynomials that meet every contact with GC^`order`."""
    return reduce(and_, (contact_ideal(contact, order) for contact in contacts))


def _intersection(placed: PlacedContacts, degree: int) -> list[Polynomial]:
    return [member.primitive() for member in intersection(placed.contacts, placed.order).members(degree)]


INTERSECTION = SolvingMethod("intersection", _intersection, several=False)


def _syzygy(placed: PlacedContacts, degree: int) -> list[tuple[Polynomial, ...]]:
    members = [solution.patches for solution in consistency(placed).solve(degree)]
    return members if len(placed.partition.pieces) > 1 else [(patch.primitive(),) for (patch,) in members]


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


def solve_along_tree(placed: PlacedContacts, degree: int) -> Products:
    """A basis of all solutions of degree <= `degree` on few cells, see above.

    For each piece the patches of its members, with the monomials in the order of `pas.algebra.monomials`.
    """
    faces, contacts, order = placed.local.interior_faces, placed.local_contacts, placed.order
    first = next((i for i, pieces in enumerate(placed.carriers) if pieces), None)
    root = 0 if first is None else placed.carriers[first][0]
    columns: list[Column] = [{e: fmpq(1)} for e in exponents(degree)]
    if first is not None:
        ideal = contacts[first].ideal(order)
        images, standard = ideal.images(degree), set(ideal.standard(degree))
        columns = [{e: fmpq(1)} | {m: -c for m, c in images[e].items()} for e in images if e not in standard]
    patches: list[dict[int, Column]] = [{} for _ in placed.partition.pieces]
    patches[root], unknowns, tree = dict(enumerate(columns)), len(columns), spanning_tree(faces, root)
    for number, parent, child in tree:
        terms = (faces[number].plane.raw ** (order + 1)).to_dict().items()
        shifts = enumerate(exponents(degree - order - 1), start=unknowns)
        step: dict[int, Column] = {u: {(a + i, b + j, c + k): v for (i, j, k), v in terms} for u, (a, b, c) in shifts}
        patches[child] = patches[parent] | step
        unknowns += len(step)
    rows: list[dict[int, fmpq]] = []
    for number, face in enumerate(faces):
        if number not in {used for used, _, _ in tree}:
            crossing = _difference(patches[face.second], patches[face.first])
            plane = Ideal.from_raw(face.plane.raw ** (order + 1))
            rows += plane.equations(((u, c.items()) for u, c in crossing), degree)
    for number, pieces in enumerate(placed.carriers):
        for piece in pieces:
            if (number, piece) != (first, root):
                by_unknown = ((u, column.items()) for u, column in patches[piece].items())
                rows += contacts[number].ideal(order).equations(by_unknown, degree)
    basis, denominator = integral_nullspace(rows, unknowns)
    parts = [whole_rows([patch.get(u, {}) for u in range(unknowns)], positions(degree)) for patch in patches]
    common = lcm(*(own for _, own in parts))
    return Products(basis, tuple(table * (common // own) for table, own in parts), denominator * common)


def _difference(patch: Mapping[int, Column], other: Mapping[int, Column]) -> Iterator[tuple[int, Column]]:
    """The contribution of each unknown to the difference of two patches, which have many in common."""
    yield from ((u, column) for u, column in patch.items() if u not in other)
    yield from ((u, {e: -c for e, c in column.items()}) for u, column in other.items() if u not in patch)
