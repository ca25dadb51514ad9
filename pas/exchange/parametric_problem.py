"""Problem files (TOML) of parametric blends: which surfaces, at which values, and how.

Files of the methods "generatrix" and "quadrics" have other tables: see `pas.exchange.generatrix_problem`.

order = 2                      # of contact
method = "hermite"             # the default; or "weighted", or another one of METHODS
values = [0, 1]                # optional: the value of the second parameter at which each surface is met
parameters = ["t", "h"]        # optional
tolerance = 1e-3               # optional; of the mesh, in the model's units
prove = true                   # optional; false: the exit code asks only that no claim is refuted, not for all proofs

balance = "1/2"                # options of the method "weighted": balance (one number or one for each surface),
normalized = false             # normalized and exponent

[[surfaces]]
x = "(1 - t^2)/(1 + t^2)"      # exact: a string, an integer, or the decimal as written
y = "2*t/(1 + t^2)"
z = "h - 1"
domain = [[-5, 5], [-inf, 1]]  # optional

[domain]                       # optional; of the proof, the mesh and the picture, by parameter
t = [-1, 1]

[picture]                      # optional
style = "zebra"                # plain, zebra, highlights; mean, gauss, max, min (curvature)
view = [1, -1, "1/2"]          # the direction from where one looks
combs = true                   # with curvature combs
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

from pas.algebra.inputs import check_order, shown
from pas.algebra.rational import rational
from pas.algebra.rational_function import PARAMETERS
from pas.errors import LimitError, PasError
from pas.exchange.generatrix_problem import GENERATRIX_METHODS
from pas.exchange.picture_options import PICTURE_KEYS, PictureReader, View
from pas.exchange.problem import Problem, ProblemKind
from pas.parametric.blends import METHODS, ParametricBlend, blend_by
from pas.parametric.data import BlendingData
from pas.parametric.domain import ExactDomain
from pas.parametric.surface import ParametricSurface

OPTIONS = {name for method in METHODS.values() for name in method.options}
WHOLE = {"name", "order", "method", "values", "parameters", "tolerance", "prove", "surfaces", "domain", "picture"}


@dataclass(frozen=True)
class ParametricProblem(Problem):
    """A problem as read from a file; `domain` is that of proof, mesh and picture, None for the blend's own."""

    name: str
    data: BlendingData
    order: int
    method: str
    options: dict[str, Any]
    domain: ExactDomain | None
    tolerance: float | None
    prove: bool
    style: str
    view: View | None
    combs: bool

    @property
    def fixed(self) -> str:
        """What is said where an option is to be changed."""
        return "a parametric blend has the degree that its data give it"

    def solve(self) -> ParametricBlend:
        """The blend on the problem's domain; raises what its method raises."""
        made = self.blend()
        return made if self.domain is None else replace(made, surface=made.surface.with_domain(self.domain))

    def blend(self) -> ParametricBlend:
        """The blend on its own domain."""
        return blend_by(self.method, self.data, self.order, self.options)


class _Reader(PictureReader):
    keys: ClassVar = {
        "": WHOLE | OPTIONS,
        "surfaces": {"x", "y", "z", "domain"},
        "picture": PICTURE_KEYS,
    }
    required: ClassVar = {"": {"order", "surfaces"}, "surfaces": {"x", "y", "z"}}
    lists: ClassVar = {"surfaces"}

    def problem(self, data: dict[str, Any]) -> ParametricProblem:
        method = self.typed(data, "method", str, "hermite")
        if method not in METHODS:
            known = ", ".join(map(repr, (*METHODS, *GENERATRIX_METHODS)))
            raise self.error(f"method must be one of {known}, not {shown(method)}", "", 0, "method")
        self.check(data, "", 0)
        options = {name: data[name] for name in OPTIONS if name in data}
        for name in options:
            if name not in METHODS[method].options:
                raise self.error(f"{name} is no option of the method {method!r}", "", 0, name)
            if METHODS[method].options[name] is not Any:
                self.typed(data, name, METHODS[method].options[name], None)
        names = self._parameters(data)
        surfaces = [self._surface(i, entry, names) for i, entry in enumerate(data["surfaces"])]
        try:
            blending = BlendingData(surfaces, data.get("values"))
        except LimitError:
            raise
        except (ValueError, TypeError, PasError) as error:
            raise self.error(str(error), "", 0, "values") from None
        return ParametricProblem(
            name=self.name(data),
            data=blending,
            order=self.checked(data, "order", check_order, None),
            method=method,
            options=options,
            domain=self._domain(data, names, blending),
            tolerance=self.tolerance(data),
            prove=self.typed(data, "prove", bool, True),
            **self.picture(data),
        )

    def _parameters(self, data: dict[str, Any]) -> tuple[str, str]:
        names = data.get("parameters", list(PARAMETERS))
        if not (isinstance(names, list) and len(names) == 2 and all(isinstance(n, str) for n in names)):
            wrong = f'parameters must be two names such as ["t", "h"], not {shown(names)}'
            raise self.error(wrong, "", 0, "parameters")
        return names[0], names[1]

    def _surface(self, index: int, entry: dict[str, Any], names: tuple[str, str]) -> ParametricSurface:
        self.check(entry, "surfaces", index)
        try:
            return ParametricSurface(entry["x"], entry["y"], entry["z"], names, _intervals(entry.get("domain")))
        except (ValueError, TypeError) as error:
            key = next((k for k in "xyz" if f"component {k}" in str(error)), "domain" if "domain" in entry else None)
            raise self.error(f"surface {index + 1}: {error}", "surfaces", index, key) from None

    def _domain(self, data: dict[str, Any], names: tuple[str, str], blending: BlendingData) -> ExactDomain | None:
        if "domain" not in data:
            return None
        table = data["domain"]
        if not isinstance(table, dict) or set(table) - set(names):
            raise self.error(f"[domain] must be a table with intervals of {' and '.join(names)}", "domain", 0)
        try:
            own = blending.ends
            given = _intervals([table.get(name, list(ends)) for name, ends in zip(names, own, strict=True)])
            return blending.surfaces[0].with_domain(None).with_domain(given).ends
        except LimitError:
            raise
        except (ValueError, TypeError, PasError) as error:
            raise self.error(str(error), "domain", 0) from None


def _intervals(domain: Any) -> Any:
    """Intervals as they are written, with None for infinite ends."""
    if not isinstance(domain, list):
        return domain
    return [[_end(end) for end in pair] if isinstance(pair, list) else pair for pair in domain]


def _end(end: Any) -> Any:
    return None if isinstance(end, float) and math.isinf(end) else rational(end, "an end of an interval")


def _fits(data: dict[str, Any]) -> bool:
    wanted = "surfaces" in data or ("method" in data and data["method"] not in tuple(GENERATRIX_METHODS))
    return wanted and not {"pipes", "contacts"} & data.keys()


def _read(file: Path, text: str, data: dict[str, Any]) -> ParametricProblem:
    return _Reader(file, text).problem(data)


PROBLEM = ProblemKind("parametric", _fits, _read)
