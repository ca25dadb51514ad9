"""Exact algebra beside computer algebra systems, in one run: seconds, and ratios to ours.

    python benchmarks/solutions.py [--repeat 3] [--limit 60]

- intersections of contact ideals: `pas.Ideal` beside sympy's elimination with a Groebner basis;
- syzygies: `pas.syzygies` beside sympy's modules (agca);
- nullspaces of C^1 conditions in B-form: `pas.algebra.nullspace` beside sympy's sparse DomainMatrix;
- the corner and the mesh of 162 jittered tetrahedra, ours alone.

sympy always takes part; Singular and Macaulay2 do where they are installed (whole processes, less
the time of an empty one).  What takes longer than the limit is given up and shown as such.
"""

from __future__ import annotations

import argparse
import multiprocessing
import shutil
import subprocess
import time
from collections.abc import Callable
from fractions import Fraction
from itertools import permutations, product
from random import Random
from typing import Any

import sympy

import pas
from pas.algebra.nullspace import solve_sparse
from pas.blending.net import Net
from pas.blending.place import place
from pas.blending.solving import solve
from pas.surface.placed import PlacedContacts

X, Y, Z, W = sympy.symbols("x y z w")
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
PAIRS = {
    "coaxial": [("y^2+z^2-1", "x-1"), ("y^2+z^2-4", "x+1")],
    "perpendicular": [("y^2+z^2-1", "x-2"), ("x^2+z^2-1", "y-2")],
    "three": [("y^2+z^2-1", "x-2"), ("x^2+z^2-1", "y-2"), ("x^2+y^2-1", "z-2")],
}


def seconds(work: Callable[[], Any], repeat: int) -> float:
    """The least seconds of several calls."""
    best = float("inf")
    for _ in range(repeat):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best


def limited(work: Callable[[], Any], limit: float) -> float | None:
    """Seconds of one call in a process of its own, None where it takes longer than the limit."""

    def timed(queue: Any) -> None:
        queue.put(seconds(work, 1))

    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    process = context.Process(target=timed, args=(queue,))
    process.start()
    process.join(limit)
    if process.is_alive():
        process.kill()
        process.join()
        return None
    return float(queue.get())


def squared(pair: tuple[str, str]) -> tuple[str, str]:
    """The generators of <f, h^2>."""
    return pair[0], f"({pair[1]})^2"


def ours_intersection(pairs: list[tuple[str, str]]) -> pas.Ideal:
    """The intersection of all <f, h^2>."""
    first, *others = (pas.contact_ideal(pair, 1) for pair in pairs)
    for other in others:
        first = first & other
    return first


def sympys_intersection(pairs: list[tuple[str, str]]) -> list[Any]:
    """The same by eliminating w from w I + (1 - w) J, one ideal after the other."""
    basis = [pas.Polynomial(p).to_sympy() for p in squared(pairs[0])]
    for pair in pairs[1:]:
        other = [pas.Polynomial(p).to_sympy() for p in squared(pair)]
        mixed = [W * p for p in basis] + [(1 - W) * p for p in other]
        basis = [g for g in sympy.groebner(mixed, W, X, Y, Z, order="lex").exprs if W not in g.free_symbols]
    return basis


def vectors(pairs: list[tuple[str, str]]) -> list[tuple[str, ...]]:
    """The tuples whose syzygies are the multipliers: f_1 and h_1^2 against those of each other."""
    first, *others = map(squared, pairs)
    rows = [tuple(g for _ in others) for g in first]
    for number, other in enumerate(others):
        rows += [tuple(f"-({g})" if i == number else "0" for i in range(len(others))) for g in other]
    return rows


def sympys_syzygies(rows: list[tuple[str, ...]]) -> Any:
    """The same by sympy's modules."""
    ring = sympy.QQ.old_poly_ring(X, Y, Z, order="grevlex")
    free = ring.free_module(len(rows[0]))
    return free.submodule(*[[pas.Polynomial(p).to_sympy() for p in row] for row in rows]).syzygy_module()


def mesh(cubes: int) -> pas.Partition:
    """cubes^3 unit cubes of six tetrahedra, the inner vertices moved by small rationals."""
    random = Random(1)
    numbers, vertices = {}, []
    for corner in product(range(cubes + 1), repeat=3):
        numbers[corner] = len(vertices)
        inner = all(0 < c < cubes for c in corner)
        vertices.append([c + Fraction(random.randint(-3, 3), random.randint(10, 20)) * inner for c in corner])
    cells = []
    for base in product(range(cubes), repeat=3):
        for order in permutations(range(3)):
            corner = list(base)
            cell = [numbers[tuple(corner)]]
            for axis in order:
                corner[axis] += 1
                cell.append(numbers[tuple(corner)])
            cells.append(cell)
    return pas.Partition(vertices, cells)


