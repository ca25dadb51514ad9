"""Meshes of blends and boxes beside flying edges and marching cubes on a grid, to the same largest error.

    OPENBLAS_NUM_THREADS=1 python benchmarks/meshes.py [NAMES] [--tolerances 1e-2 1e-3 1e-4] [--repeat 3]

The error is the largest |f| / |grad f| over vertices, middles of edges and centres of triangles; tolerances are over
the longest side of the region's box.  The peers (Lorensen and Cline 1987; Schroeder, Maynard and Geveci 2015; both of
VTK) get the coarsest grid that is as near, found by trying, and are cropped to the region; their time is that of the
grid's values, by the same evaluator as ours, and of the contour, of which `alone` is that of the contour.  Milliseconds
of one processor, the best of the runs; `angle` is that of 1% of the triangles and the smallest, in degrees; `proof` is
the time of the mesh's certificate, what it says of the topology, and the largest distance proved over the tolerance.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pyvista

import pas
from pas.mesh.quality import smallest_angles
from pas.surface.radial_field import RadialField

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
FINEST_GRID = 400

BOXES = {
    "torus": ("(x^2 + y^2 + z^2 + 8/9)^2 - 4*(x^2 + y^2)", 2),
    "tangle": ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 59/5", 3),
    "quadric through walls": ("x^2 + 2*y^2 - z^2 - 1/4 + x/7", 1),
    "saddle through walls": ("x*y - z/3", 1),
    "Chmutov 6": (
        "32*(x^6 + y^6 + z^6) - 48*(x^4 + y^4 + z^4) + 18*(x^2 + y^2 + z^2) - 3 + 1/4",
        "6/5",
    ),
}
"""Polynomials and half the edge of a cube around 0."""


def corner(order: int, *radii: str) -> pas.PiecewiseSurface:
    """A corner of three pipes."""
    return pas.blend([pas.Pipe(a, r, 1) for a, r in zip(AXES, radii, strict=True)], order).surface


CASES: dict[str, Callable[[], pas.PiecewiseSurface]] = {
    "corner GC^1": lambda: corner(1, "1/3", "1/3", "1/3"),
    "corner GC^2": lambda: corner(2, "1/3", "1/3", "1/3"),
    "corner GC^3": lambda: corner(3, "1/3", "1/3", "1/3"),
    "thin corner GC^1": lambda: corner(1, "1/25", "1/10", "1/20"),
    "T GC^2": lambda: pas.blend(pas.struts([((1, 0, 0), 1), ((-1, 0, 0), 1), ((0, 1, 0), 1)], 2), 2).surface,
    **{n: lambda t=t, a=a: pas.Polynomial(t).surface([f"-{a}"] * 3, [a] * 3) for n, (t, a) in BOXES.items()},
    "six-way node GC^1": lambda: pas.blend(pas.struts([(a, 1) for v in AXES for a in (v, back(v))], 1), 1).surface,
}


def back(axis: tuple[int, int, int]) -> tuple[int, int, int]:
    """The opposite direction."""
    return -axis[0], -axis[1], -axis[2]


def best(work: Callable[[], Any], repeat: int) -> tuple[float, Any]:
    """Milliseconds of one processor, and what the last run returned."""
    spent = []
    for _ in range(repeat):
        start = time.process_time()
        result = work()
        spent.append(time.process_time() - start)
    return 1000 * min(spent), result


def error(surface: pas.PiecewiseSurface, points: np.ndarray, triangles: np.ndarray) -> float:
    """The largest |f| / |grad f| over vertices, middles of edges and centres, where these are in the region."""
    corners = points[triangles]
    middles = [(corners[:, i] + corners[:, (i + 1) % 3]) / 2 for i in range(3)]
    jets = surface.jets(np.concatenate([points, corners.mean(axis=1), *middles]))
    return float(np.nanmax(np.abs(jets[:, 0]) / np.linalg.norm(jets[:, 1:], axis=1)))


class Grid:
    """Values of a surface on a grid of the region's box, and contours of them."""

    def __init__(self, surface: pas.PiecewiseSurface) -> None:
        self.surface = surface
        self.values_at = RadialField(surface).values if len(surface.patches) > 1 else self._of_one_piece
        ends = surface.local.points
        self.low, self.high = ends.min(axis=0), ends.max(axis=0)
        self.longest = float((self.high - self.low).max())

    def _of_one_piece(self, points: np.ndarray) -> np.ndarray:
        pieces = np.zeros(len(points), dtype=np.intp)
        return self.surface.evaluator.batch(0)(points, pieces)[:, 0]

    def values(self, number: int) -> pyvista.ImageData:
        """With so many points on the longest side."""
        step = self.longest / (number - 1)
        counts = np.ceil((self.high - self.low) / step - 1e-9).astype(int) + 1
        x, y, z = (low + step * np.arange(n) for low, n in zip(self.low, counts, strict=True))
        result = np.empty((counts[2], counts[1] * counts[0]))
        plane = np.stack(np.meshgrid(y, x, indexing="ij")[::-1], axis=-1).reshape(-1, 2)
        for k, height in enumerate(z):
            with np.errstate(divide="ignore"):  # the ray through the centre has no end
                result[k] = self.values_at(np.column_stack([plane, np.full(len(plane), height)]))
        image = pyvista.ImageData(dimensions=counts, spacing=(step,) * 3, origin=self.low)
        image["f"] = result.ravel()
        return image

    def contour(self, image: pyvista.ImageData, method: str) -> tuple[np.ndarray, np.ndarray]:
        """Points in the model's units and triangles in the region."""
        found = image.contour([0.0], scalars="f", method=method, compute_normals=False)
        points, triangles = np.asarray(found.points, dtype=float), found.regular_faces
        kept = (self.surface.local.locate(points) >= 0)[triangles].all(axis=1)
        return self.surface.partition.frame.global_points(points), triangles[kept]

    def as_near(self, aim: float) -> int:
        """The points on the longest side of the coarsest grid tried whose flying edges are as near as that."""
        number = 12
        while number < FINEST_GRID:
            points, triangles = self.contour(self.values(number), "flying_edges")
            reached = error(self.surface, points, triangles) if len(triangles) else np.inf
            if reached <= aim:
                break
            number = 1 + int(number * np.clip(np.sqrt(reached / aim), 1.05, 1.6))
        return number


