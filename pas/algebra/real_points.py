"""How many real points an ideal has, exactly.

For a zero-dimensional ideal the trace form `(p, q) -> trace(multiplication by p q)` on the quotient
ring has as signature the number of distinct real zeros (Hermite 1856; Pedersen, Roy and Szpirglas
1993).  It is worked out over Q; signs are those of the characteristic polynomial's coefficients
(Descartes' rule is exact where all roots are real).

A curve V(f, h) has a regular real point iff the distance from some generic point has a critical
point there, so its emptiness comes down to the same count.
"""

from __future__ import annotations

from itertools import pairwise

from flint import fmpq, fmpq_mat

from pas.algebra.ideal import Ideal
from pas.algebra.monomials import Exponents
from pas.algebra.normal_form import NormalForm
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector
from pas.algebra.zeros import standard_monomials

VIEWPOINTS = (
    (fmpq(3, 7), fmpq(-5, 11), fmpq(8, 13)),
    (fmpq(-19, 3), fmpq(23, 5), fmpq(29, 7)),
    (fmpq(101, 9), fmpq(-57, 4), fmpq(-83, 6)),
)
"""Points from which distances are taken; a curve all of whose points are critical for all three
distances is not cut out transversally."""


def count_real_points(ideal: Ideal) -> int | None:
    """The number of distinct real zeros of an ideal, None where it has infinitely many complex ones."""
    if ideal.is_whole_ring:
        return 0
    standard = standard_monomials(ideal.form)
    return None if standard is None else _signature(_trace_form(ideal.form, standard))


def has_real_curve(surface: Polynomial, clip: Polynomial) -> bool | None:
    """Whether V(surface, clip) is a real curve somewhere, not empty nor isolated points.

    None where the two touch along a whole component, so that distances do not decide it.
    """
    singular = count_real_points(Ideal(surface, clip, *_normals(surface, clip)))
    if singular is None:
        return None
    for viewpoint in VIEWPOINTS:
        # every singular point counts as critical, whatever the viewpoint
        number = count_real_points(Ideal(surface, clip, _critical(surface, clip, viewpoint)))
        if number is not None:
            return number > singular
    return None


def _normals(f: Polynomial, h: Polynomial) -> list[Polynomial]:
    """The components of `grad f x grad h`."""
    a, b = ([p.diff(i) for i in range(3)] for p in (f, h))
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def _critical(f: Polynomial, h: Polynomial, point: Vector) -> Polynomial:
    """`det(grad f, grad h, x - point)`: zero where the distance from the point is critical on V(f, h)."""
    offsets = (Polynomial.from_raw(g - o) for g, o in zip(GENERATORS, point, strict=True))
    return sum((n * c for n, c in zip(_normals(f, h), offsets, strict=True)), Polynomial(0))


def _trace_form(form: NormalForm, standard: list[Exponents]) -> fmpq_mat:
    """The matrix of `(p, q) -> trace(multiplication by p q)`."""
    highest = 2 * max(map(sum, standard))
    images = form.images(highest)
    products = {(a, b): images[_plus(a, b)] for a in standard for b in standard}
    traces = {a: sum((products[a, b].get(b, fmpq(0)) for b in standard), fmpq(0)) for a in standard}
    table = [[sum((c * traces[m] for m, c in products[a, b].items()), fmpq(0)) for b in standard] for a in standard]
    return fmpq_mat(table)


def _signature(matrix: fmpq_mat) -> int:
    """Positive less negative eigenvalues of a symmetric matrix."""
    coefficients = [c for c in matrix.charpoly().coeffs() if c != 0]
    alternating = [c if i % 2 == 0 else -c for i, c in enumerate(matrix.charpoly().coeffs()) if c != 0]
    return _variations(coefficients) - _variations(alternating)


def _variations(values: list[fmpq]) -> int:
    return sum((a > 0) != (b > 0) for a, b in pairwise(values))


def _plus(a: Exponents, b: Exponents) -> Exponents:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]
