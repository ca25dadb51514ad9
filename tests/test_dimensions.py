"""Spline spaces on splits of one cell: dimensions exactly, by floating-point rank and by published formulas."""

from __future__ import annotations

import runpy

import numpy as np
import pytest
from conftest import ROOT

import pas
from pas.partition.cells import read_partition

SPLITS = {"alfeld split": pas.AlfeldSplit, "worsey-farin split": pas.WorseyFarinSplit, "kuhn cube": pas.KuhnCube}
CELLS = {"alfeld split": 4, "worsey-farin split": 12, "kuhn cube": 6}

PUBLISHED = [
    *(("alfeld split", n, dimension) for n, dimension in ((3, 20), (4, 38), (5, 68))),
    *(("worsey-farin split", n, dimension) for n, dimension in ((2, 10), (3, 28), (4, 70))),
    *(("kuhn cube", n, dimension) for n, dimension in ((1, 4), (2, 13), (3, 34), (4, 73))),
]
"""C^1 dimensions: Alfeld 1984 and Kolesnikov and Sorokina 2014; Worsey and Farin 1987 and Guzman, Lischke and Neilan
2022; for the cube those of Schumaker 1979 around a vertex with six edges of three slopes, summed over the degrees."""

SMALL = 1e-9
"""Singular values over the largest one that count as none: on either side there are none within a factor of 1e4."""


def powers(points, degree):
    """Monomials (N, terms) up to a degree at points (N, 3), and their gradients (N, 3, terms)."""
    exponents = np.array([(i, j, k) for i, j, k in np.ndindex(*[degree + 1] * 3) if i + j + k <= degree])
    values = np.prod(points[:, None, :] ** exponents, axis=2)
    slopes = []
    for axis in range(3):
        lower = exponents - np.eye(3, dtype=int)[axis]
        slopes.append(exponents[:, axis] * np.prod(points[:, None, :] ** np.maximum(lower, 0), axis=2))
    return values, np.stack(slopes, axis=1)


