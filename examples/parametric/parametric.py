"""All parametric blends of this folder: found, proved or refuted, meshed, converted and drawn.

    python examples/parametric/parametric.py [-o DIR]

reads every problem file beside it, writes a picture with isophotes for each into DIR (default: the folder `pictures`
beside it) and prints a table: the degrees of the blend in t and h, whether the contacts and the regularity are proved,
the number of triangles within a thousandth of the extent, and that of exact Bezier patches.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pas

HERE = Path(__file__).parent
PROBLEMS = sorted(HERE.glob("*.toml"))
SIZE = (480, 360)


def solve(path: Path) -> pas.ParametricBlend:
    """The blend of one problem file, on its domain."""
    problem = pas.read_parametric_problem(path)
    blend = problem.blend()
    return pas.ParametricBlend(blend.data, blend.order, blend.surface.with_domain(problem.domain), blend.weights)


def patches(blend: pas.ParametricBlend) -> tuple[pas.RationalPatch, ...]:
    """The blend as exact Bezier patches, or as one B-spline where it is not exact."""
    return pas.bezier_patches(blend.surface) if blend.surface.is_exact else (pas.fit_patch(blend.surface),)


def row(path: Path) -> str:
    """One row of the table."""
    blend = solve(path)
    certificate = blend.prove()
    surface, mesh = blend.surface, blend.mesh()
    degrees = "{} x {}".format(*surface.degrees) if surface.is_exact else "-"
    contacts = {verdict.status.value for verdict in certificate.contacts}
    return (
        f"{path.stem:<18} order {blend.order}  degrees {degrees:>7}  contacts {', '.join(sorted(contacts)):<10} "
        f"regular {certificate.regular.status.value:<10} {len(mesh.triangles):>6} triangles  "
        f"{len(patches(blend)):>2} patches"
    )


def main() -> None:
    """Print the table and draw the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=HERE / "pictures")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    for path in PROBLEMS:
        print(row(path), flush=True)
        problem = pas.read_parametric_problem(path)
        picture = folder / f"{path.stem}.png"
        pas.draw(solve(path), picture, style=problem.picture.style, view=problem.picture.view, size=SIZE)


if __name__ == "__main__":
    main()