def row(name: str, spent: float, points: np.ndarray, triangles: np.ndarray, reached: float, more: str = "") -> None:
    """Print one line."""
    angles = np.degrees(smallest_angles(points[triangles]))
    print(
        f"    {name:<16}{spent:>9.0f} ms{len(triangles):>9} triangles  error {reached:.2f}  "
        f"angle {np.percentile(angles, 1):5.1f} {angles.min():5.1f}{more}",
        flush=True,
    )


def compare(surface: pas.PiecewiseSurface, share: float, repeat: int) -> None:
    """The lines of one surface and one tolerance."""
    tolerance = share * float(np.ptp(surface.partition.points, axis=0).max())
    spent, mesh = best(lambda: surface.mesh(tolerance), repeat)
    aim = error(surface, mesh.points, mesh.triangles)
    proof, certificate = best(lambda: surface.certify_mesh(mesh.points, mesh.triangles), repeat)
    said = next((v.status.value for v in certificate.verdicts if "topology" in v.claim), "nothing")
    within = "?" if certificate.distance is None else f"{certificate.distance / tolerance:.2f}"
    more = f"  proof {proof:.0f} ms, {said}, within {within}"
    row("pas", spent, mesh.points, mesh.triangles, aim / tolerance, more)
    grid = Grid(surface)
    number = grid.as_near(aim)
    valued, image = best(lambda: grid.values(number), 1)
    for method in ("flying_edges", "marching_cubes"):
        alone, _ = best(lambda m=method: image.contour([0.0], scalars="f", method=m, compute_normals=False), repeat)  # type: ignore[misc]
        points, triangles = grid.contour(image, method)
        reached = error(surface, points, triangles) / tolerance
        row(method, valued + alone, points, triangles, reached, f"  alone {alone:.0f} ms, {number} points a side")


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="some of the cases, by name")
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-2, 1e-3, 1e-4])
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    for name in options.names or CASES:
        surface = CASES[name]()
        for tolerance in options.tolerances:
            print(f"{name}, degree {surface.degree}, tolerance {tolerance:g}")
            compare(surface, tolerance, options.repeat)


if __name__ == "__main__":
    main()
