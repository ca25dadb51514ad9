"""Trees of unions and intersections as arrays, against the same trees branch by branch."""

from __future__ import annotations

import numpy as np
import pytest

from pas.solid import gates
from pas.solid.gates import Branch, Gates, Leaf

COLUMNS = 6


def drawn(rng, depth):
    """A random tree."""
    if depth == 0 or rng.random() < 0.2:
        return Leaf(int(rng.integers(COLUMNS)), bool(rng.integers(2)))
    parts = tuple(drawn(rng, depth - 1) for _ in range(rng.integers(1, 5)))
    return Branch(parts, bool(rng.integers(2)))


def holds(code, yes, no):
    if isinstance(code, Leaf):
        return (no if code.negated else yes)[code.column]
    return (np.any if code.union else np.all)([holds(part, yes, no) for part in code.parts], axis=0)


def extremes(code, values):
    if isinstance(code, Leaf):
        return -values[code.column] if code.negated else values[code.column]
    return (np.min if code.union else np.max)([extremes(part, values) for part in code.parts], axis=0)


def relevant(code, yes, no):
    """What the tree reads where neither the branch nor one that it is in is decided."""
    found = np.zeros((2, *yes.shape), dtype=bool)

    def visit(code, open_):
        open_ = open_ & ~holds(code, yes, no) & holds(code, ~no, ~yes)
        if isinstance(code, Leaf):
            found[int(code.negated), code.column] |= open_
        else:
            for part in code.parts:
                visit(part, open_)

    visit(code, np.ones(yes.shape[1], dtype=bool))
    return found


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("number", [0, 1, 300])
def test_as_branch_by_branch(seed, number, monkeypatch):
    monkeypatch.setattr(gates, "TOGETHER", 16)  # several blocks
    rng = np.random.default_rng(seed)
    code = drawn(rng, 4)
    made = Gates(code, COLUMNS)
    values = rng.normal(size=(COLUMNS, number)).round(1)
    sure = rng.random((COLUMNS, number)) < 0.6
    yes, no = (values <= 0) & sure, (values > 0) & sure
    assert np.array_equal(made.holds(yes, no), holds(code, yes, no))
    assert np.array_equal(made.extremes(values), extremes(code, values))
    assert np.array_equal(np.stack(made.relevant(yes, no)), relevant(code, yes, no))