def sympys_nullspace(rows: list[dict[int, Any]], unknowns: int) -> Any:
    """The nullspace of sparse rows by sympy's sparse matrices over the rationals."""
    from sympy.polys.matrices import DomainMatrix

    table = {i: {j: sympy.QQ(int(v.p), int(v.q)) for j, v in row.items()} for i, row in enumerate(rows)}
    return DomainMatrix(table, (len(rows), unknowns), sympy.QQ).nullspace()


def singular(code: str) -> float | None:
    """Seconds of a Singular program, less those of an empty one; None where it is not installed."""
    program = shutil.which("Singular")
    return None if program is None else _process([program, "-q"], f"{code}\nquit;\n", "quit;\n")


def macaulay(code: str) -> float | None:
    """Seconds of a Macaulay2 program, less those of an empty one; None where it is not installed."""
    program = shutil.which("M2")
    return None if program is None else _process([program, "--script", "/dev/stdin"], f"{code}\n", "\n")


def _process(command: list[str], code: str, nothing: str) -> float:
    def run(text: str) -> float:
        return seconds(lambda: subprocess.run(command, input=text, text=True, capture_output=True, check=True), 1)

    return max(run(code) - run(nothing), 0.0)


def row(name: str, ours: float, others: dict[str, float | None], limit: float) -> None:
    """One line of the table."""
    words = []
    for other, spent in others.items():
        if spent is None:
            words.append(f"{other} > {limit:.0f} s, over {limit / ours:.0f} times")
        else:
            words.append(f"{other} {1000 * spent:.1f} ms, {spent / ours:.1f} times")
    print(f"{name:<34} {1000 * ours:>9.1f} ms   {'; '.join(words)}", flush=True)


def installed(singular_code: str, macaulay_code: str) -> dict[str, float | None]:
    """The figures of the systems that are there."""
    found = {"Singular": singular(singular_code), "Macaulay2": macaulay(macaulay_code)}
    return {name: spent for name, spent in found.items() if spent is not None}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60, help="seconds before another system is given up")
    options = parser.parse_args()
    for name, pairs in PAIRS.items():
        ideals = [f"ideal({', '.join(squared(p))})" for p in pairs]
        others = {"sympy": limited(lambda pairs=pairs: sympys_intersection(pairs), options.limit)}
        others |= installed(
            f"ring R=0,(x,y,z),dp; intersect({','.join(ideals)});", f"R=QQ[x,y,z]; gens intersect({','.join(ideals)})"
        )
        row(
            f"intersection: {name}",
            seconds(lambda pairs=pairs: ours_intersection(pairs), options.repeat),
            others,
            options.limit,
        )
    for name, pairs in PAIRS.items():
        rows = vectors(pairs)
        columns = ",".join(f"[{','.join(v)}]" for v in rows)
        matrix = ",".join("{" + ",".join(v[i] for v in rows) + "}" for i in range(len(rows[0])))
        others = {"sympy": limited(lambda rows=rows: sympys_syzygies(rows), options.limit)}
        others |= installed(
            f"ring R=0,(x,y,z),dp; module M={columns}; syz(M);", f"R=QQ[x,y,z]; gens ker matrix{{{matrix}}}"
        )
        single = [v[0] for v in rows] if len(rows[0]) == 1 else rows
        row(
            f"syzygies: {name}",
            seconds(lambda given=single: pas.syzygies(given), options.repeat),
            others,
            options.limit,
        )
    for cubes, degree in ((1, 4), (2, 3), (2, 4)):
        net = Net(PlacedContacts(mesh(cubes), (), 1), degree)
        rows, unknowns = list(net._rows()), len(net.points)
        ours = seconds(lambda rows=rows, unknowns=unknowns: solve_sparse(rows, unknowns), options.repeat)
        others = {
            "sympy": limited(lambda rows=rows, unknowns=unknowns: sympys_nullspace(rows, unknowns), options.limit)
        }
        row(f"C^1, degree {degree}, {6 * cubes**3} tetrahedra", ours, others, options.limit)
    for radii in (("1/3", "1/3", "1/3"), ("1/3", "1/4", "2/5")):
        for order, degree in ((1, 3), (2, 4), (3, 5), (2, 6), (3, 7)):
            placed = place([pas.Pipe(a, r, 1) for a, r in zip(AXES, radii, strict=True)], order)
            ours = seconds(lambda placed=placed, n=degree: solve(placed, n), options.repeat)
            row(f"corner {radii[1]}, k={order}, n={degree}", ours, {}, options.limit)
    start = time.perf_counter()
    space = pas.solutions([], 1, 4, mesh(3))
    row(f"C^1 quartics, 162 tetrahedra ({space.dimension})", time.perf_counter() - start, {}, options.limit)


if __name__ == "__main__":
    main()
