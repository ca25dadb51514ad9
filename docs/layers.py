"""Draws the layers of the package and who imports from whom, read from the sources, as `docs/layers.svg`.

    python docs/layers.py

Layers stand in the order in which they may import: each from those above it.  The width of an arc says how many
modules of the lower layer import from the upper one; layers that most of those below import from are marked instead.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "pas"

ROW, LEFT, TOP, BOX, WIDTH = 34, 40, 30, 150, 560
"""Of the picture, in pixels."""

COMMON, FEW = 2 / 3, 8
"""Layers that this share of the layers below imports from have no arcs; there must be so many below."""

COLORS = ("#5b8db8", "#7fae7a", "#b07aa1", "#9c755f", "#76b7b2", "#c95d63", "#e8a33d", "#6b7a8f")


def layer_of(path: Path) -> str:
    """The layer that a module belongs to: its folder in the package, or its own name."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path: Path) -> set[str]:
    """The layers that a module imports from."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("pas."):
            found.add(node.module.split(".")[1])
        elif isinstance(node, ast.Import):
            found |= {alias.name.split(".")[1] for alias in node.names if alias.name.startswith("pas.")}
    return found - {layer_of(path), "_version"}


def edges() -> tuple[Counter[tuple[str, str]], Counter[str]]:
    """How many modules of a layer import from another, by (importing, imported), and the lines of each layer."""
    used: Counter[tuple[str, str]] = Counter()
    lines: Counter[str] = Counter()
    for path in sorted(PACKAGE.rglob("*.py")):
        if path.parent == PACKAGE and path.name in ("__init__.py", "__main__.py", "_version.py"):
            continue
        layer = layer_of(path)
        lines[layer] += len(path.read_text(encoding="utf-8").splitlines())
        used.update((layer, other) for other in imports(path))
    return used, lines


def order(layers: list[str], used: Counter[tuple[str, str]]) -> list[str]:
    """The layers, each after those that it imports from; raises `ValueError` where they go round in a circle."""
    placed: list[str] = []
    while len(placed) < len(layers):
        ready = [r for r in layers if r not in placed and all(b in placed for a, b in used if a == r)]
        if not ready:
            raise ValueError(f"the layers {', '.join(r for r in layers if r not in placed)} import from one another")
        placed.append(min(ready))
    return placed


def picture() -> str:
    """The picture as SVG."""
    used, lines = edges()
    layers = order(sorted(lines), used)
    height = TOP * 2 + ROW * len(layers)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" font-family="sans-serif">',
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
    ]
    middle = {layer: TOP + ROW * place + ROW / 2 for place, layer in enumerate(layers)}
    common = {
        layer
        for place, layer in enumerate(layers[:-FEW])
        if sum((below, layer) in used for below in layers[place + 1 :]) >= COMMON * len(layers[place + 1 :])
    }
    for (layer, other), times in sorted(used.items()):
        if other in common:
            continue
        low, high, x = middle[layer], middle[other], LEFT + BOX
        reach = x + 18 + 21 * abs(layers.index(layer) - layers.index(other))
        color = COLORS[layers.index(other) % len(COLORS)]
        parts.append(
            f'<path d="M {x} {low} C {reach} {low}, {reach} {high}, {x + 6} {high}" fill="none" stroke="{color}" '
            f'stroke-width="{0.6 + 0.45 * times**0.5:.2f}" opacity="0.75"/>'
        )
    for layer in layers:
        y, color = middle[layer], COLORS[layers.index(layer) % len(COLORS)]
        parts.append(f'<rect x="{LEFT}" y="{y - 12}" width="{BOX}" height="24" rx="5" fill="{color}" opacity="0.25"/>')
        parts.append(f'<text x="{LEFT + 10}" y="{y + 5}" fill="#22303c" font-size="13">{layer}</text>')
        right = f'x="{LEFT + BOX - 8}" y="{y + 5}" text-anchor="end"'
        parts.append(f'<text {right} fill="#66727f" font-size="10">{lines[layer]}</text>')
        if layer in common:
            parts.append(
                f'<text x="{LEFT + BOX + 10}" y="{y + 4}" fill="#66727f" font-size="11">most layers below</text>'
            )
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "layers.svg"
    target.write_text(picture())
