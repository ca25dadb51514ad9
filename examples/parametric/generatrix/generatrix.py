"""All blends by a Bezier generatrix of this folder, and one through a sphere: made, judged, meshed and drawn.

    python examples/parametric/generatrix/generatrix.py [-o DIR]

reads every problem file beside it, writes a picture with isophotes for each into DIR (default: the folder `pictures`
beside it) and prints a table: the verdicts of the certificate, and the number of triangles of a mesh.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pas

HERE = Path(__file__).parent
PROBLEMS = sorted(HERE.glob("*.toml"))
SIZE = (480, 360)


def solve(name: str) -> pas.GeneratrixBlend:
    """The blend of one problem file."""
    return pas.read_parametric_problem(HERE / f"{name}.toml").blend()


def ball() -> pas.ParametricSurface:
    """What the blend of `obstacle` avoids."""
    return pas.ellipsoid("3/2", "3/2", "3/2", angle=True)


def three_pipes() -> pas.SphereBlend:
    """Two pipes and a cone that run into one another through a ball."""
    ends = [
        pas.plane_section("y^2 + z^2 - 1/4", "x - 3"),
        pas.plane_section("x^2 + z^2 - 1/2", "y + 3"),
        pas.plane_section("x^2 + y^2 - z^2/9", "z - 3"),
    ]
    return pas.blend_through_sphere(ends, (0, 0, 0), 1)


def row(name: str) -> str:
    """One row of the table."""
    blend = solve(name)
    found = blend.certificate
    verdicts = zip(("G1", "G1", "sense", "regular", "simple"), found.verdicts, strict=True)
    words = "  ".join(f"{word} {verdict.status.value}" for word, verdict in verdicts)
    return f"{name:<20} {words}  {len(blend.surface.mesh().triangles):>6} triangles"


def main() -> None:
    """Print the table and draw the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=HERE / "pictures")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    for path in PROBLEMS:
        print(row(path.stem), flush=True)
        problem = pas.read_parametric_problem(path)
        drawn = [problem.blend(), ball()] if path.stem == "obstacle" else problem.blend()
        pas.draw(drawn, folder / f"{path.stem}.png", style=problem.picture.style, view=problem.picture.view, size=SIZE)
    joined = three_pipes().require()
    print(f"{'three_pipes':<20} {len(joined.mesh().triangles)} triangles, welded")
    pas.draw(joined, folder / "three_pipes.png", style=pas.Style.ZEBRA, size=SIZE)


if __name__ == "__main__":
    main()
