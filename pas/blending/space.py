"""Solution spaces: all surfaces of a degree that meet the contacts, and the choice among them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

from pas.algebra.monomials import exponents, positions
from pas.algebra.normal_form import NormalForm
from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import rational, to_fraction
from pas.blending.conditions import Conditions
from pas.blending.corner import place
from pas.errors import NoSolutionError
from pas.fairing.energy import ThinPlate, box_products, tetrahedron_products
from pas.fairing.fairing import Fairing
from pas.partition.cells import Partition
from pas.surface.contact import Contact
from pas.surface.joins import joins
from pas.surface.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.blending.blend import Blend

HIGHEST_DEGREE = 12
"""Where the search for a lowest degree ends: matrices of 2730 unknowns on the corner."""

Member = tuple[Polynomial, ...]


class SolutionSpace:
    """All piecewise polynomials of one degree that satisfy every contact and face condition.

    `partition`, `contacts`, `order` and `degree` are the problem's; `patches[c]` holds the exact
    coefficients of the basis on cell c, in local coordinates, one member a row.  `given_basis`
    is None for the reduced basis, which follows from the problem.
    """

    def __init__(
        self,
        partition: Partition,
        contacts: Sequence[Contact],
        order: int,
        degree: int,
        patches: Sequence[fmpq_mat],
        given_basis: tuple[Member, ...] | None = None,
    ) -> None:
        self.partition, self.contacts, self.order, self.degree = partition, tuple(contacts), order, degree
        self.patches = tuple(patches)
        self.given_basis = given_basis

    @property
    def dimension(self) -> int:
        """How many members are linearly independent."""
        return int(self.patches[0].nrows())

    @cached_property
    def basis(self) -> tuple[Member, ...]:
        """A basis; each member is one exact polynomial for each cell, in the user's coordinates."""
        frame = self.partition.frame
        return tuple(
            tuple(frame.globalise(self._patch(c, i)) for c in range(len(self.patches))) for i in range(self.dimension)
        )

    @cached_property
    def regular(self) -> bool:
        """Whether some member meets every contact with alpha not identically zero on its curve."""
        return self.dimension > 0 and all(self._regular_at(i) for i in range(len(self.contacts)))

    def member(self, coefficients: Sequence[Any]) -> PiecewiseSurface:
        """The surface `sum a_j basis_j`, exact; `coefficients` are `dimension` exact numbers."""
        if len(coefficients) != self.dimension:
            raise ValueError(f"coefficients must be {self.dimension} numbers, not {len(coefficients)}")
        row = fmpq_mat(1, self.dimension, [rational(a, f"coefficients[{i}]") for i, a in enumerate(coefficients)])
        patches = [_polynomial((row * m).entries(), self.degree) for m in self.patches]
        return PiecewiseSurface(self.partition, self.contacts, self.order, patches, self.degree)

    def coordinates(self, polynomials: Sequence[Any]) -> tuple[Fraction, ...]:
        """The coefficients of a piecewise polynomial (one for each cell, user's coordinates).

        Raises `ValueError` where it is not a member of the space.
        """
        frame, where = self.partition.frame, positions(self.degree)
        target: list[fmpq] = []
        for polynomial in polynomials:
            local = frame.localise(Polynomial(polynomial)).raw.to_dict()
            if any(e not in where for e in local):
                raise ValueError(f"the polynomial {polynomial} is of a degree above the space's {self.degree}")
            target += [local.get(e, fmpq(0)) for e in exponents(self.degree)]
        columns = [row for matrix in self.patches for row in matrix.transpose().tolist()]
        table = [[*row, value] for row, value in zip(columns, target, strict=True)]
        reduced, rank = fmpq_mat(len(table), self.dimension + 1, [v for r in table for v in r]).rref()
        if rank != self.dimension:
            raise ValueError("the piecewise polynomial is not a member of the solution space")
        return tuple(to_fraction(reduced[i, self.dimension]) for i in range(rank))

    def change_basis(self, members: Sequence[Sequence[Any]]) -> SolutionSpace:
        """The same space, or a subspace, with the given members (coefficient rows) as its basis."""
        rows = [[rational(a, f"members[{i}]") for a in row] for i, row in enumerate(members)]
        change = fmpq_mat(rows)
        if change.ncols() != self.dimension or change.rank() < len(rows):
            raise ValueError(f"members must be linearly independent rows of {self.dimension} coefficients")
        patches = [change * m for m in self.patches]
        plain = SolutionSpace(self.partition, self.contacts, self.order, self.degree, patches)
        return SolutionSpace(self.partition, self.contacts, self.order, self.degree, patches, plain.basis)

    def restricted(self, members: Sequence[Sequence[Any]]) -> SolutionSpace:
        """The span of members given as polynomials, one for each cell, with these as its basis."""
        return self.change_basis([self.coordinates(member) for member in members])

    def energy_matrix(self, energy: ThinPlate | None = None) -> list[list[Fraction]]:
        """The exact matrix K of the basis for an energy: `E = 1/2 a^T K a` for coefficients a."""
        energy = energy or ThinPlate()
        if energy.domain is not None:
            total = box_products([m[energy.piece].raw for m in self.basis], energy.domain)
        else:
            total = fmpq_mat(self.dimension, self.dimension)
            for cell, piece in zip(self.partition.cells, self.partition.piece_of, strict=True):
                patches = [m[piece].raw for m in self.basis]
                total += tetrahedron_products(patches, self.partition.corners(cell), self.degree)
        return [[to_fraction(v) for v in row] for row in total.tolist()]

    def fit(self, **options: Any) -> Blend:
        """Choose one member; takes the options of `pas.blend` (see there) that shape the surface."""
        from pas.blending.blend import fit

        return fit(self, **options)

    @lru_cache(maxsize=4)  # noqa: B019  (a space lives as long as its working bases)
    def fairing(self, energy: ThinPlate) -> Fairing:
        """The prepared choice among the members for one energy."""
        return Fairing(self.partition, self.contacts, self.order, self.degree, self.patches, energy)

    def __repr__(self) -> str:
        return (
            f"SolutionSpace(GC^{self.order}, degree {self.degree}, dimension {self.dimension}, {self.partition.name})"
        )

    def _patch(self, cell: int, member: int) -> Polynomial:
        return _polynomial(self.patches[cell].tolist()[member], self.degree)

    def _regular_at(self, number: int) -> bool:
        """Whether a member has alpha not in <f, h>; as g = alpha f + .., iff g not in <f^2, h>."""
        zero = [Polynomial(0)] * len(self.patches)
        join = PiecewiseSurface(self.partition, self.contacts, self.order, zero, self.degree).joins[number]
        form = NormalForm([join.contact.surface.raw**2, join.contact.clip.raw])
        piece = join.pieces[0]
        return any(not form.reduce(self._patch(piece, i).raw).is_zero() for i in range(self.dimension))


