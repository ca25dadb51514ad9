"""Problem files (TOML) of parametric blends: which surfaces, at which values, and how.

order = 2                      # of contact
method = "hermite"             # the default; or "weighted", or another one of METHODS
values = [0, 1]                # optional: the value of the second parameter at which each surface is met
parameters = ["t", "h"]        # optional

balance = "1/2"                # options of the method "weighted": balance (one number or one for each surface),
normalized = false             # normalized and exponent

[[surfaces]]
x = "(1 - t^2)/(1 + t^2)"      # exact: a string, an integer, or the decimal as written
y = "2*t/(1 + t^2)"
z = "h - 1"
domain = [[-5, 5], [-inf, 1]]  # optional

[domain]                       # optional; of the proof, the mesh and the picture, by parameter
t = [-1, 1]

Or of blends by a Bezier generatrix: two boundaries, and what shapes the blend between them.

method = "generatrix"          # or "quadrics": the same, of two closed plane sections of quadrics
align = true                   # optional; false: the curves are left as they run
unit = true                    # optional; false: vectors as long as they are, which keeps rational data rational

[[boundaries]]                 # two of these, see below
quadric = "x^2 + y^2 - 1"
plane = "z - 2"

[[boundaries]]
implicit = "y^2 + z^2 - 1"
curve = ["3", "cos(2*pi*s)", "sin(2*pi*s)"]
side = 1                       # optional: on which side the blend lies

[shape]                        # optional, as is each of the five
l1 = 1                         # a number,
l2 = [[0, 1], ["1/2", 2]]      # data pairs (s, value),
lambda1 = { low = 0, high = 0.5, start = 0 }      # or, for closed curves, a cosine
lambda2 = 0
middle = ["2*s", "1", "0"]     # the middle control curve of a quartic blend

Also those of every problem: see `pas.exchange.problem`.  One table of boundaries is one boundary; its keys say of which
kind it is:

quadric, plane                            the section of a quadric by a plane (interval, branch)
quadric, other                            branch number `branch` (0) of the intersection of two quadrics, on number
                                          `number` (0) of the two (interval)
implicit, curve                           a curve on an algebraic surface (interval, closed)
x, y, z and one of t, h, path             a curve on a parametric surface (domain, interval, closed)
curve and one of normal, tangent          a curve with vectors along it (interval, closed)

Each may also have side, name and by_length (true: s is the share of the curve's length).  Expressions are strings,
curves and paths lists of them, in s; numbers are integers or strings such as "1/2".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pas.algebra.inputs import check_order, shown, whole
from pas.algebra.rational_function import PARAMETERS
from pas.exchange.problem import COMMON, COMMON_TABLES, Problem, ProblemKind, TableReader, common
from pas.parametric.blends import METHODS, ParametricBlend, blend_by
from pas.parametric.data import BlendingData
from pas.parametric.generatrix.blend import GeneratrixBlend, generatrix_blend
from pas.parametric.generatrix.boundary import Boundary
from pas.parametric.generatrix.intersection import quadric_intersection
from pas.parametric.generatrix.sections import plane_section
from pas.parametric.generatrix.shape import GeneratrixShape, ShapeFunction
from pas.parametric.maps import ExactDomain
from pas.parametric.surface import ParametricSurface, SurfaceCurve, iso_curve
from pas.settings import MeshSettings


@dataclass(frozen=True)
class BoundaryKind:
    """A kind of boundary: the keys it needs, of `either` exactly one, those it may have, and what makes it."""

    needs: tuple[str, ...]
    either: tuple[str, ...]
    may: frozenset[str]
    build: Callable[[Mapping[str, Any], dict[str, Any]], Boundary]

    @property
    def keys(self) -> frozenset[str]:
        """All keys that there are."""
        return frozenset((*self.needs, *self.either, *self.may, "side", "name", "by_length"))

    def fits(self, table: Mapping[str, Any]) -> bool:
        """Whether a table has what this kind needs."""
        return set(self.needs) <= set(table) and (not self.either or any(key in table for key in self.either))

    def __str__(self) -> str:
        one = [f"one of {', '.join(self.either)}"] if self.either else []
        return " and ".join([", ".join(self.needs), *one])


def _intersection(table: Mapping[str, Any], options: dict[str, Any]) -> Boundary:
    branches = quadric_intersection(table["quadric"], table["other"])
    branch = branches[whole(options.pop("branch", 0), "branch", 0, len(branches) - 1)]
    return branch.on(whole(options.pop("number", 0), "number", 0, 1), **options)


def _parametric(table: Mapping[str, Any], options: dict[str, Any]) -> Boundary:
    surface = ParametricSurface(table["x"], table["y"], table["z"], domain=options.pop("domain", None))
    if "path" not in table:
        return Boundary.on_parametric(iso_curve(surface, table.get("t"), table.get("h")), **options)
    path = table["path"]
    if not isinstance(path, list) or len(path) != 2:
        raise ValueError(f'path must be two expressions in s such as ["s", "1 - s"], not {path!r}')
    return Boundary.on_parametric(SurfaceCurve(surface, path[0], path[1]), **options)


SECTION = BoundaryKind(
    ("quadric", "plane"), (), frozenset({"interval", "branch"}),
    lambda table, options: plane_section(table["quadric"], table["plane"], **options),
)  # fmt: skip
CURVE = frozenset({"interval", "closed"})
KINDS = (
    SECTION,
    BoundaryKind(("quadric", "other"), (), frozenset({"interval", "branch", "number"}), _intersection),
    BoundaryKind(
        ("implicit", "curve"), (), CURVE,
        lambda table, options: Boundary.on_implicit(table["implicit"], table["curve"], **options),
    ),
    BoundaryKind(("x", "y", "z"), ("t", "h", "path"), CURVE | {"domain"}, _parametric),
    BoundaryKind(
        ("curve",), ("normal", "tangent"), CURVE,
        lambda table, options: Boundary.along(table["curve"], table.get("normal"), table.get("tangent"), **options),
    ),
)  # fmt: skip
KEYS = frozenset().union(*(kind.keys for kind in KINDS))


def boundary_from(table: Mapping[str, Any], kinds: tuple[BoundaryKind, ...] = KINDS) -> Boundary:
    """The boundary of a table.

    Raises `ValueError` for a table of no kind or of wrong types, and what making the boundary raises.
    """
    kind = next((k for k in kinds if k.fits(table)), None)
    if kind is None:
        raise ValueError(f"a boundary needs {'; or '.join(map(str, kinds))}; this one has {', '.join(table) or 'none'}")
    strange = [key for key in table if key not in kind.keys]
    if strange or sum(key in table for key in kind.either) > 1:
        more = strange or [key for key in kind.either if key in table][1:]
        raise ValueError(f"a boundary with {kind} has no {more[0]!r} besides")
    for key, types in (("name", str), ("closed", bool), ("by_length", bool)):
        if key in table and not isinstance(table[key], types):
            raise ValueError(f"{key} must be {'a string' if types is str else 'true or false'}, not {table[key]!r}")
    made = kind.build(table, {key: table[key] for key in (*kind.may, "side", "name") if key in table})
    return made.by_length() if table.get("by_length") else made


GENERATRIX_METHODS = {"generatrix": KINDS, "quadrics": (SECTION,)}
"""Names of the methods, and the kinds of boundaries that each takes."""

GENERATRIX_TABLES = {
    "": COMMON | dict.fromkeys(("method", "align", "unit", "shape"), False) | {"boundaries": True},
    **COMMON_TABLES,
    "boundaries": dict.fromkeys(KEYS, False),
    "shape": dict.fromkeys(("l1", "l2", "lambda1", "lambda2", "middle"), False),
}


@dataclass(frozen=True)
class ParametricProblem(Problem):
    """A problem as read from a file; `domain` is that of proof, mesh and picture, None for the blend's own."""

    data: BlendingData
    order: int
    method: str
    options: dict[str, Any]
    domain: ExactDomain | None

    @property
    def fixed(self) -> str:
        return "a parametric blend has the degree that its data give it"

    def solve(self) -> ParametricBlend:
        made = self.blend()
        return made if self.domain is None else replace(made, surface=made.surface.with_domain(self.domain))

    def blend(self) -> ParametricBlend:
        """The blend itself, on its own domain; raises what its method raises."""
        return blend_by(self.method, self.data, self.order, self.options)


