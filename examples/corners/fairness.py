"""What the choice by the surface's curvature changes: thin plate before, curvature variation after.

    python examples/corners/fairness.py [-o DIR]

Draws each case from two sides, before and after, in one sheet, and prints the measures as the table of the README;
then compares the inner section of the elbow with the circular arc and with the curve of least variation of curvature.
"""

from __future__ import annotations

import argparse
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image
from scipy.integrate import trapezoid
from scipy.optimize import minimize

import pas

HERE = Path(__file__).parent
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
CASES: dict[str, tuple[tuple[str, ...], tuple[str, ...], int]] = {
    "unequal GC^1": (("1/3", "1/4", "2/5"), ("1", "1", "1"), 1),
    "unequal GC^2": (("1/3", "1/4", "2/5"), ("1", "1", "1"), 2),
    "equal GC^2": (("1/3", "1/3", "1/3"), ("1", "1", "1"), 2),
    "long and short GC^2": (("1/5", "3/10", "1/4"), ("2", "3/5", "1"), 2),
    "elbow GC^2": (("1/3", "1/3"), ("1", "1"), 2),
}
"""Radii, clip distances and order."""

BACK = (-1.0, -1.2, -0.8)
SIZE = (360, 300)
ARC = 2 / 3
"""The radius of the largest arc between the elbow's inner walls: clip distance less radius."""

MODES = 6
"""Sines of which the curvature of the plane curve is made."""


def blends(name: str) -> tuple[pas.Blend, pas.Blend]:
    """A case as the thin plate leaves it at the lowest degree, and as it is chosen now."""
    radii, clips, order = CASES[name]
    pipes = [pas.Pipe(axis, r, c) for axis, r, c in zip(AXES, radii, clips, strict=False)]
    return pas.blend(pipes, order, energy=pas.ThinPlate()), pas.blend(pipes, order)


def pictures(blend: pas.Blend, folder: Path) -> list[Image.Image]:
    """From the front and from behind."""
    mesh = blend.mesh(2e-3)
    for name, view in (("front", None), ("back", BACK)):
        pas.draw(blend, folder / f"{name}.png", mesh=mesh, view=view, size=SIZE)
    return [Image.open(folder / f"{name}.png").convert("RGB") for name in ("front", "back")]


def sheet(rows: list[list[Image.Image]]) -> Image.Image:
    """Pictures side by side."""
    whole = Image.new("RGB", (SIZE[0] * len(rows[0]), SIZE[1] * len(rows)), "white")
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            whole.paste(picture, (j * SIZE[0], i * SIZE[1]))
    return whole


def measures(blend: pas.Blend) -> str:
    """Degree and fairness as cells of a table."""
    f = blend.surface.fairness()
    return (
        f"{blend.surface.degree} | {f.sharpness:.2f} | {f.hollowness:.2f} | {f.bulge:.2f} | {f.wrong_sign:.2f} | "
        f"{f.variation:.1f}"
    )


def inner_section(blend: pas.Blend) -> Any:
    """Curvatures (N,) along the elbow's inner section in the plane of its axes, times the radius of the largest arc."""
    surface = blend.surface
    angles = np.linspace(0, np.pi / 2, 721)[1:-1]
    directions = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    center = np.array([float(Fraction(str(c))) for c in surface.partition.center])
    distances = surface.intersect_rays(center, directions)
    met = np.isfinite(distances)
    points = center + directions[met] * distances[met, None]
    slope, hessian = surface.gradient(points)[:, :2], surface.hessian(points)[:, :2, :2]
    length = np.linalg.norm(slope, axis=1)
    tangent = np.stack([-slope[:, 1], slope[:, 0]], axis=1) / length[:, None]
    curvature = np.einsum("ni,nij,nj->n", tangent, hessian, tangent) / length
    return curvature * ARC


def least_variation() -> float:
    """The largest curvature of the curve of least `integral of (dk/ds)^2` between the walls that has none at its ends.

    The walls are lines at a right angle, the ends at distance 1 from where these meet; k(s) is a sum of sines.
    """
    modes = np.arange(1, 2 * MODES, 2)
    share = np.linspace(0, 1, 2001)

    def bent(unknowns: Any) -> Any:
        return unknowns[1:] @ np.sin(np.pi * modes[:, None] * share)

    def missed(unknowns: Any) -> Any:
        length = unknowns[0]
        angle = length / np.pi * (unknowns[1:] / modes) @ (1 - np.cos(np.pi * modes[:, None] * share))
        x = length * trapezoid(np.cos(angle), share)
        return np.array([angle[-1] - np.pi / 2, x - 1])

    def variation(unknowns: Any) -> float:
        return float((unknowns[1:] * modes) @ (unknowns[1:] * modes) / unknowns[0])

    start = np.concatenate([[1.6, 1.5], np.zeros(MODES - 1)])
    found = minimize(variation, start, constraints={"type": "eq", "fun": missed})
    assert found.success and np.abs(missed(found.x)).max() < 1e-6
    return float(bent(found.x).max())


def main() -> None:
    """Draw and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=HERE / "pictures")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    print("| case | chosen by | degree | sharpness | hollowness | bulge | wrong sign | variation |")
    print("|---|---|---|---|---|---|---|---|")
    with TemporaryDirectory() as place:
        for name in CASES:
            before, after = blends(name)
            print(
                f"| {name} | thin plate | {measures(before)} |\n| | curvature variation | {measures(after)} |",
                flush=True,
            )
            rows.append([*pictures(before, Path(place)), *pictures(after, Path(place))])
            if name == "elbow GC^2":
                k = -inner_section(after)
                print(f"\ninner section of the elbow: largest curvature {k.max():.2f} of the largest arc's")
                print(f"of the plane curve of least variation, GC^2 as well: {least_variation():.2f}; of the arc: 1")
    sheet(rows).save(folder / "before_and_after.png")


if __name__ == "__main__":
    main()