def solutions(
    contacts: Sequence[Any], order: int, degree: int | None = None, partition: Partition | None = None
) -> SolutionSpace:
    """All piecewise surfaces that meet the contacts with GC^`order`.

    `contacts` are pipes, contacts or pairs (surface, clip); without a `partition`, three
    perpendicular ones get the six-tetrahedra corner.  With a `degree`, all solutions of that
    degree (the dimension may be 0); without, those of the lowest degree that has any.

    Raises `GeometryError` where the contacts do not fit, `NoSolutionError` where no degree up to
    12 has a solution, `ValueError` or `TypeError` for a wrong argument.
    """
    check_order(order)
    region, turned = place(contacts, partition)
    if degree is not None:
        return solve(region, turned, order, check_degree(degree))
    dimensions: dict[int, int] = {}
    for candidate in range(1, HIGHEST_DEGREE + 1):
        space = solve(region, turned, order, candidate)
        dimensions[candidate] = space.dimension
        if space.dimension:
            return space
    raise NoSolutionError(f"no surface of degree <= {HIGHEST_DEGREE} meets the contacts with GC^{order}", dimensions)


def solve(partition: Partition, contacts: Sequence[Contact], order: int, degree: int) -> SolutionSpace:
    """The solution space of one degree for contacts that are in place."""
    local = partition.local
    frame = partition.frame
    moved = tuple(Contact(frame.localise(c.surface), frame.localise(c.clip)) for c in contacts)
    carriers = tuple(join.pieces for join in joins(local, moved))
    patches = Conditions(local, moved, carriers, order).solve(degree)
    return SolutionSpace(partition, contacts, order, degree, patches)


def check_order(order: Any) -> int:
    """The order of contact, checked."""
    if isinstance(order, bool) or not isinstance(order, int):
        raise TypeError(f"order must be a whole number (0 for continuous, 1 for GC^1, ...), not {order!r}")
    if not 0 <= order <= 8:
        raise ValueError(f"order must be from 0 to 8, not {order}")
    return order


def check_degree(degree: Any) -> int:
    """The degree, checked."""
    if isinstance(degree, bool) or not isinstance(degree, int):
        raise TypeError(f"degree must be a whole number, not {degree!r}")
    if not 1 <= degree <= HIGHEST_DEGREE:
        raise ValueError(f"degree must be from 1 to {HIGHEST_DEGREE}, not {degree}")
    return degree


def _polynomial(coefficients: Sequence[fmpq], degree: int) -> Polynomial:
    terms = {e: c for e, c in zip(exponents(degree), coefficients, strict=True) if c != 0}
    return Polynomial.from_raw(RING.from_dict(terms))