def _read(file: Path, text: str, data: dict[str, Any]) -> ParametricProblem:
    own = {name for method in METHODS.values() for name in method.options}
    optional = ("method", "values", "parameters", "domain", *own)
    parameters = data.get("parameters", list(PARAMETERS))
    keys = {
        "": COMMON | dict.fromkeys(optional, False) | {"order": True, "surfaces": True},
        **COMMON_TABLES,
        "surfaces": {"x": True, "y": True, "z": True, "domain": False},
    }
    reader = TableReader(file, text, keys, ("surfaces",))
    method = reader.typed(data, "method", str, "hermite")
    if method not in METHODS:
        known = ", ".join(map(repr, (*METHODS, *GENERATRIX_METHODS)))
        raise reader.error(f"method must be one of {known}, not {shown(method)}", key="method")
    reader.check(data)
    options = {name: data[name] for name in own if name in data}
    for name in options:
        if name not in METHODS[method].options:
            raise reader.error(f"{name} is no option of the method {method!r}", key=name)
        if METHODS[method].options[name] is not Any:
            reader.typed(data, name, METHODS[method].options[name], None)
    first, second = reader.checked({"parameters": parameters}, "parameters", _names)
    made = lambda of: ParametricSurface(of["x"], of["y"], of["z"], (first, second), of.get("domain"))  # noqa: E731
    surfaces = reader.each(data, "surfaces", made, "surface")
    blending = reader.checked({"values": data.get("values")}, "values", lambda values: BlendingData(surfaces, values))
    return ParametricProblem(
        **common(reader, data, MeshSettings()),
        prove=reader.typed(data, "prove", bool, True),
        data=blending,
        order=reader.checked(data, "order", check_order),
        method=method,
        options=options,
        domain=_domain(reader, data, (first, second), blending),
    )


