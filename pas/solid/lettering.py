"""Text as profiles, exact: outlines of TrueType fonts are lines and parabolas with whole numbers as coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import reduce
from operator import sub
from pathlib import Path
from typing import Any

from pas.algebra.rational import Exact, positive, rational
from pas.errors import GeometryError, meant, optional
from pas.solid.edges import PlaneEdge, Point, turn
from pas.solid.profile import Profile, plane_point
from pas.solid.sketch import closed

Contour = list[tuple[Point, ...]]
"""Pieces of an outline, each with two or three control points."""


def text(words: str, size: Exact, corner: Sequence[Exact] = (0, 0), font: str | Path = "DejaVu Sans") -> Profile:
    """The outlines of a line of text, from a corner on the base line to the right.

    `size` is that of the font, in the model's units; capital letters are about 0.7 of it high.  `font` is the name of a
    font that is installed, or the path of a TrueType or OpenType file; of OpenType's cubic outlines parabolas are taken
    that are within a thousandth of the size.  Faces are named after the letters, "a" or, with several outlines, "b 2".
    Raises `GeometryError` where the font has no such letter, where an outline crosses itself, and for blank text;
    `FileNotFoundError` where there is no such font, `TypeError` for what is no text.
    """
    from fontTools.ttLib import TTFont

    if not isinstance(words, str):
        raise TypeError(f"text must be a string, not {words!r}")
    place = Path(_font_file(font))
    with TTFont(place, fontNumber=0) as opened:
        glyphs, letters = opened.getGlyphSet(), opened.getBestCmap()
        unit = positive(size, "size") / opened["head"].unitsPerEm
        x, y = plane_point(corner, "corner")
        parts: list[Profile] = []
        for number, letter in enumerate(words):
            if ord(letter) not in letters:
                raise GeometryError(
                    f"the font {place.stem} has no letter {letter!r}, which is number {number + 1} of the text"
                )
            glyph = glyphs[letters[ord(letter)]]
            contours = [
                [tuple((x + p * unit, y + q * unit) for p, q in piece) for piece in contour]
                for contour in _contours(glyph, glyphs, opened)
            ]
            try:
                parts += _letter(contours, letter)
            except GeometryError as error:
                raise GeometryError(f"the letter {letter!r} of the font {place.stem}: {error}") from None
            x += glyph.width * unit
    if not parts:
        raise GeometryError(f"the text {words!r} has no outlines: it is blank")
    return parts[0] if len(parts) == 1 else Profile(None, tuple(parts), union=True)


def _font_file(font: str | Path) -> str:
    """The file of a font by its path or name."""
    if Path(font).suffix.lower() in (".ttf", ".otf", ".ttc"):
        if not Path(font).is_file():
            raise FileNotFoundError(f"there is no font file {font}")
        return str(font)
    optional("matplotlib")
    from matplotlib import font_manager

    try:
        return str(font_manager.findfont(str(font), fallback_to_default=False))
    except ValueError:
        guess = meant(str(font), font_manager.get_font_names())
        raise FileNotFoundError(
            f"no font {str(font)!r} is installed{guess or '; give the path of its .ttf file'}"
        ) from None


def _contours(glyph: Any, glyphs: Any, font: Any) -> Iterator[Contour]:
    """The outlines of a glyph, in the font's units."""
    from fontTools.pens.basePen import decomposeQuadraticSegment
    from fontTools.pens.cu2quPen import Cu2QuPen
    from fontTools.pens.recordingPen import DecomposingRecordingPen

    pen = DecomposingRecordingPen(glyphs)
    glyph.draw(Cu2QuPen(pen, font["head"].unitsPerEm / 1000))
    pieces, here, begin = list[Any](), (0, 0), (0, 0)
    for operation, given in pen.value:
        points = [p for p in given if p is not None]
        if operation == "moveTo":
            pieces, here, begin = [], points[0], points[0]
        elif operation == "lineTo":
            pieces.append((here, points[0]))
            here = points[0]
        elif operation == "qCurveTo":
            for control, end in decomposeQuadraticSegment(points):
                pieces.append((here, control, end))
                here = end
        else:
            outline = (piece for piece in [*pieces, (here, begin)] if piece[0] != piece[-1])
            made = [tuple((rational(Fraction(x)), rational(Fraction(y))) for x, y in piece) for piece in outline]
            if any(turn(made[0][0], made[0][-1], p) for piece in made for p in piece):  # fonts have hairlines
                yield made


def _letter(contours: Sequence[Contour], letter: str) -> list[Profile]:
    """The profiles of which a letter is made: what is inside an odd number of its outlines."""
    made: list[Profile] = []
    for number, contour in enumerate(contours):
        name = f"{letter} {number + 1}" if len(contours) > 1 else letter
        edges = [
            PlaneEdge.straight(*piece, name) if len(piece) == 2 else PlaneEdge.parabola(*piece, name)  # type: ignore[call-arg, arg-type]
            for piece in contour
        ]
        made.append(closed(edges))
    starts = [next(profile.all_loops).edges[0].start for profile in made]
    around = [[k for k, other in enumerate(made) if k != n and other.holds(p)] for n, p in enumerate(starts)]
    return [
        reduce(sub, (made[k] for k, those in enumerate(around) if n in those and len(those) == len(outer) + 1), made[n])
        for n, outer in enumerate(around)
        if len(outer) % 2 == 0
    ]
