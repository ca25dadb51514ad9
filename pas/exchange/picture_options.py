"""What problem files have in common: how the picture is drawn, and how fine the mesh is."""

from __future__ import annotations

from typing import Any, ClassVar

from pas.algebra.inputs import check_tolerance, shown
from pas.algebra.rational import to_float, vector
from pas.exchange.tables import TableReader

STYLES = ("plain", "zebra", "curvature")
View = tuple[float, float, float]


class PictureReader(TableReader):
    """Readers of files with a table [picture] (style, view) and a tolerance."""

    usual_style: ClassVar[str] = "zebra"

    def picture(self, data: dict[str, Any]) -> tuple[str, View | None]:
        """Style and direction of view."""
        table = data.get("picture", {})
        self.check(table, "picture", 0)
        style = table.get("style", self.usual_style)
        if not isinstance(style, str) or style not in STYLES:
            raise self.error(f"style must be one of {', '.join(STYLES)}, not {shown(style)}", "picture", 0, "style")
        return str(style), self._view(table)

    def tolerance(self, data: dict[str, Any]) -> float | None:
        """That of the mesh, where given."""
        tolerance: float | None = self.checked(data, "tolerance", check_tolerance, None)
        return tolerance

    def _view(self, table: dict[str, Any]) -> View | None:
        if "view" not in table:
            return None
        try:
            x, y, z = map(to_float, vector(table["view"], "view"))
        except (ValueError, TypeError) as error:
            raise self.error(str(error), "picture", 0, "view") from None
        if x == y == z == 0:
            raise self.error("view must not be the zero vector", "picture", 0, "view")
        return x, y, z
