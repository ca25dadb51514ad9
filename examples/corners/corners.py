"""All corners of this folder: blended, proved or refuted, and drawn.

    python examples/corners/corners.py [-o DIR]

reads every problem file beside it, writes a picture with isophotes for each into DIR (default:
the folder `pictures` beside it) and prints a table of the verdicts.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pas

HERE = Path(__file__).parent
STYLES = {
    "published": {"": pas.Style.PLAIN},
    "three": {"": pas.Style.PLAIN, "_zebra": pas.Style.ZEBRA},
}
"""Pictures other than stripes, by the first word of a file's name."""

BODY = "three_pipes"
"""The corner that is also drawn as a solid, with its pipes."""

PROBLEMS = sorted(HERE.glob("*.toml"))


def solve(path: Path) -> pas.Blend:
    """The blend of one problem file."""
    problem = pas.read_problem(path)
    return pas.blend(problem.contacts, problem.order, problem.degree, **problem.options)


def verdicts(certificate: pas.Certificate) -> str:
    """What is not proved, in short."""
    failed = [f"{v.claim} {v.status.value}" for v in certificate.verdicts if not v.proved]
    return "all proved" if not failed else ", ".join(failed)


def main() -> None:
    """Solve and draw them all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=HERE / "pictures")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    for path in PROBLEMS:
        blend = solve(path)
        print(
            f"{path.stem:<18} GC^{blend.surface.order} degree {blend.surface.degree} "
            f"dimension {blend.dimension:>2} energy {blend.energy:>8.2f}  {verdicts(blend.certificate)}"
        )
        for suffix, style in STYLES.get(path.stem.split("_")[0], {"": pas.Style.ZEBRA}).items():
            pas.draw(blend.surface, folder / f"{path.stem}{suffix}.png", style=style, size=(480, 360))
        if path.stem == BODY:
            pas.draw(blend.surface, folder / f"{BODY}_gauss.png", style="gauss", combs=True, size=(480, 360))
            pas.draw(blend.solid("1/2"), folder / f"{BODY}_body.png", size=(480, 360))


if __name__ == "__main__":
    main()