def _names(given: Any) -> list[str]:
    if not (isinstance(given, list) and len(given) == 2 and all(isinstance(name, str) for name in given)):
        raise ValueError(f'parameters must be two names such as ["t", "h"], not {shown(given)}')
    return given


def _domain(
    reader: TableReader, data: dict[str, Any], names: tuple[str, str], blending: BlendingData
) -> ExactDomain | None:
    if "domain" not in data:
        return None
    given = data["domain"]
    if not isinstance(given, dict) or set(given) - set(names):
        raise reader.error(f"[domain] must be a table with intervals of {' and '.join(names)}", "domain")

    def make(table: dict[str, Any]) -> ExactDomain:
        ends = [table.get(name, list(own)) for name, own in zip(names, blending.ends, strict=True)]
        return blending.surfaces[0].with_domain(None).with_domain(ends).ends

    reader.keys = {**reader.keys, "domain": dict.fromkeys(names, False)}
    return reader.made(make, given, "domain")


def _fits(data: dict[str, Any]) -> bool:
    wanted = "surfaces" in data or ("method" in data and data["method"] not in GENERATRIX_METHODS)
    return wanted and not {"pipes", "contacts"} & data.keys()


PROBLEM = ProblemKind("parametric", _fits, _read)


@dataclass(frozen=True)
class GeneratrixProblem(Problem):
    """A problem of the methods "generatrix" and "quadrics" as read from a file."""

    method: str
    boundaries: tuple[Boundary, Boundary]
    shape: GeneratrixShape
    align: bool
    unit: bool

    @property
    def fixed(self) -> str:
        return f"a blend of the method {self.method!r} has contact of order 1"

    def solve(self) -> GeneratrixBlend:
        return generatrix_blend(*self.boundaries, self.shape, self.align, self.unit)

    blend = solve


def _read_generatrix(file: Path, text: str, data: dict[str, Any]) -> GeneratrixProblem:
    reader = TableReader(file, text, GENERATRIX_TABLES, ("boundaries",))
    reader.check(data)
    method = data.get("method", "generatrix")
    if len(data["boundaries"]) != 2:
        raise reader.error(f"there must be two [[boundaries]], not {len(data['boundaries'])}", key="boundaries")
    first, second = reader.each(data, "boundaries", lambda table: _boundary(table, method), "boundary")
    return GeneratrixProblem(
        **common(reader, data, MeshSettings()),
        prove=reader.typed(data, "prove", bool, None),
        method=method,
        boundaries=(first, second),
        shape=reader.made(_shape, data.get("shape", {}), "shape"),
        align=reader.typed(data, "align", bool, True),
        unit=reader.typed(data, "unit", bool, True),
    )


def _boundary(table: dict[str, Any], method: str) -> Boundary:
    made = boundary_from(table, GENERATRIX_METHODS[method])
    if method == "quadrics" and not made.closed:
        raise ValueError('the section is an open curve; blend it by method = "generatrix"')
    return made


def _shape(table: dict[str, Any]) -> GeneratrixShape:
    found: dict[str, Any] = {}
    for key, value in table.items():
        try:
            found[key] = value if key == "middle" else _function(value)
            GeneratrixShape(**{key: found[key]})
        except (ValueError, TypeError) as error:
            raise ValueError(str(error) if str(error).startswith(key) else f"{key}: {error}") from None
    return GeneratrixShape(**found)


def _function(value: Any) -> Any:
    """A number as it is, data pairs or a cosine as a shape function."""
    if isinstance(value, list):
        return ShapeFunction.through([pair if isinstance(pair, list) else [pair] for pair in value])
    if isinstance(value, dict):
        if not {"low", "high"} <= set(value) <= {"low", "high", "start"}:
            raise ValueError(f"a cosine has low, high and perhaps start, not {', '.join(value) or 'nothing'}")
        return ShapeFunction.cosine(**value)
    return value


GENERATRIX = ProblemKind(
    "generatrix",
    lambda data: data.get("method", "generatrix" if "boundaries" in data else "") in GENERATRIX_METHODS,
    _read_generatrix,
)
