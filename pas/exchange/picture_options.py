"""What problem files have in common: how the picture is drawn, and how fine the mesh is; the styles of pictures."""

from __future__ import annotations

from typing import Any, ClassVar

from pas.algebra.inputs import check_tolerance
from pas.algebra.rational import to_float, vector
from pas.exchange.tables import TableReader
from pas.registry import Registry

STYLES: Registry[Any] = Registry(
    "style of pictures",
    {
        "plain": "pas.render.styles.plain:PLAIN",
        "zebra": "pas.render.styles.zebra:ZEBRA",
        "highlights": "pas.render.styles.highlights:HIGHLIGHTS",
        "mean": "pas.render.styles.curvature:MEAN",
        "gauss": "pas.render.styles.curvature:GAUSS",
        "max": "pas.render.styles.curvature:MAX",
        "min": "pas.render.styles.curvature:MIN",
        "curvature": "pas.render.styles.curvature:CURVATURE",
    },
)
"""What the colours of a picture show; a user's own is added by `STYLES.register(...)`, see `pas.render.scene`."""

PICTURE_KEYS = {"style", "view", "combs"}
"""Of the table [picture]."""

View = tuple[float, float, float]


def check_style(name: Any) -> str:
    """The name of a style; raises `ValueError` with a guess for another word, `TypeError` for what is no text."""
    if not isinstance(name, str):
        raise TypeError(f"style must be a pas.Style or the name of one, not {name!r}")
    if name not in STYLES:
        raise ValueError(STYLES.unknown(name))
    return name


def check_view(value: Any) -> View:
    """A direction to look along; raises `ValueError` and `TypeError`."""
    x, y, z = map(to_float, vector(value, "view"))
    if x == y == z == 0:
        raise ValueError("view must not be the zero vector")
    return x, y, z


class PictureReader(TableReader):
    """Readers of files with a table [picture] (style, view, combs) and a tolerance."""

    usual_style: ClassVar[str] = "zebra"

    def picture(self, data: dict[str, Any]) -> dict[str, Any]:
        """Style, direction of view, and whether there are combs: fields of every problem."""
        table = data.get("picture", {})
        self.check(table, "picture", 0)
        try:
            style = check_style(table.get("style", self.usual_style))
        except (ValueError, TypeError) as error:
            raise self.error(str(error), "picture", 0, "style") from None
        combs = table.get("combs", False)
        if not isinstance(combs, bool):
            raise self.error(f"combs must be true or false, not {combs!r}", "picture", 0, "combs")
        return {"style": style, "view": self._view(table), "combs": combs}

    def tolerance(self, data: dict[str, Any]) -> float | None:
        """That of the mesh, where given."""
        tolerance: float | None = self.checked(data, "tolerance", check_tolerance, None)
        return tolerance

    def _view(self, table: dict[str, Any]) -> View | None:
        if "view" not in table:
            return None
        try:
            return check_view(table["view"])
        except (ValueError, TypeError) as error:
            raise self.error(str(error), "picture", 0, "view") from None
