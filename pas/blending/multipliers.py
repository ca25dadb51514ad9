"""Multipliers of piecewise blends: the syzygy method.

A patch that meets a contact (f, h) with GC^k is `gamma f + beta h^(k+1)`, and two patches that share a face in the
plane pi = 0 meet with C^k iff `second = first + alpha pi^(k+1)` (Garrity and Warren 1991).  Patches follow from
multipliers along a spanning tree of the cells; every other face and every other contact closes the system: a linear
system of equations over Q[x, y, z] for the multipliers, whose solutions of bounded degree are a nullspace, and all of
whose solutions are a syzygy module.

Multipliers of a patch are not unique: (gamma + q h^(k+1), beta - q f) serve too (Koszul).  Here gamma is the remainder
modulo h^(k+1), which makes them unique and raises no degree, so that the solutions are as many as the surfaces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

from flint import fmpq, fmpq_mpoly

from pas.algebra.brief import brief
from pas.algebra.buchberger import graded_syzygies
from pas.algebra.monomials import Exponents, homogeneous_exponents
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import RING, Polynomial
from pas.blending.lifting import lift, product_degree
from pas.contacts.contact import Contact
from pas.limits import checkpoint
from pas.partition.complex import InteriorFace
from pas.surface.placed import PlacedContacts

Signs = dict[int, int]
"""A sum of unknown products: the sign of each unknown's."""


@dataclass(frozen=True)
class Multipliers:
    """`patch = gamma f + beta h^(k+1)` at the contacts, `second = first + alpha plane^(k+1)`.

    `alpha[j]` belongs to interior face j; `gamma[s]` and `beta[s]` to the s-th pair of a contact
    and a patch that carries it, so to contact s where each has one carrier.
    """

    gamma: tuple[Polynomial, ...]
    beta: tuple[Polynomial, ...]
    alpha: tuple[Polynomial, ...]

    __repr__ = brief


@dataclass(frozen=True)
class Solution:
    """A piecewise polynomial, one for each patch, with its multipliers."""

    patches: tuple[Polynomial, ...]
    multipliers: Multipliers

    @property
    def degree(self) -> int:
        """The largest degree of a patch."""
        return max(p.degree for p in self.patches)


