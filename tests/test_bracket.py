"""Newton's method between two ends."""

from __future__ import annotations

import numpy as np
import pytest

from pas.algebra.bracket import sign_change, zeros_of_columns


@pytest.mark.parametrize(
    "root, function, slope",
    [
        (0.9, lambda x: x - 0.9, lambda x: np.ones_like(x)),
        (0.2, lambda x: np.arctan(40 * (x - 0.2)), lambda x: 40 / (1 + (40 * (x - 0.2)) ** 2)),  # Newton alone diverges
        (0.5**0.25, lambda x: x**16 - 1 / 16, lambda x: 16 * x**15),
        (0.9, lambda x: (x - 0.9) ** 3, lambda x: 3 * (x - 0.9) ** 2),  # Newton alone gains a third in each step
        (0.7, lambda x: np.sign(x - 0.7), lambda x: np.zeros_like(x)),  # halvings alone
    ],
)
@pytest.mark.parametrize("start", [0.0, 0.5, 1.0])
def test_the_end_comes_however_a_function_bends(root, function, slope, start):
    wide = np.array([1.0, 64.0])  # brackets of different lengths at once

    def jets(at, rows):
        return function(at / wide[rows]), slope(at / wide[rows]) / wide[rows]

    found = sign_change(jets, 0 * wide, wide, start * wide) / wide
    assert found == pytest.approx([root] * 2, abs=1e-13)


def test_polynomials_in_columns():
    columns = np.array([[-1.0, -1.0, -1e-9, -1.0], [2.0, 0.0, 0.0, 0.0], [0.0, 4.0, 1.0, 0.5]])
    assert zeros_of_columns(columns) == pytest.approx([0.5, 0.5, 1e-9**0.5, 1.0], rel=1e-13)