def rank_dimension(partition, degree):
    """The dimension of C^1 splines: unknowns less the rank of equal values and gradients on common triangles."""
    points = 2 * (partition.points - partition.points.mean(axis=0))
    terms = (degree + 1) * (degree + 2) * (degree + 3) // 6
    rng = np.random.default_rng(7)
    rows = []
    for triangle, first, second in partition.inner_triangles:
        weights = rng.dirichlet(np.ones(3), (degree + 1) * (degree + 2) // 2)
        values, slopes = powers(weights @ points[list(triangle)], degree)
        block = np.concatenate([values, *np.swapaxes(slopes, 0, 1)])
        row = np.zeros((len(block), len(partition.cells) * terms))
        row[:, first * terms : (first + 1) * terms] = block
        row[:, second * terms : (second + 1) * terms] = -block
        rows.append(row)
    found = np.linalg.svd(np.concatenate(rows), compute_uv=False)
    assert not ((found > 1e-2 * SMALL * found[0]) & (found < 1e2 * SMALL * found[0])).any(), "a clear gap"
    return len(partition.cells) * terms - int((found > SMALL * found[0]).sum())


@pytest.mark.parametrize(("name", "degree", "dimension"), PUBLISHED)
def test_dimensions_are_the_published_ones(name, degree, dimension):
    partition = SPLITS[name]()
    assert pas.solutions([], 1, degree, partition).dimension == dimension
    assert rank_dimension(partition, degree) == dimension


@pytest.mark.parametrize("name", SPLITS)
def test_dimensions_do_not_depend_on_the_shape(name):
    """Of any tetrahedron, any centre, any box: these splits have the same dimensions."""
    if name == "kuhn cube":
        other = pas.KuhnCube((0, 1, "-1/2"), (3, "4/3", 5))
    else:
        other = SPLITS[name]([(0, 0, 0), (3, 1, 0), (-1, 2, "1/3"), (1, 1, 4)], ("2/3", "4/5", 1))
    assert other.center is not None
    assert pas.solutions([], 1, 3, other).dimension == pas.solutions([], 1, 3, SPLITS[name]()).dimension


@pytest.mark.parametrize("name", SPLITS)
def test_splits_are_partitions_with_records(name):
    partition = SPLITS[name]()
    assert len(partition.cells) == CELLS[name]
    p = partition.points[np.array(partition.cells)]
    whole = 1 if name == "kuhn cube" else 1 / 6
    assert np.abs(np.linalg.det(p[:, 1:] - p[:, :1])).sum() / 6 == pytest.approx(whole)
    again = read_partition(partition.to_record())
    assert type(again) is type(partition)
    assert (again.vertices, again.cells) == (partition.vertices, partition.cells)


def test_formulas_and_counts_agree_and_the_page_has_them():
    bench = runpy.run_path(str(ROOT / "docs/dimensions.py"))
    page = (ROOT / "docs/dimensions.md").read_text(encoding="utf-8")
    splits, fan = bench["BENCHES"][: len(SPLITS)], bench["BENCHES"][len(SPLITS)]
    for degree, dimension in ((1, 4), (2, 13), (3, 34), (4, 73)):
        assert fan.formula(1, degree) == fan.partition().dimensions([], 1, degree)[degree] == dimension
        assert f"| 1 | {degree} | {dimension} | {dimension} |" in page.split("## Fan")[1]
    for item, name in zip(splits, SPLITS, strict=True):
        assert item.partition is SPLITS[name]
        for split, degree, dimension in PUBLISHED:
            if split == name:
                assert item.formula(1, degree) == dimension
                assert f"| 1 | {degree} | {dimension} | {dimension} |" in page
    wrong = bench["Bench"]("Wrong", pas.AlfeldSplit, lambda r, n: 5, (1,), "5")
    with pytest.raises(ValueError, match="4 counted for r = 1, n = 1, where 5 are published"):
        bench["table"](wrong)


STARS = {"octahedral split": 2, "star of eight": 1, "worsey-piper split": 2, "twenty-four pieces": 1}
"""How many tables there are of each, in special positions or not."""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("title", STARS)
def test_stars_of_eight_and_of_24_have_the_dimensions_of_the_formulas(title):
    """For r = 0 and 1, counted here again."""
    page = (ROOT / "docs/dimensions.md").read_text(encoding="utf-8")
    script = runpy.run_path(str(ROOT / "docs/dimensions.py"))
    found = [bench for bench in script["BENCHES"] if bench.title.lower().startswith(title)]
    assert len(found) == STARS[title]
    for bench in found:
        section = page.split(f"## {bench.title}\n")[1].split("## ")[0]
        partition = bench.partition()
        for r in set(bench.orders) & {0, 1}:
            for n in list(bench.degrees(r))[:2]:
                counted = script["count_of"](partition, r, n, bench.homogeneous)
                assert counted == bench.formula(r, n)
                assert f"| {r} | {n} | {counted} | {counted} |" in section


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pas.AlfeldSplit([(0, 0, 0)]), ValueError, "corners must be four points"),
        (
            lambda: pas.AlfeldSplit(center=(1, 1, 1)),
            pas.GeometryError,
            "centre of a split must lie inside its tetrahedron",
        ),
        (
            lambda: pas.AlfeldSplit([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]),
            pas.GeometryError,
            "four corners of the tetrahedron lie in one plane",
        ),
        (lambda: pas.WorseyFarinSplit("corners"), ValueError, "corners must be four points"),
        (lambda: pas.WorseyFarinSplit(center=(0, 0, "1/4")), pas.GeometryError, "must lie inside its tetrahedron"),
        (lambda: pas.KuhnCube((0, 0, 0), (1, 0, 1)), ValueError, "each lower bound of a box must be below the upper"),
        (lambda: pas.solutions([], 1, 3, pas.SingleCell((0, 0, 0), (1, 1, 1))), ValueError, "at least one contact"),
    ],
)
def test_wrong_splits_get_a_sentence(make, error, words):
    with pytest.raises(error, match=words):
        make()
