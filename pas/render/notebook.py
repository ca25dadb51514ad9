"""Shapes in notebooks: what they are, the verdicts, and a picture."""

from __future__ import annotations

import base64
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from pas.errors import PasError
from pas.render.picture import draw
from pas.shape import Shape

SIZE = (480, 360)


def html(shape: Shape) -> str:
    """What it is, the table of the verdicts and a picture; where there can be no picture, why not."""
    return f"<pre>{escape(shape.description)}</pre>{shape.certificate._repr_html_()}{_picture(shape)}"


def _picture(shape: Shape) -> str:
    with TemporaryDirectory() as folder:
        try:
            content = draw(shape, Path(folder) / "picture.png", size=SIZE).read_bytes()
        except (PasError, ValueError) as error:
            return f"<p>no picture: {escape(str(error))}</p>"
    return f'<img src="data:image/png;base64,{base64.b64encode(content).decode("ascii")}" alt="{escape(repr(shape))}">'
