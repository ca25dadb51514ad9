"""Problems and solved blends that several tests share."""

from __future__ import annotations

import ast
import gc
import json
import os
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

import pas
from pas.pipeline.feet import Tee

SHARED = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""Of generated cases: no test fails because another program took the processor."""
settings.register_profile("other cases each time", SHARED)
MANY = 100 if "PAS_ALL_CASES" in os.environ else 40
"""Generated cases of a test; without the slow tests fewer, but for mutants."""
settings.register_profile("same cases each time", SHARED, derandomize=True, max_examples=MANY)


def pytest_configure(config: pytest.Config) -> None:
    """What is right today must not fail tomorrow by the luck of a draw: the slow tests alone draw new cases."""
    settings.load_profile(f"{'same' if config.option.markexpr == 'not slow' else 'other'} cases each time")
    gc.disable()  # until all is imported and collected, which stays


def pytest_collection_finish() -> None:
    """What is imported and collected is never garbage: looking through it takes a third of the time until here.

    Nor is most of what tests keep for one another, which is looked through a tenth as often as usually.
    """
    gc.freeze()
    gc.set_threshold(10 * gc.get_threshold()[0])
    gc.enable()


@pytest.hookimpl(tryfirst=True)  # before those that are slow are left out
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of a sampled test one case in so many is run always, of the adversarial nets the first; the others are slow.

    Where `PAS_ALL_CASES` is set, as by the runner of mutants, all are run: a rule is mostly met by one case alone.
    """
    met: Counter[str] = Counter()
    for item in items if "PAS_ALL_CASES" not in os.environ else ():
        sampled = item.get_closest_marker("sampled")
        net = item.path.parent.name == "adversarial"
        if (sampled or net) and item.get_closest_marker("slow") is None:
            name = item.nodeid.partition("[")[0]
            if met[name] % sampled.args[0] if sampled else met[name]:
                item.add_marker(pytest.mark.slow)
            met[name] += 1


DATA = Path(__file__).parent / "data"
ROOT = Path(__file__).parent.parent
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
EQUAL = ("1/3", "1/3", "1/3")
UNEQUAL = ("1/3", "1/4", "2/5")
ELBOW = ("1/3", "1/3")


@cache
def parsed(path: Path) -> ast.Module:
    """The syntax tree of a source file, made once for all tests."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """All nodes of that tree."""
    return tuple(ast.walk(parsed(path)))


def pipes(radii: tuple[Any, ...] = UNEQUAL, clips: tuple[Any, ...] = (1, 1, 1)) -> list[pas.Pipe]:
    """Three pipes along the axes."""
    return [pas.Pipe(axis=a, radius=r, clip=h) for a, r, h in zip(AXES, radii, clips, strict=True)]


def corner(radii: tuple[str, ...]) -> list[pas.Pipe]:
    """Pipes along the first axes, as many as there are radii."""
    return [pas.Pipe(axis=a, radius=r, clip=1) for a, r in zip(AXES, radii, strict=False)]


@cache
def solved(radii: tuple[str, ...], order: int, degree: int | None = None) -> pas.Blend:
    """A blend of unit corners by the thin plate, as published, solved once for all tests."""
    return pas.blend(pipes(radii), order, degree, energy=pas.ThinPlate())


@cache
def fair(radii: tuple[str, ...], order: int) -> pas.Blend:
    """A blend of a unit corner, or of an elbow for two radii, as users get it, solved once for all tests."""
    return pas.blend(corner(radii), order)


X, Z = (1, 0, 0), (0, 0, 1)
BENT = [
    pas.Torus(Z, (2, 0, 0), "1/2", (-2, 2, 0)),
    pas.Cone((1, -1, 0), "1/2", 2, slope="1/8"),
    pas.Cone((-1, -1, 0), "1/2", 2, slope="-1/8"),
]
SOLVED = {
    "bent": lambda: pas.blend(BENT, 1),
    "hollow_elbow": lambda: pas.node([(X, 1), ((0, 1, 0), 1)], 1).hollow("1/10"),
    "hollow_nozzle": lambda: pas.blend([pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1).hollow(
        "1/8"
    ),
    "hollow_run": lambda: pas.blend(Tee.of(pas.Pipe(Z, 1, "auto"), pas.Pipe(X, "1/2", "auto")).contacts, 1).hollow(
        "1/8"
    ),
    "hollow_foot": lambda: pas.blend([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 1).hollow("1/8"),
    "tee": lambda: pas.node([(X, 1), ((-1, 0, 0), 1), ((0, 1, 0), "4/5")], 1),
    "thick_elbow": lambda: pas.node([(X, 1), ((0, 1, 0), 1)], 1).hollow("3/8"),
}
"""Blends of which tests want what comes after the solving: they are read from `tests/data/solved`, where
`SOLVED[name]().save(path)` has put them; what is proved of them is proved anew."""


def read(name: str) -> Any:
    """One of these, from its file."""
    return pas.load(DATA / "solved" / f"{name}.pas.json")


@pytest.fixture(scope="session")
def facts() -> dict[str, Any]:
    """The verified numbers of the published corner."""
    return json.loads((DATA / "corner.json").read_text())
