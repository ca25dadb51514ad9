"""Solution spaces, exact: all surfaces of a degree that meet contacts in place, as a vector space.

Here is linear algebra alone: members, coordinates, subspaces, values.  What is worked out from a
space is a function beside it: the use of its members (`pas.blending.regularity`),
generators and multipliers, optima and handles (`shaping`).  `pas.SolutionSpace` is a space with all these as methods,
and with the choice of a member: it stands above, since they are functions of spaces.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cache, cached_property
from typing import Any, Self, TypeAlias

from flint import fmpq, fmpq_mat, fmpz_mat

from pas.algebra.matrices import Products, leads
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, VectorLike, rational, to_fraction, vector
from pas.algebra.systems import Exported, Rows, spanned
from pas.elsewhere import elsewhere
from pas.errors import NoSolutionError
from pas.fairing.functionals import Functional, value_at
from pas.fairing.prepared import PreparedSpace
from pas.piecewise import PiecewiseSurface
from pas.surface.placed import InPlace, PlacedContacts

Member = tuple[Polynomial, ...]
"""A piecewise polynomial: one polynomial for each piece."""

MemberLike: TypeAlias = "PolynomialLike | Sequence[PolynomialLike]"
"""What is taken for one; a polynomial alone where there is one piece."""


class Space(InPlace, Exported):
    """All piecewise polynomials of one degree that satisfy every contact and face condition.

    `placed` are the problem's contacts in place; `source` holds the patches of the basis.  `given_basis` is None for a
    basis that follows from the problem.  `degrees_tried` maps the degrees that were looked at to the dimensions found.

    Subspaces are of the same class as the space.
    """

    def __init__(
        self,
        placed: PlacedContacts,
        degree: int,
        patches: Sequence[fmpq_mat] | Products,
        given_basis: tuple[Member, ...] | None = None,
        degrees_tried: Mapping[int, int] | None = None,
        prepare: Callable[[], PreparedSpace] | None = None,
    ) -> None:
        self.placed, self.degree, self.given_basis = placed, degree, given_basis
        self.source = patches if isinstance(patches, Products) else Products.of(tuple(patches))
        self.degrees_tried = dict(degrees_tried or {degree: self.dimension})
        self.prepare = prepare or cache(lambda: PreparedSpace(placed, degree, self.source))

    @classmethod
    def of(cls, space: Space) -> Self:
        """A space as one of this class; what is known of it is not worked out again."""
        if isinstance(space, cls):
            return space
        known = space.placed, space.degree, space.source, space.given_basis, space.degrees_tried, space.prepare
        return cls(*known)

    def __reduce__(self) -> tuple[type[Self], tuple[Any, ...]]:
        """The members, exactly: what is prepared for their choice is prepared anew in another process."""
        return type(self), (self.placed, self.degree, self.source, self.given_basis, self.degrees_tried)

    @property
    def prepared(self) -> PreparedSpace:
        """The members in floating point, with what the fit asks of them; made once."""
        return self.prepare()

    def check_not_empty(self) -> None:
        """Raise `NoSolutionError` where it has no members but 0."""
        if self.dimension == 0:
            raise NoSolutionError(f"the solution space of degree {self.degree} is empty", self.degrees_tried)

    @property
    def dimension(self) -> int:
        """How many members are linearly independent."""
        return self.source.size

    @property
    def patches(self) -> tuple[fmpq_mat, ...]:
        """The exact coefficients (dimension, C(n+3, 3)) of the basis on each piece, in local coordinates."""
        return self.source.matrices

    @cached_property
    def basis(self) -> tuple[Member, ...]:
        """A basis; each member is one exact polynomial for each piece, in the user's coordinates."""
        rows, frame = [m.tolist() for m in self.patches], self.partition.frame
        local = ([Polynomial.from_row(row[i], self.degree) for row in rows] for i in range(self.dimension))
        return tuple(tuple(map(frame.globalise, member)) for member in local)

    @property
    def rows(self) -> Rows:
        return self.basis

    def member(self, coefficients: Sequence[Exact]) -> PiecewiseSurface:
        """The surface `sum a_j basis_j`, exact; `coefficients` are `dimension` exact numbers."""
        if len(coefficients) != self.dimension:
            raise ValueError(f"coefficients must be {self.dimension} numbers, not {len(coefficients)}")
        row = fmpq_mat(1, self.dimension, [rational(a, f"coefficients[{i}]") for i, a in enumerate(coefficients)])
        patches = [Polynomial.from_row((row * m).entries(), self.degree) for m in self.patches]
        return PiecewiseSurface.in_place(self.placed, patches, self.degree)

    def coordinates(self, polynomials: MemberLike) -> tuple[Fraction, ...]:
        """The coefficients of a piecewise polynomial (one for each piece, user's coordinates).

        Raises `ValueError` where it is not a member of the space.
        """
        (row,) = self._coordinate_rows([polynomials]).tolist()
        return tuple(map(to_fraction, row))

    def __contains__(self, polynomials: Any) -> bool:
        try:
            self.coordinates(polynomials)
        except ValueError:
            return False
        return True

    def equals(self, other: Space) -> bool:
        """Whether two spaces have the same members, whatever their bases."""
        if (self.dimension, len(self.patches)) != (other.dimension, len(other.patches)):
            return False
        return all(member in other for member in self.basis)

    def change_basis(self, members: Sequence[Sequence[Exact]]) -> Self:
        """The space that the given members (rows of coefficients) span, with these as its basis."""
        rows = [[rational(a, f"members[{i}]") for a in row] for i, row in enumerate(members)]
        if any(len(row) != self.dimension for row in rows):
            raise ValueError(f"members must be rows of {self.dimension} coefficients")
        return self.subspace(fmpq_mat(len(rows), self.dimension, [v for row in rows for v in row]))

    def restricted(self, members: Sequence[MemberLike]) -> Self:
        """The span of members given as polynomials, one for each piece, with these as its basis."""
        return self.subspace(self._coordinate_rows(members))

    def subspace(self, rows: fmpq_mat) -> Self:
        """The span of members given by exact coefficient rows (m, dimension), with these as its basis."""
        if rows.nrows() and rows.rank() < rows.nrows():
            raise ValueError("members must be linearly independent")
        return self._with([rows * m for m in self.patches])

    def _with(self, patches: Sequence[fmpq_mat]) -> Self:
        """The space of other members, given by their coefficients on each piece, with these as its basis."""
        plain = Space(self.placed, self.degree, patches)
        return type(self)(self.placed, self.degree, patches, plain.basis)

    def reduced(self) -> Self:
        """This space with a basis of short polynomials: one that is LLL-reduced of all members with whole coefficients,
        in the partition's local coordinates (see `pas.algebra.matrices`).

        A tenth as many digits as in the usual basis for corners, a twentieth for nodes.  Those of 60 members take five
        to seven seconds, others up to a minute, in a process of its own, since nothing else can stop flint's LLL.
        """
        if not self.dimension:
            return self
        whole = self.source.rows.tolist(), [table.tolist() for table in self.source.tables]
        short = elsewhere("reducing a basis", "pas.algebra.matrices:short_products", *whole)
        return self._with([fmpq_mat(fmpz_mat(table)) for table in short])

    def through(self, points: Sequence[VectorLike]) -> Self:
        """The members that vanish at points (three exact numbers each; floats count as written)."""
        values = self.values(points)
        rows = [{j: v for j, v in enumerate(row) if v != 0} for row in values.tolist()]
        return self.subspace(nullspace(rows, self.dimension))

    def values(self, points: Sequence[VectorLike]) -> fmpq_mat:
        """Exact values of the basis members at points (three exact numbers each): (points, dimension)."""
        places = [
            value_at(self.partition, vector(p, f"points[{i}]"), self.degree, f"points[{i}]")
            for i, p in enumerate(points)
        ]
        return self.functional_rows(places)

    def functional_rows(self, functionals: Sequence[Functional]) -> fmpq_mat:
        """Exact values of functionals on the basis members: (functionals, dimension)."""
        rows = [functional.on(self.patches) for functional in functionals]
        return fmpq_mat(len(rows), self.dimension, [v for row in rows for v in row])

    def _repr_latex_(self) -> str:
        """The order, the degree and the dimension, and the first members of one piece."""
        line = rf"GC^{{{self.order}}},\ n = {self.degree},\ \dim = {self.dimension}"
        if len(self.patches) > 1 or not self.dimension:
            return f"${line}$"
        return rf"${line}:\quad {spanned(self.basis)}$"

    def __repr__(self) -> str:
        what = f"GC^{self.order}, degree {self.degree}, dimension {self.dimension}, {self.partition.name}"
        return f"{type(self).__name__}({what})"

    @cached_property
    def _all_patches(self) -> fmpq_mat:
        """The coefficients on all pieces side by side: (dimension, pieces * C(n+3, 3))."""
        rows = [[v for m in tables for v in m] for tables in zip(*(m.tolist() for m in self.patches), strict=True)]
        width = sum(m.ncols() for m in self.patches)
        return fmpq_mat(self.dimension, width, [v for row in rows for v in row])

    @cached_property
    def _pivots(self) -> tuple[list[int], fmpq_mat]:
        """Columns of `_all_patches` that determine a member, and the inverse of that part."""
        reduced, rank = self._all_patches.rref()
        pivots = leads(reduced, rank)
        rows = self._all_patches.tolist()
        chosen = fmpq_mat(rank, rank, [row[j] for row in rows for j in pivots])
        return pivots, chosen.inv()

    def _coordinate_rows(self, members: Sequence[MemberLike]) -> fmpq_mat:
        """Coefficient rows of members given as polynomials, checked."""
        frame = self.partition.frame
        targets: list[list[fmpq]] = []
        for member in members:
            pieces = member if isinstance(member, Sequence) and not isinstance(member, str) else (member,)
            if len(pieces) != len(self.patches):
                raise ValueError(f"a member needs {len(self.patches)} polynomials, one for each piece")
            given = [Polynomial(p) for p in pieces]
            high = next((p for p in given if p.degree > self.degree), None)
            if high is not None:
                raise ValueError(f"the polynomial {high} is of a degree above the space's {self.degree}")
            targets.append([v for p in given for v in frame.localise(p).row(self.degree)])
        if not targets:
            return fmpq_mat(0, self.dimension)
        wanted = fmpq_mat(targets)
        pivots, inverse = self._pivots
        result = fmpq_mat(len(targets), len(pivots), [row[j] for row in targets for j in pivots]) * inverse
        if result * self._all_patches != wanted:
            raise ValueError("the piecewise polynomial is not a member of the solution space")
        return result
