"""Solution spaces: all surfaces of a degree that meet the contacts, and the choice among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

from pas.algebra.normal_form import NormalForm
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational, to_fraction, vector
from pas.fairing.constraints import Handle
from pas.fairing.energy import ThinPlate, box_products, tetrahedron_products
from pas.fairing.fairing import Fairing
from pas.fairing.functionals import Functional, value_at
from pas.limits import Report, limited
from pas.partition.cells import Partition
from pas.surface.contact import Contact
from pas.surface.joins import Join, joins
from pas.surface.piecewise import PiecewiseSurface

if TYPE_CHECKING:
    from pas.blending.blend import Blend
    from pas.blending.generators import Generator
    from pas.blending.multipliers import Consistency, Multipliers
    from pas.blending.shaping import LeastSquares, Optimum
    from pas.blending.trivial import TrivialPart

Member = tuple[Polynomial, ...]
"""A piecewise polynomial: one polynomial for each piece."""


class SolutionSpace:
    """All piecewise polynomials of one degree that satisfy every contact and face condition.

    `partition`, `contacts`, `order` and `degree` are the problem's; `patches[p]` holds the exact
    coefficients of the basis on piece p, in local coordinates, one member a row.  `given_basis`
    is None for a basis that follows from the problem.  `degrees_tried` maps the degrees that
    were looked at to the dimensions found.
    """

    def __init__(
        self,
        partition: Partition,
        contacts: Sequence[Contact],
        order: int,
        degree: int,
        patches: Sequence[fmpq_mat],
        given_basis: tuple[Member, ...] | None = None,
        degrees_tried: Mapping[int, int] | None = None,
    ) -> None:
        self.partition, self.contacts, self.order, self.degree = partition, tuple(contacts), order, degree
        self.patches = tuple(patches)
        self.given_basis = given_basis
        self.degrees_tried = dict(degrees_tried or {degree: self.dimension})

    @property
    def dimension(self) -> int:
        """How many members are linearly independent."""
        return int(self.patches[0].nrows())

    @cached_property
    def basis(self) -> tuple[Member, ...]:
        """A basis; each member is one exact polynomial for each piece, in the user's coordinates."""
        frame = self.partition.frame
        return tuple(tuple(map(frame.globalise, self._local_member(i))) for i in range(self.dimension))

    @cached_property
    def regular(self) -> bool:
        """Whether some member meets every contact with alpha not identically zero on its curve."""
        singular = (self.vanishing_alpha(i).nrows() for i in range(len(self.contacts)))
        return self.dimension > 0 and all(found < self.dimension for found in singular)

    @cached_property
    def trivial_part(self) -> TrivialPart:
        """The members of little use: singular along a contact, products of the data, reducible."""
        from pas.blending.trivial import trivial_part

        return trivial_part(self)

    @cached_property
    def generators(self) -> tuple[Generator, ...]:
        """Generators of all solutions of any degree, by ascending degree.

        For a single cell the reduced graded Groebner basis of the ideal that they form; for
        several pieces generators of the module over Q[x, y, z].
        """
        from pas.blending.generators import generators

        return generators(self)

    @cached_property
    def multipliers(self) -> tuple[Multipliers, ...]:
        """The multipliers of each basis member, by exact lifting (user's coordinates).

        At contact i the piece is `gamma[i] f + beta[i] h^(k+1)`, across interior face j
        `second = first + alpha[j] plane^(k+1)`, with gamma reduced modulo h^(k+1).
        """
        return tuple(self.consistency.multipliers(member) for member in self.basis)

    @cached_property
    def consistency(self) -> Consistency:
        """The system of equations that multipliers satisfy (Xu, Chen and Deng)."""
        from pas.blending.multipliers import consistency

        return consistency(self.partition, self.contacts, self.order)

    def member(self, coefficients: Sequence[Any]) -> PiecewiseSurface:
        """The surface `sum a_j basis_j`, exact; `coefficients` are `dimension` exact numbers."""
        if len(coefficients) != self.dimension:
            raise ValueError(f"coefficients must be {self.dimension} numbers, not {len(coefficients)}")
        row = fmpq_mat(1, self.dimension, [rational(a, f"coefficients[{i}]") for i, a in enumerate(coefficients)])
        patches = [Polynomial.from_row((row * m).entries(), self.degree) for m in self.patches]
        return PiecewiseSurface(self.partition, self.contacts, self.order, patches, self.degree)

    def coordinates(self, polynomials: Any) -> tuple[Fraction, ...]:
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

    def equals(self, other: SolutionSpace) -> bool:
        """Whether two spaces have the same members, whatever their bases."""
        if (self.dimension, len(self.patches)) != (other.dimension, len(other.patches)):
            return False
        return all(member in other for member in self.basis)

    def change_basis(self, members: Sequence[Sequence[Any]]) -> SolutionSpace:
        """The same space, or a subspace, with the given members (coefficient rows) as its basis."""
        rows = [[rational(a, f"members[{i}]") for a in row] for i, row in enumerate(members)]
        if any(len(row) != self.dimension for row in rows):
            raise ValueError(f"members must be rows of {self.dimension} coefficients")
        return self.subspace(fmpq_mat(len(rows), self.dimension, [v for row in rows for v in row]))

    def restricted(self, members: Sequence[Any]) -> SolutionSpace:
        """The span of members given as polynomials, one for each piece, with these as its basis."""
        return self.subspace(self._coordinate_rows(members))

    def subspace(self, rows: fmpq_mat) -> SolutionSpace:
        """The span of members given by exact coefficient rows (m, dimension), with these as its basis."""
        if rows.nrows() and rows.rank() < rows.nrows():
            raise ValueError("members must be linearly independent")
        patches = [rows * m for m in self.patches]
        plain = SolutionSpace(self.partition, self.contacts, self.order, self.degree, patches)
        return SolutionSpace(self.partition, self.contacts, self.order, self.degree, patches, plain.basis)

    def through(self, points: Sequence[Any]) -> SolutionSpace:
        """The members that vanish at points (three exact numbers each; floats count as written)."""
        values = self.values(points)
        rows = [{j: v for j, v in enumerate(row) if v != 0} for row in values.tolist()]
        return self.subspace(nullspace(rows, self.dimension))

    def values(self, points: Sequence[Any]) -> fmpq_mat:
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

    def energy_matrix(self, energy: ThinPlate | None = None) -> list[list[Fraction]]:
        """The exact matrix K of the basis for an energy: `E = 1/2 a^T K a` for coefficients a."""
        return [[to_fraction(v) for v in row] for row in self.exact_energy(energy or ThinPlate()).tolist()]

    def exact_energy(self, energy: ThinPlate) -> fmpq_mat:
        """`energy_matrix` as a matrix of python-flint, times the energy's weight."""
        if energy.domain is not None:
            piece = energy.piece_of(len(self.patches))
            return box_products([m[piece].raw for m in self.basis], energy.domain) * energy.weight
        total = fmpq_mat(self.dimension, self.dimension)
        for cell, piece in zip(self.partition.cells, self.partition.piece_of, strict=True):
            patches = [m[piece].raw for m in self.basis]
            total += tetrahedron_products(patches, self.partition.corners(cell), self.degree)
        return total * energy.weight

    def fit(self, **options: Any) -> Blend:
        """Choose one member; takes the options of `pas.blend` (see there) that shape the surface."""
        from pas.blending.blend import fit

        return fit(self, **options)

    @limited("finding the optimum", "a lower degree")
    def optimum(
        self,
        energy: ThinPlate | None = None,
        *,
        seconds: float | None = None,
        progress: Report | None = None,
        **options: Any,
    ) -> Optimum:
        """The exact member of least energy, with its certificate of optimality.

        `options` are those of `fit` that are linear: `inside`, `outside` (`margin` 0 by default),
        `through`, `near`, `near_weight`, `handles`, and `normalize`: the sum of coefficients is 1 by
        default, unless a handle with a value other than 0 fixes the scale.  No condition of a clean
        sheet is asked.

        Raises `InfeasibleError` for constraints that contradict, `NoSolutionError` for an empty space.
        """
        from pas.blending.shaping import optimum

        return optimum(self, energy, **options)

    def determining_set(self, prefer: Sequence[Handle] = ()) -> tuple[Handle, ...]:
        """B-coefficients that can be set freely and determine the member: `dimension` many.

        Each is (cell, multi-index of the cell's corners); those in `prefer` come first, as far as
        they are independent.  Set some of them with `optimum(handles=...)` or `fit(handles=...)`,
        and the rest follow.
        """
        from pas.blending.shaping import determining_set

        return determining_set(self, prefer)

    def least_squares(
        self, points: Sequence[Any], weights: Sequence[Any] | None = None, *, by_gradient: bool = False
    ) -> LeastSquares:
        """The member with the least `sum w_i f(p_i)^2 / |f|^2`, |f| the length of its coefficients.

        With `by_gradient` the divisor is `sum w_i |grad f(p_i)|^2` instead: the quotient is then a mean
        squared distance to first order, whatever the place and size of the figure (Taubin 1991).

        `points` are three numbers each (floats as the exact rationals they are).  For members through
        other points take `space.through(...)` first; with energy, inside or outside points use
        `fit(near=..., normalize=pas.UnitCoefficients())`.

        Raises `ValueError` for fewer points than dimensions less one.
        """
        from pas.blending.shaping import least_squares

        return least_squares(self, points, weights, by_gradient=by_gradient)

    @lru_cache(maxsize=4)  # noqa: B019  (a space lives as long as its working bases)
    def fairing(self, energy: ThinPlate) -> Fairing:
        """The prepared choice among the members for one energy."""
        return Fairing(self.partition, self.contacts, self.order, self.degree, self.patches, energy)

    @cached_property
    def joins(self) -> tuple[Join, ...]:
        """The contacts in local coordinates, with their places on the partition."""
        frame = self.partition.frame
        moved = [Contact(frame.localise(c.surface), frame.localise(c.clip)) for c in self.contacts]
        return joins(self.partition.local, moved)

    def vanishing_alpha(self, contact: int) -> fmpq_mat:
        """The members with alpha = 0 on the curve of contact number `contact`, as coefficient rows.

        `g = alpha f + beta h^(k+1)` has alpha in `<f, h>` iff g lies in `<f^2, h>`.
        """
        join = self.joins[contact]
        form = NormalForm([join.contact.surface.raw**2, join.contact.clip.raw])
        images = form.images(self.degree)
        matrices = [self.patches[piece] for piece in join.pieces]
        rows: dict[Any, dict[int, fmpq]] = {}
        for number in range(self.dimension):
            for place, matrix in enumerate(matrices):
                patch = Polynomial.from_row(matrix.tolist()[number], self.degree)
                for e, c in patch.raw.to_dict().items():
                    for target, value in images[e].items():
                        row = rows.setdefault((place, target), {})
                        row[number] = row.get(number, fmpq(0)) + c * value
        return nullspace([{j: v for j, v in row.items() if v != 0} for row in rows.values()], self.dimension)

    def __repr__(self) -> str:
        return (
            f"SolutionSpace(GC^{self.order}, degree {self.degree}, dimension {self.dimension}, {self.partition.name})"
        )

    def _local_member(self, number: int) -> Member:
        return tuple(Polynomial.from_row(m.tolist()[number], self.degree) for m in self.patches)

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
        table = reduced.tolist()
        pivots = [next(j for j, v in enumerate(table[i]) if v != 0) for i in range(rank)]
        rows = self._all_patches.tolist()
        chosen = fmpq_mat(rank, rank, [row[j] for row in rows for j in pivots])
        return pivots, chosen.inv()

    def _coordinate_rows(self, members: Sequence[Any]) -> fmpq_mat:
        """Coefficient rows of members given as polynomials, checked."""
        frame = self.partition.frame
        targets: list[list[fmpq]] = []
        for member in members:
            pieces = (member,) if isinstance(member, str | Polynomial) or not hasattr(member, "__len__") else member
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
        if self.dimension == 0:
            if any(v != 0 for row in targets for v in row):
                raise ValueError("the piecewise polynomial is not a member of the solution space")
            return fmpq_mat(len(targets), 0)
        pivots, inverse = self._pivots
        result = fmpq_mat(len(targets), len(pivots), [row[j] for row in targets for j in pivots]) * inverse
        if result * self._all_patches != wanted:
            raise ValueError("the piecewise polynomial is not a member of the solution space")
        return result
