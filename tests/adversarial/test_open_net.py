"""Open regions whose truth is known: nothing false is proved by either checker, and what holds is refuted by none.

Bases are blends out of openings that are proved.  A break changes contacts, order or patches; what it makes false is
known by construction, and whether a cone is inside the region and holds a pipe's circle is found by exact signs.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from random import Random

import numpy as np
import pytest

import pas
from pas import Contact, PiecewiseSurface, Polynomial
from pas.independent.checker import check_independently

X, Z = (1, 0, 0), (0, 0, 1)

BASES = {
    "foot": ([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 1),
    "smooth foot": ([pas.Plate(Z, 2), pas.Pipe(Z, 1, 2)], 2),
    "leaning foot": ([pas.Plate(Z, 2), pas.Pipe(("1/4", 0, 1), "3/4", 3)], 1),
    "nozzle": ([pas.Opening("x^2 + y^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1),
    "boss": ([pas.Opening("x^2 + y^2 + z^2 - 4", X, "4/7"), pas.Pipe(X, "1/2", 3)], 1),
}


@cache
def base(name):
    """A blend, and its surface's opening and pipe."""
    contacts, order = BASES[name]
    blend = pas.blend(contacts, order)
    assert blend.certificate.proved
    return blend, *blend.surface.contacts


def opening_alone(surface, opening, pipe, draw):
    return [pipe], surface.order, surface.polynomials, {"enclosed"}


def pipe_alone(surface, opening, pipe, draw):
    """The pipe's clip face is then a wall, and the inside reaches it."""
    return [opening], surface.order, surface.polynomials, {"enclosed"}


def two_openings(surface, opening, pipe, draw):
    second = Contact(surface.polynomials[0], scaled(surface, opening.clip, Fraction(draw.randint(60, 130), 100)))
    return [opening, second, pipe], surface.order, surface.polynomials, {"contact 1", "contact 2", "enclosed"}


def another_cone(surface, opening, pipe, draw):
    """Of the surface itself, which is met exactly: it must be inside the region, and hold the pipe's circle."""
    other = Contact(surface.polynomials[0], scaled(surface, opening.clip, Fraction(draw.randint(5, 160), 100)))
    wrong = set() if fits(surface, other.clip, pipe) else {"contact 1", "enclosed"}
    return [other, pipe], surface.order, surface.polynomials, wrong


def moved_apex(surface, opening, pipe, draw):
    step = Fraction(draw.choice((-1, 1)), draw.choice((10, 1000, 10**9)))
    moved = Polynomial(str(opening.clip).replace("z", f"(z + {step})").replace("x", f"(x + {step})"))
    return [Contact(opening.surface, moved), pipe], surface.order, surface.polynomials, {"contact 1", "enclosed"}


def inside_out(surface, opening, pipe, draw):
    turned = [-p for p in surface.polynomials]
    return [opening, pipe], surface.order, turned, {"contact 1", "contact 2", "one sheet", "enclosed"}


def opening_missed(surface, opening, pipe, draw):
    """Only the pipe is met."""
    step = Fraction(draw.choice((-1, 1)), 10 ** draw.randint(3, 12))
    changed = [p + pipe.surface * pipe.clip ** (surface.order + 1) * step for p in surface.polynomials]
    return [opening, pipe], surface.order, changed, {"contact 1", "enclosed"}


def pipe_missed(surface, opening, pipe, draw):
    """Only the opening is met."""
    step = Fraction(draw.choice((-1, 1)), 10 ** draw.randint(3, 12))
    changed = [p + opening.surface * opening.clip ** (surface.order + 1) * step for p in surface.polynomials]
    return [opening, pipe], surface.order, changed, {"contact 2"}


def higher_order(surface, opening, pipe, draw):
    return [opening, pipe], surface.order + 1, surface.polynomials, {"contact 1", "contact 2"}


def turned_cone(surface, opening, pipe, draw):
    return (
        [Contact(opening.surface, -opening.clip), pipe],
        surface.order,
        surface.polynomials,
        {"contact 1", "enclosed"},
    )


def nothing(surface, opening, pipe, draw):
    return [opening, pipe], surface.order, surface.polynomials, set()


BREAKS = {
    f.__name__: f
    for f in (
        opening_alone, pipe_alone, two_openings, another_cone, moved_apex, inside_out, opening_missed, pipe_missed,
        higher_order, turned_cone, nothing,
    )
}  # fmt: skip


def scaled(surface, cone, factor):
    """A cone around the region's centre so many times as wide: its axis keeps its length."""
    center = [Fraction(str(c)) for c in surface.partition.center]
    mean = np.array(surface.partition.points.mean(axis=0) - np.array([float(c) for c in center]))
    axis = int(np.abs(mean).argmax())
    names = "xyz"
    text = str(cone)
    for number, name in enumerate(names):
        if number != axis:
            text = text.replace(name, f"({center[number]} + ({name.upper()} - {center[number]})/({factor}))")
    return Polynomial(text.replace("X", "x").replace("Y", "y").replace("Z", "z"))


def fits(surface, cone, pipe):
    """Whether a cone is positive on the far edges of the region's sides and negative on the pipe's circle, by samples
    fine enough for the factors drawn."""
    partition = surface.partition
    shares = np.linspace(0, 1, 200)[:, None]
    for side in partition.local.sides:
        ends = [partition.points[v] for v in side.vertices if partition.vertices[v] != partition.center]
        if cone((1 - shares) * ends[0] + shares * ends[1]).min() <= 0:
            return False
    return bool(cone(pipe.rim.points(400)).max() < 0)


def flaws(name, kind, number, folder):
    """What either checker says falsely of one case."""
    draw = Random(f"{name} {kind} {number}")
    blend, opening, pipe = base(name)
    contacts, order, polynomials, wrong = BREAKS[kind](blend.surface, opening, pipe, draw)
    surface = PiecewiseSurface.from_polynomials(blend.surface.partition, contacts, order, polynomials)
    certificate = surface.certificate
    pas.save(replace(blend, surface=surface), folder / "case.pas.json")
    second = {f.claim.split(" GC")[0]: f.status for f in check_independently(folder / "case.pas.json")}
    first = {v.claim.split(" GC")[0]: v.status.value for v in certificate.verdicts}
    for claim, status in first.items():
        case = f"{name}, {kind} {number}: {claim}"
        if claim in wrong and "proved" in (status, second[claim]):
            yield f"{case} is false, and {status}, {second[claim]}"
        if claim not in wrong and not wrong and "refuted" in (status, second[claim]):
            yield f"{case} holds, and {status}, {second[claim]}"
        if {status, second[claim]} == {"proved", "refuted"}:
            yield f"{case}: the checkers contradict one another"


@pytest.mark.parametrize("kind", BREAKS)
@pytest.mark.parametrize("name", ["foot", "nozzle"])
def test_no_false_verdict(name, kind, tmp_path):
    assert [flaw for number in range(2) for flaw in flaws(name, kind, number, tmp_path)] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", BREAKS)
@pytest.mark.parametrize("name", BASES)
def test_no_false_verdict_of_many(name, kind, tmp_path):
    assert [flaw for number in range(2, 22) for flaw in flaws(name, kind, number, tmp_path)] == []


def test_honest_ones_are_proved(tmp_path):
    for name in ("foot", "nozzle"):
        assert list(flaws(name, "nothing", 0, tmp_path)) == [] and base(name)[0].certificate.proved
