"""Trees of unions and intersections as arrays, against the same trees branch by branch."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import pas
from pas.algebra.polynomial import Polynomial
from pas.solid import truths
from pas.solid.tree import Atom, Node, atoms, complement, mapped
from pas.solid.truths import CompiledTree

COLUMNS = [Polynomial(f"x - {column}") for column in range(6)]


def drawn(rng, depth):
    """A random tree."""
    if depth == 0 or rng.random() < 0.2:
        return Atom(COLUMNS[int(rng.integers(6))], "", bool(rng.integers(2)))
    parts = tuple(drawn(rng, depth - 1) for _ in range(rng.integers(1, 5)))
    return Node(parts, bool(rng.integers(2)))


def column(atom):
    return COLUMNS.index(atom.function)


def holds(tree, yes, no):
    if isinstance(tree, Atom):
        return (no if tree.outside else yes)[column(tree)]
    return (np.any if tree.union else np.all)([holds(part, yes, no) for part in tree.parts], axis=0)


def extremes(tree, values):
    if isinstance(tree, Atom):
        return -values[column(tree)] if tree.outside else values[column(tree)]
    return (np.min if tree.union else np.max)([extremes(part, values) for part in tree.parts], axis=0)


def relevant(code, yes, no):
    """What the tree reads where neither the branch nor one that it is in is decided."""
    found = np.zeros((2, *yes.shape), dtype=bool)

    def visit(code, open_):
        open_ = open_ & ~holds(code, yes, no) & holds(code, ~no, ~yes)
        if isinstance(code, Atom):
            found[int(code.outside), column(code)] |= open_
        else:
            for part in code.parts:
                visit(part, open_)

    visit(code, np.ones(yes.shape[1], dtype=bool))
    return found


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("number", [0, 1, 300])
def test_as_branch_by_branch(seed, number, monkeypatch):
    monkeypatch.setattr(truths, "TOGETHER", 16)  # several blocks
    rng = np.random.default_rng(seed)
    code = drawn(rng, 4)
    made = CompiledTree(code, lambda atom: (column(atom), atom.outside))
    values = rng.normal(size=(made.width, number)).round(1)
    sure = rng.random((made.width, number)) < 0.6
    yes, no = (values <= 0) & sure, (values > 0) & sure
    assert np.array_equal(made.holds(yes, no), holds(code, yes, no))
    assert np.array_equal(made.extremes(values), extremes(code, values))
    assert np.array_equal(np.stack(made.relevant(yes, no)), relevant(code, yes, no))


def test_operations_in_turn_nest_without_end():
    def made(first):
        tree = Atom(COLUMNS[first], "")
        for k in range(5000):
            tree = Node((tree, Atom(COLUMNS[k % 5], f"{k}")), bool(k % 2))
        return tree

    tree = made(5)
    assert tree == made(5) != made(4) and complement(complement(tree)) == tree != complement(tree)
    assert [atom.face for atom in atoms(tree)] == ["", *map(str, range(5000))]
    assert mapped(tree, lambda atom: atom) == tree and tree != Atom(COLUMNS[5], "") != tree
    compiled, yes = (
        CompiledTree(tree, lambda atom: (column(atom), atom.outside)),
        np.array([[True], [False]])[[0, 1] * 3],
    )
    expected = yes[5, 0]
    for k in range(5000):
        expected = (expected or yes[k % 5, 0]) if k % 2 else (expected and yes[k % 5, 0])
    assert compiled.holds(yes, ~yes)[0] == expected


def test_trees_are_equal_in_another_process(tmp_path):
    """Where texts have other hashes."""
    tree = Node((Atom(COLUMNS[0], "a"), Atom(COLUMNS[1], "b")), True)
    (tmp_path / "tree").write_bytes(pickle.dumps((tree, COLUMNS[:2])))
    code = (
        "import pickle, sys; from pas.solid.tree import Atom, Node;"
        "tree, (f, g) = pickle.load(open(sys.argv[1], 'rb'));"
        "new = Node((Atom(f, 'a'), Atom(g, 'b')), True); print(tree == new, hash(tree) == hash(new))"
    )
    command = [sys.executable, "-c", code, str(tmp_path / "tree")]
    seeded = os.environ | {"PYTHONHASHSEED": "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"}
    run = subprocess.run(command, env=seeded, capture_output=True, text=True, check=False)
    assert run.stdout.strip() == "True True", run.stderr


def test_functions_in_pieces_are_equal_by_what_they_are_made_of():
    node = pas.blend([pas.Pipe(axis, "1/2", 1) for axis in np.eye(3, dtype=int).tolist()], 1, energy=pas.ThinPlate())
    one, other = ({atom.function for atom in atoms(node.solid(1).rotate((1, 2, 3), 40).tree)} for _ in range(2))
    assert one == other and len(one) > 1
