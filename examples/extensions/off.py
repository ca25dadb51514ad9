"""A file format of your own: OFF, the Object File Format of Geomview, for everything that has a mesh.

    python examples/extensions/off.py ball.off

A format is a suffix, what its files hold and a function that writes that.  Here the files hold triangles, so the
function is given parts, each with a name, a colour (red, green, blue up to 255) and a `Mesh`.  It writes to a path that
becomes the file only if nothing was raised.  From the line `FORMATS.register` on, `pas.write` and all that writes
triangles take the suffix.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import pas
from pas.exchange.formats import FORMATS, Format, Request
from pas.exchange.parts import TRIANGLES, Piece, joined, repeated_colors


def write_off(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts put together, each triangle in its part's colour."""
    points, triangles = joined(parts)
    lines = ["OFF", f"# unit: {request.told_unit}", f"{len(points)} {len(triangles)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    colors = repeated_colors(parts, [len(p.mesh.triangles) for p in parts])
    rows = zip(triangles.tolist(), colors.tolist(), strict=True)
    lines += [f"3 {a} {b} {c} {red} {green} {blue}" for (a, b, c), (red, green, blue) in rows]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


FORMATS.register(Format(".off", TRIANGLES, write_off))


if __name__ == "__main__":
    ball = pas.solid.ball((0, 0, 0), 1) - pas.solid.cylinder((0, 0, -2), (0, 0, 2), "1/2")
    print(pas.write(ball, sys.argv[1], tolerance=0.02))
