"""Legends of pictures: what the colours and the hairs of combs stand for, in a strip that the shapes leave free."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pas.exchange.picture_options import Picture
from pas.render.combs import CONCAVE, CONVEX
from pas.render.scene import CURVE_COLOR, Layer, Legend

SIDE, FOOT = 0.2, 0.075
"""What legends take of a picture: of its width for a bar, of its height for the line below about combs."""

LEFT, BOTTOM, TALL, WIDE = 0.825, 0.2, 0.5, 0.06
"""Place and size of the bar of colours, over those of the picture."""

ABOVE, BELOW, LEADING = 0.04, 0.03, 0.03
"""Between the bar and the lines of text, and from line to line, over the picture's height."""

TITLE, LINE, LABEL = 24, 19, 18
"""Sizes of letters in a picture of the usual width, WIDTH."""

WIDTH = 1200

SMALLEST = 6
"""Of letters in small pictures."""


def room(legend: Legend | None, picture: Picture) -> tuple[float, float]:
    """What legends take of a picture's width, on the right, and height, below."""
    return (SIDE if legend else 0.0), (FOOT if picture.combs else 0.0)


def bar(legend: Legend, width: int) -> dict[str, Any]:
    """The keywords of the bar of colours in a picture of some width."""
    return {
        "position_x": LEFT, "position_y": BOTTOM, "height": TALL, "width": WIDE, "vertical": True, "fmt": "%.3g",
        "title": "", "color": CURVE_COLOR, "label_font_size": max(SMALLEST, round(LABEL * width / WIDTH)),
    }  # fmt: skip


def add_legend(plotter: Any, legend: Legend, width: int) -> None:
    """The lines of text above and below the bar."""
    _write(plotter, legend.title, (LEFT, BOTTOM + TALL + ABOVE), TITLE, width)
    _write(plotter, "\n".join(legend.lines), (LEFT, BOTTOM - BELOW - LEADING * len(legend.lines)), LINE, width)


def add_comb_legend(plotter: Any, layers: Sequence[Layer], width: int) -> None:
    """The line below a picture with combs: what the hairs are, and how long the longest one is."""
    sizes = [c for layer in layers for comb in layer.combs for c in abs(comb.curvatures).tolist()]
    units = {layer.unit for layer in layers if layer.combs}
    unit = units.pop() if len(units) == 1 else None
    longest = f"{max(sizes, default=0.0) / (unit or 1.0):.3g} {'of the thinnest neighbour' if unit else 'in 1/length'}"
    _write(plotter, f"hairs: normal curvature; the longest: {longest}", (0.02, 0.022), LINE, width)
    _write(plotter, "convex", (0.62, 0.022), LINE, width, CONVEX)
    _write(plotter, "concave", (0.70, 0.022), LINE, width, CONCAVE)


def _write(
    plotter: Any, text: str, place: tuple[float, float], size: int, width: int, color: str = CURVE_COLOR
) -> None:
    actor = plotter.add_text(text, position=place, viewport=True, color=color)
    actor.GetTextProperty().SetFontSize(max(SMALLEST, round(size * width / WIDTH)))
