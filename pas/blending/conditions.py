"""All piecewise polynomials that satisfy the contact and smoothness conditions, by linear algebra.

Two patches that share a face in the plane `pi = 0` meet with C^k iff `pi^(k+1)` divides their difference; a patch g
meets a contact (f, h) with GC^k iff g lies in `<f, h^(k+1)>` (Garrity and Warren 1991).  Both are linear, and the
unknowns are chosen so that most conditions hold by construction:

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

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import lcm

from flint import fmpq, fmpz_mat

from pas.algebra.matrices import Products
from pas.algebra.monomials import Exponents, count, exponents, positions
from pas.algebra.normal_form import NormalForm
from pas.algebra.nullspace import integral_nullspace
from pas.partition.complex import InteriorFace
from pas.surface.placed import PlacedContacts

Column = dict[Exponents, fmpq]


@dataclass(frozen=True)
class Conditions:
    """What a piecewise surface must satisfy: contacts in place, in local coordinates."""

    placed: PlacedContacts

    def solve(self, degree: int) -> Products:
        """A basis of all solutions of degree <= `degree`.

        Returns for each piece a matrix (dimension, C(degree+3, 3)): the patches of the basis
        members, with the monomials in the order of `pas.algebra.monomials`.
        """
        patches, unknowns = self._parametrised(degree)
        rows: list[dict[int, fmpq]] = []
        tree = {id(face) for face, _, _ in self._tree()}
        for face in self.placed.local.interior_faces:
            if id(face) not in tree:
                form = NormalForm([face.plane.raw ** (self.placed.order + 1)])
                crossing = _difference(patches[face.second], patches[face.first])
                rows += form.rows(((u, column.items()) for u, column in crossing), degree)
        for number, pieces in enumerate(self.placed.carriers):
            for piece in pieces:
                if piece != self._root or number != self._root_contact:
                    terms = ((u, column.items()) for u, column in patches[piece].items())
                    rows += self.contact_form(number).rows(terms, degree)
        basis, denominator = integral_nullspace(rows, unknowns)
        common = lcm(*(int(v.q) for patch in patches for column in patch.values() for v in column.values()))
        tables = tuple(_table(patch, unknowns, common, degree) for patch in patches)
        return Products(basis, tables, denominator * common)

    def contact_form(self, number: int) -> NormalForm:
        """Normal forms modulo `<f, h^(k+1)>` of a contact."""
        contact = self.placed.local_contacts[number]
        return NormalForm([contact.surface.raw, contact.clip.raw ** (self.placed.order + 1)])

    @property
    def _root_contact(self) -> int | None:
        return next((i for i, pieces in enumerate(self.placed.carriers) if pieces), None)

    @property
    def _root(self) -> int:
        number = self._root_contact
        return 0 if number is None else self.placed.carriers[number][0]

    def _tree(self) -> list[tuple[InteriorFace, int, int]]:
        """Faces of a breadth-first spanning tree from the root: (face, parent, child)."""
        reached, queue, tree = {self._root}, [self._root], []
        while queue:
            parent = queue.pop(0)
            for face in self.placed.local.interior_faces:
                if parent in (face.first, face.second):
                    child = face.second if parent == face.first else face.first
                    if child not in reached:
                        reached.add(child)
                        queue.append(child)
                        tree.append((face, parent, child))
        return tree

    def _parametrised(self, degree: int) -> tuple[list[dict[int, Column]], int]:
        """Each piece's patch as {unknown: polynomial}, and the number of unknowns."""
        root = self._root_columns(degree)
        patches: list[dict[int, Column]] = [{} for _ in self.placed.partition.pieces]
        patches[self._root] = dict(enumerate(root))
        unknowns = len(root)
        for face, parent, child in self._tree():
            factor = (face.plane.raw ** (self.placed.order + 1)).to_dict()
            step = {
                unknowns + i: {_plus(shift, e): c for e, c in factor.items()}
                for i, shift in enumerate(exponents(degree - self.placed.order - 1))
            }
            patches[child] = patches[parent] | step
            unknowns += len(step)
        return patches, unknowns

    def _root_columns(self, degree: int) -> list[Column]:
        number = self._root_contact
        if number is None:
            return [{e: fmpq(1)} for e in exponents(degree)]
        form = self.contact_form(number)
        images = form.images(degree)
        standard = set(form.standard(degree))
        return [{e: fmpq(1)} | {m: -c for m, c in images[e].items()} for e in exponents(degree) if e not in standard]


def _plus(a: Exponents, b: Exponents) -> Exponents:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _difference(patch: Mapping[int, Column], other: Mapping[int, Column]) -> Iterator[tuple[int, Column]]:
    """What each unknown adds to the difference of two patches, which have many in common."""
    yield from ((u, column) for u, column in patch.items() if u not in other)
    yield from ((u, {e: -c for e, c in column.items()}) for u, column in other.items() if u not in patch)


def _table(patch: Mapping[int, Column], unknowns: int, common: int, degree: int) -> fmpz_mat:
    """What each unknown adds to a patch, times the denominator `common`: (unknowns, C(n+3, 3))."""
    where = positions(degree)
    table = fmpz_mat(unknowns, count(degree))
    for unknown, column in patch.items():
        for monomial, value in column.items():
            table[unknown, where[monomial]] = int(value.p) * (common // int(value.q))
    return table
