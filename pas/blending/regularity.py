"""Which members of a space are of use at a contact: those whose alpha is not zero on its curve.

A member g that meets a contact (f, h) is `alpha f + beta h^(k+1)`.  Where alpha vanishes on all of
the curve V(f, h), g is singular along it and continues nothing.
"""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_mat

from pas.algebra.normal_form import NormalForm
from pas.algebra.nullspace import nullspace
from pas.algebra.polynomial import Polynomial
from pas.blending.space import Space


def vanishing_alpha(space: Space, contact: int) -> fmpq_mat:
    """The members with alpha = 0 on the curve of contact number `contact`, as coefficient rows.

    `g = alpha f + beta h^(k+1)` has alpha in `<f, h>` iff g lies in `<f^2, h>`.
    """
    join = space.placed.joins[contact]
    form = NormalForm([join.contact.surface.raw**2, join.contact.clip.raw])
    images = form.images(space.degree)
    matrices = [space.patches[piece] for piece in join.pieces]
    rows: dict[Any, dict[int, fmpq]] = {}
    for place, matrix in enumerate(matrices):
        for number, coefficients in enumerate(matrix.tolist()):
            patch = Polynomial.from_row(coefficients, space.degree)
            for e, c in patch.raw.to_dict().items():
                for target, value in images[e].items():
                    row = rows.setdefault((place, target), {})
                    row[number] = row.get(number, fmpq(0)) + c * value
    return nullspace([{j: v for j, v in row.items() if v != 0} for row in rows.values()], space.dimension)


def is_regular(space: Space) -> bool:
    """Whether some member meets every contact with alpha not identically zero on its curve."""
    singular = (vanishing_alpha(space, i).nrows() for i in range(len(space.contacts)))
    return space.dimension > 0 and all(found < space.dimension for found in singular)
