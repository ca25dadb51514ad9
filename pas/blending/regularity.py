"""Which members of a space are of use at a contact: those whose alpha is not zero on its curve.

A member g that meets a contact (f, h) is `alpha f + beta h^(k+1)`.  Where alpha vanishes on all of
the curve V(f, h), g is singular along it and continues nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from flint import fmpq, fmpq_mat

from pas.algebra.monomials import Exponents, exponents
from pas.algebra.normal_form import NormalForm, Sparse
from pas.algebra.nullspace import nullspace
from pas.blending.space import Space
from pas.contacts.contact import Contact
from pas.contacts.joins import Join


def vanishing_alpha(space: Space, contact: int) -> fmpq_mat:
    """The members with alpha = 0 on the curve of contact number `contact`, as coefficient rows.

    `g = alpha f + beta h^(k+1)` has alpha in `<f, h>` iff g lies in `<f^2, h>`.
    """
    join = space.placed.joins[contact]
    images = _form(join.contact).images(space.degree)
    rows: dict[Any, dict[int, fmpq]] = {}
    for piece in join.pieces:
        for number, coefficients in enumerate(space.patches[piece].tolist()):
            terms = zip(exponents(space.degree), coefficients, strict=True)
            for target, value in _remainder(images, terms).items():
                rows.setdefault((piece, target), {})[number] = value
    return nullspace(rows.values(), space.dimension)


def is_regular(space: Space) -> bool:
    """Whether some member meets every contact with alpha not identically zero on its curve.

    And, where it is that through which the region is open, leaves its surface at that curve: members of low degree are
    multiples of f, all of which is zero.
    """
    joins = space.placed.joins
    return space.dimension > 0 and all(
        _some_beyond(space, join, _form(join.contact))
        and (not join.opening or _some_beyond(space, join, NormalForm([join.contact.surface.raw])))
        for join in joins
    )


def _some_beyond(space: Space, join: Join, form: NormalForm) -> bool:
    """Whether some member is not in an ideal, in a piece that carries a contact: the first that is found will do."""
    images = form.images(space.degree)
    for piece in join.pieces:
        for member in range(space.dimension):
            row = map(fmpq, space.source.row(piece, member))
            if _remainder(images, zip(exponents(space.degree), row, strict=True)):
                return True
    return False


def _form(contact: Contact) -> NormalForm:
    """Modulo `<f^2, h>`, in which members with alpha = 0 lie."""
    return NormalForm([contact.surface.raw**2, contact.clip.raw])


def _remainder(images: Mapping[Exponents, Sparse], terms: Iterable[tuple[Exponents, fmpq]]) -> Sparse:
    """The normal form of a polynomial, given those of the monomials."""
    found: Sparse = {}
    for e, c in terms:
        if c != 0:
            for target, value in images[e].items():
                found[target] = found.get(target, fmpq(0)) + c * value
    return {target: value for target, value in found.items() if value != 0}