@dataclass(frozen=True)
class Consistency:
    """The system that multipliers satisfy.

    `contacts[i]` is met by each of the patches `carriers[i]` (their numbers, 0 to `patches` - 1),
    and patches meet across `interior_faces` with C^`order`; all in the same coordinates.
    """

    interior_faces: tuple[InteriorFace, ...]
    contacts: tuple[Contact, ...]
    carriers: tuple[tuple[int, ...], ...]
    patches: int
    order: int

    @cached_property
    def sites(self) -> tuple[tuple[int, int], ...]:
        """The pairs (contact, patch) that have a gamma and a beta."""
        return tuple((i, c) for i, patches in enumerate(self.carriers) for c in dict.fromkeys(patches))

    def solve(self, degree: int) -> tuple[Solution, ...]:
        """The canonical basis of all piecewise polynomials of degree <= `degree`.

        The unknowns are the coefficients of alpha, then of beta, then of gamma, each polynomial's
        from the highest monomial to the lowest; each member is 1 in its own free unknown and 0 in
        the others, and the free ones are the last possible.
        """
        tops = [product_degree(self.contacts[i], self.order, degree) for i, _ in self.sites]
        unknowns = [(u, e) for u, bounds in enumerate(self._bounds(degree, tops)) for e in bounds]
        columns: list[list[int]] = [[] for _ in self._factors]
        for number, (u, _) in enumerate(unknowns):
            columns[u].append(number)
        rows: list[dict[int, fmpq]] = []
        for equation in self._equations:
            checkpoint(f"setting up the consistency system of degree {degree}")
            rows += self._rows(equation, unknowns, columns).values()
        for s, top in enumerate(tops):
            if top > degree:
                high = self._rows(self._site(s), unknowns, columns)
                rows += [row for e, row in high.items() if sum(e) > degree]
        last = len(unknowns) - 1
        basis = nullspace([{last - n: v for n, v in row.items()} for row in rows], len(unknowns))
        return tuple(self._solution(unknowns, list(reversed(row))) for row in reversed(basis.tolist()))

    def generators(self) -> tuple[Solution, ...]:
        """Generators of all solutions, of any degree, over Q[x, y, z], by ascending degree.

        Those that come from products of degree <= d, times monomials, span all solutions that have products of degree
        <= d; none can be left out in this sense, and none is zero on all patches.
        """
        equations = self._equations or ({},)
        zero = RING.constant(0)
        vectors = [tuple(f * q[u] if u in q else zero for q in equations) for u, f in enumerate(self._factors)]
        found = graded_syzygies(vectors, [self._koszul(s) for s in range(len(self.sites))])
        solutions = (self._from_unknowns(self._normal(list(syzygy))) for syzygy in found)
        return tuple(sorted((s for s in solutions if s.degree >= 0), key=lambda s: s.degree))

    def multipliers(self, patches: Sequence[Any]) -> Multipliers:
        """The multipliers of a piecewise polynomial, by exact lifting and division.

        Raises `ValueError` where it misses a contact or is not C^k across a face.
        """
        member = [Polynomial(p) for p in patches]
        if len(member) != self.patches:
            raise ValueError(f"there must be {self.patches} patches, not {len(member)}")
        lifts = [lift(member[c], self.contacts[i], self.order) for i, c in self.sites]
        alpha = []
        for face in self.interior_faces:
            difference = member[face.second].raw - member[face.first].raw
            quotient, remainder = divmod(difference, face.plane.raw ** (self.order + 1))
            if not remainder.is_zero():
                raise ValueError(
                    f"patches {face.first + 1} and {face.second + 1} do not meet with C^{self.order} "
                    f"in the plane {face.plane} = 0"
                )
            alpha.append(Polynomial.from_raw(quotient))
        return Multipliers(tuple(g for g, _ in lifts), tuple(b for _, b in lifts), tuple(alpha))

    def solution(self, multipliers: Multipliers) -> Solution:
        """The piecewise polynomial that multipliers stand for.

        Raises `ValueError` where they do not satisfy the system.  (Cells that no contact is joined
        to get the patch that starts from zero.)
        """
        given = (*multipliers.alpha, *multipliers.beta, *multipliers.gamma)
        expected = len(self.interior_faces) + 2 * len(self.sites)
        if len(given) != expected:
            raise ValueError(f"there must be {expected} multipliers in all, not {len(given)}")
        unknowns = [p.raw for p in given]
        unknowns += [RING.constant(0)] * (len(self._factors) - expected)
        if any(not self._sum(equation, unknowns).is_zero() for equation in self._equations):
            raise ValueError("the multipliers do not satisfy the consistency system")
        return self._from_unknowns(unknowns)

    @cached_property
    def _factors(self) -> tuple[fmpq_mpoly, ...]:
        """The factor of each unknown: of alphas, betas, gammas and free patches."""
        power = self.order + 1
        alphas = (face.plane.raw**power for face in self.interior_faces)
        betas = (self.contacts[i].clip.raw ** power for i, _ in self.sites)
        gammas = (self.contacts[i].surface.raw for i, _ in self.sites)
        carriers = {c for _, c in self.sites}
        free = (RING.constant(1) for root in self._tree[1] if root not in carriers)
        return (*alphas, *betas, *gammas, *free)

    def _site(self, number: int) -> Signs:
        first = len(self.interior_faces)
        return {first + number: 1, first + len(self.sites) + number: 1}

    @cached_property
    def _tree(self) -> tuple[tuple[Signs, ...], tuple[int, ...], frozenset[int]]:
        """Each patch as a sum of unknown products, the roots, and the faces of the tree."""
        carried = {c: s for s, (_, c) in reversed(list(enumerate(self.sites)))}
        sums: dict[int, Signs] = {}
        roots: list[int] = []
        used: set[int] = set()
        free = len(self.interior_faces) + 2 * len(self.sites)
        for root in chain((c for _, c in self.sites), range(self.patches)):
            if root in sums:
                continue
            roots.append(root)
            sums[root] = self._site(carried[root]) if root in carried else {free: 1}
            free += root not in carried
            for j, parent, child in spanning_tree(self.interior_faces, root):
                sums[child] = sums[parent] | {j: 1 if self.interior_faces[j].first == parent else -1}
                used.add(j)
        return tuple(sums[c] for c in range(self.patches)), tuple(roots), frozenset(used)

    @cached_property
    def _equations(self) -> tuple[Signs, ...]:
        """Sums of unknown products that are zero: a face or a contact outside the tree each."""
        sums, _, used = self._tree
        equations = [
            _minus(_minus(sums[face.second], sums[face.first]), {j: 1})
            for j, face in enumerate(self.interior_faces)
            if j not in used
        ]
        equations += [_minus(sums[c], self._site(s)) for s, (_, c) in enumerate(self.sites)]
        return tuple(e for e in equations if e)

    def _bounds(self, degree: int, tops: Sequence[int]) -> list[list[Exponents]]:
        """The monomials of each unknown, from the highest to the lowest."""
        faces, sites = len(self.interior_faces), len(self.sites)
        bounds = []
        for u, factor in enumerate(self._factors):
            top = tops[(u - faces) % sites] if faces <= u < faces + 2 * sites else degree
            listed = descending(top - int(factor.total_degree()))
            if faces + sites <= u < faces + 2 * sites:
                lead = self._factors[u - sites].monomial(0)
                listed = [e for e in listed if any(a < int(b) for a, b in zip(e, lead, strict=True))]
            bounds.append(listed)
        return bounds

    def _rows(
        self, equation: Signs, unknowns: Sequence[tuple[int, Exponents]], columns: Sequence[Sequence[int]]
    ) -> dict[Exponents, dict[int, fmpq]]:
        """The coefficients of a sum of unknown products, by monomial, linear in the unknowns."""
        rows: dict[Exponents, dict[int, fmpq]] = {}
        for u, sign in equation.items():
            terms = [(tuple(map(int, e)), sign * c) for e, c in self._factors[u].to_dict().items()]
            for number in columns[u]:
                a, b, c = unknowns[number][1]
                for (i, j, k), value in terms:
                    rows.setdefault((a + i, b + j, c + k), {})[number] = value
        return rows

    def _solution(self, unknowns: Sequence[tuple[int, Exponents]], row: Sequence[fmpq]) -> Solution:
        terms: list[dict[Exponents, fmpq]] = [{} for _ in self._factors]
        for (u, e), value in zip(unknowns, row, strict=True):
            if value != 0:
                terms[u][e] = value
        return self._from_unknowns([RING.from_dict(t) for t in terms])

    def _from_unknowns(self, unknowns: Sequence[fmpq_mpoly]) -> Solution:
        alpha, sites = len(self.interior_faces), len(self.sites)
        beta, gamma = alpha + sites, alpha + 2 * sites
        patches = tuple(Polynomial.from_raw(self._sum(s, unknowns)) for s in self._tree[0])
        owned = [Polynomial.from_raw(p) for p in unknowns]
        return Solution(patches, Multipliers(tuple(owned[beta:gamma]), tuple(owned[alpha:beta]), tuple(owned[:alpha])))

    def _sum(self, signs: Signs, unknowns: Sequence[fmpq_mpoly]) -> fmpq_mpoly:
        return sum((sign * unknowns[u] * self._factors[u] for u, sign in signs.items()), RING.constant(0))

    def _koszul(self, site: int) -> tuple[fmpq_mpoly, ...]:
        """The solution (gamma, beta) = (h^(k+1), -f) whose patches are zero."""
        beta, gamma = self._site(site)
        result = [RING.constant(0)] * len(self._factors)
        result[gamma], result[beta] = self._factors[beta], -self._factors[gamma]
        return tuple(result)

    def _normal(self, unknowns: list[fmpq_mpoly]) -> list[fmpq_mpoly]:
        """Multipliers of equal patches with every gamma reduced modulo its h^(k+1), which makes them unique."""
        for s in range(len(self.sites)):
            beta, gamma = self._site(s)
            quotient, unknowns[gamma] = divmod(unknowns[gamma], self._factors[beta])
            unknowns[beta] += quotient * self._factors[gamma]
        return unknowns


def consistency(placed: PlacedContacts) -> Consistency:
    """The system of contacts in place, in the user's coordinates."""
    partition = placed.partition
    return Consistency(partition.interior_faces, placed.contacts, placed.carriers, len(partition.pieces), placed.order)


def spanning_tree(faces: Sequence[InteriorFace], root: int) -> list[tuple[int, int, int]]:
    """The faces of a breadth-first spanning tree of what is joined to a root: (face, parent, child), by numbers."""
    reached, tree = [root], list[tuple[int, int, int]]()
    for parent in reached:  # which grows on the way
        for number, face in enumerate(faces):
            if parent in (face.first, face.second):
                child = face.first + face.second - parent
                if child not in reached:
                    reached.append(child)
                    tree.append((number, parent, child))
    return tree


def descending(degree: int) -> list[Exponents]:
    """All exponents of degree <= `degree`, from the highest monomial to 1."""
    return [e for d in range(degree, -1, -1) for e in homogeneous_exponents(d)]


def _minus(left: Signs, right: Signs) -> Signs:
    total = {u: left.get(u, 0) - right.get(u, 0) for u in left | right}
    return {u: sign for u, sign in total.items() if sign}
