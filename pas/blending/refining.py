"""Least quotients of quadratic forms, refined until every digit of a double is right: the same on every machine.

Eigenvectors in doubles differ in their last digits from one processor to the next, and in many more where the basis is
ill-conditioned.  Newton's method on `(A - r B) x = 0`, the length of x held (Peters and Wilkinson 1979), converges
quadratically from them to a simple eigenvalue; it runs in numbers of `BITS` bits.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat, ctx, fmpq_mat

from pas.arrays import Floats

BITS = 512

CLOSE = arb(2) ** -160
"""Change of the last step, over the vector: far below doubles, far above the rounding of `BITS` bits."""


def refined(
    start: Floats, above: fmpq_mat, below: fmpq_mat, weights: tuple[Sequence[arb], Sequence[arb]], change: fmpq_mat
) -> tuple[list[float], float] | None:
    """The vector near `start` that makes `|x above|^2 / |x below|^2` stationary, times `change`, and that quotient.

    `above` and `below` are (n, .), their columns weighted in the sums of squares.  None where the steps do not settle,
    as at an eigenvalue that is not simple.
    """
    steps = 6  # from three right digits on, one step doubles them: five give 96 digits, more than `CLOSE`
    with ctx.workprec(BITS):
        first, second = (_gram(m, w) for m, w in zip((above, below), weights, strict=True))
        vector = arb_mat(len(start), 1, [arb(float(c)) for c in start])
        quotient = _form(first, vector) / _form(second, vector)
        for _ in range(steps):
            try:
                step, turn = _newton(first, second, vector, quotient)
            except ZeroDivisionError:
                return None
            vector, quotient = (vector + step).mid(), (quotient + turn).mid()
            if _size(step) < CLOSE * _size(vector):
                row = vector.transpose() * arb_mat(change)
                exists = abs(quotient) > CLOSE * _trace(first) / _trace(second)
                return [float(c) for c in row.entries()], float(quotient) if exists else 0.0
    return None


def _gram(matrix: fmpq_mat, weights: Sequence[arb]) -> arb_mat:
    rows = arb_mat(matrix)
    scaled = [[c * w for c, w in zip(row, weights, strict=True)] for row in rows.tolist()]
    return arb_mat(scaled) * rows.transpose()


def _form(gram: arb_mat, vector: arb_mat) -> arb:
    return (vector.transpose() * gram * vector)[0, 0].mid()


def _newton(first: arb_mat, second: arb_mat, vector: arb_mat, quotient: arb) -> tuple[arb_mat, arb]:
    """The changes of vector and quotient by one step."""
    n = vector.nrows()
    pencil, normal = first - second * quotient, second * vector
    rows = [[*row, -c] for row, c in zip(pencil.tolist(), normal.entries(), strict=True)]
    system = arb_mat([*rows, [*normal.entries(), arb(0)]])
    right = arb_mat(n + 1, 1, [*(-(pencil * vector)).entries(), arb(0)])
    *step, turn = system.solve(right).entries()
    return arb_mat(n, 1, step).mid(), turn.mid()


def _trace(gram: arb_mat) -> arb:
    return sum((gram[i, i] for i in range(gram.nrows())), arb(0)).mid()


def _size(vector: arb_mat) -> arb:
    return max((abs(c) for c in vector.entries()), key=float)
