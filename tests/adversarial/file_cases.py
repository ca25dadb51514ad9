"""Files to be changed at random: one of every kind that `pas` reads, with the commands that read it."""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from conftest import EQUAL, ROOT, solved

import pas
from pas import solid

EXAMPLES = ROOT / "examples"

SINGLE = """\
order = 1
degree = 3
prove = false
guard = false
tolerance = 0.1

[[contacts]]
surface = "y^2 + z^2 - 1"
clip = "x - 2"

[[contacts]]
surface = "x^2 + z^2 - 1"
clip = "y - 2"

[partition]
kind = "single cell"
lower = [-2, -2, -2]
upper = [2, 2, 2]
"""

WISHES = """\
name = "wishes"
order = 1
degree = 4
tolerance = 0.1

[[pipes]]
axis = [1, 0, 0]
radius = "1/3"
clip = 1
point = [0, 0, 0]

[[pipes]]
axis = [0, 1, 0]
radius = 0.25
clip = 1

[[contacts]]
surface = "x^2 + y^2 - 4/25"
clip = "z - 1"

[partition]
kind = "six tetrahedra"
center = [0, 0, 0]
legs = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]

[energy]
kind = "thin-plate"
weight = 1

[points]
inside = [[0, 0, "1/4"]]
outside = [["-1/2", "-1/2", "-1/2"]]
through = [["-2/5", "-1/5", "-1/5"]]
near = [["1/2", "1/3", "1/3"]]
near_weight = 10
margin = "1/1000"

[normalize]
kind = "value-at"
point = [0, 0, 0]
value = -1
"""

BOUNDARIES = """\
method = "generatrix"
tolerance = 0.1

[[boundaries]]
x = "2*cos(t)"
y = "2*sin(t)"
z = "h"
h = 0
domain = [[0, "1"], [0, 1]]
name = "a pipe"
side = 1

[[boundaries]]
curve = ["cos(s)", "sin(s)", "2"]
tangent = ["0", "0", "1"]
interval = [0, 1]
closed = false
by_length = true

[shape]
l1 = [[0, 1], ["1/2", 2]]
l2 = 1
lambda1 = "1/4"
middle = ["1", "s", "1"]

[picture]
style = "plain"
view = [1, -1, "1/2"]
"""

PROBLEMS = ("blend", "--no-picture", "-o")
PARAMETRIC = ("parametric", "--no-picture", "-o")


@dataclass(frozen=True)
class Base:
    """A file that is good, as text and as data, and the commands that read it.

    `{}` in a command stands for the file; a command that ends in -o is given a place to write to.
    """

    name: str
    text: str
    commands: tuple[tuple[str, ...], ...]

    @property
    def is_project(self) -> bool:
        """Whether it is a project file, not a problem file."""
        return self.name.endswith(".pas.json")

    @property
    def data(self) -> Any:
        """The content of a project file, the whole of a problem file."""
        return json.loads(self.text)["content"] if self.is_project else tomllib.loads(self.text)


def problems() -> list[Base]:
    """Problem files of every kind."""

    def example(name: str, *commands: tuple[str, ...]) -> Base:
        path = EXAMPLES / name
        return Base(path.name, path.read_text(), commands)

    blend = ("blend", "{}", "--no-picture", "--tolerance", "0.1", "-o")
    small = ("blend", "{}", "--no-picture", "-o")
    solve = ("solve", "{}")
    parametric = ("parametric", "{}", "--no-picture", "--tolerance", "0.2", "-o")
    own = ("parametric", "{}", "--no-picture", "-o")
    return [
        example("corners/equal_gc1.toml", blend, solve),
        example("corners/published_a.toml", blend),
        Base("single.toml", SINGLE, (small, solve, (*solve, "--method", "syzygy"))),
        Base("wishes.toml", WISHES, (small, solve)),
        Base("boundaries.toml", BOUNDARIES, (own,)),
        *(
            example(f"parametric/{name}.toml", parametric)
            for name in ("example_1", "example_2_weights", "input_I", "wavy_pipes")
        ),
        *(
            example(f"parametric/generatrix/{name}.toml", parametric)
            for name in ("quadrics", "helicoid", "obstacle", "cone_and_ellipsoid")
        ),
    ]


@cache
def projects() -> tuple[Base, ...]:
    """Project files of every kind, made once for all tests of this process."""
    check, rough = ("check", "{}"), ("--tolerance", "0.4", "-o", "a.stl")
    independent = (("check", "{}", "--independent"), ("check", "{}", "--independent", "--json"))
    as_json = ("check", "{}", "--json")
    mesh, convert = ("mesh", "{}", *rough), ("convert", "{}", "--tolerance", "0.4", "a.ply")
    corner = solved(EQUAL, 1)
    elbow = pas.blend(
        [("y^2 + z^2 - 1", "x - 2"), ("x^2 + z^2 - 1", "y - 2")],
        1,
        partition=pas.SingleCell((-2, -2, -2), (2, 2, 2)),
    )
    halves = solid.patch("top", "x^2 + y^2 + z^2 - 1", "z") | solid.patch("bottom", "x^2 + y^2 + z^2 - 1", "-z")
    joined = halves.joined("top", "bottom", ("x^2 + y^2 + z^2 - 1", "z"), 1)
    part = solid.box((0, 0, 0), (1, 1, 1)) - solid.ball((1, 1, 1), "1/2")
    bent = solid.tube(("cos(t)", "sin(t)", "t/5"), "1/8", interval=(0, 3))
    hollow = solid.ball((0, 0, 0), 1).shell(0.2, tolerance=0.4).rotate((1, 1, 0), 33)
    tetra = solid.SolidMesh.from_triangles(
        [(0, 0, 0), (1 / 3, 0, 0), (0, 0.1, 0), (0, 0, 1e-7)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)], "tetra"
    )
    surface = pas.ParametricSurface("(1-t^2)/(1+t^2)", "2*t/(1+t^2)", "h", domain=((-1, 1), (0, 1)))
    waves = pas.ParametricSurface("cos(t)", "sin(t)", "h + t", domain=((0, 1), (0, 1)))
    data = pas.BlendingData([pas.elliptic_cylinder(1, 1), pas.elliptic_cylinder(2, 2)], values=[0, 1])
    square = ((-1, 1), (0, 1))
    neck, weighted = pas.hermite_blend(data, 1), pas.weighted_blend(data, 1)
    quadrics = pas.read_parametric_problem(EXAMPLES / "parametric/generatrix/quadrics.toml").solve()
    ends = [{"quadric": "x^2 + y^2 - 1", "plane": "z - 3"}, {"quadric": "x^2 + z^2 - 1", "plane": "y - 3"}]
    through = pas.blend_through_sphere(list(map(pas.boundary_from, ends)), (0, 0, 0), "3/2")
    things: dict[str, tuple[Any, tuple[tuple[str, ...], ...]]] = {
        "corner": (corner, (check, *independent, as_json, mesh, convert)),
        "elbow": (elbow, (check, *independent, as_json, mesh)),
        "joined": (joined, (check, convert)),
        "part": (part, (mesh,)),
        "bent": (bent, (convert,)),
        "hollow": (hollow, (mesh,)),
        "body": (corner.solid("1/2"), (check,)),
        "assembly": (solid.assembly(part=part, halves=(joined, "#0a0B0c"), mesh=tetra), (check, convert)),
        "surface": (surface, (check, mesh)),
        "waves": (waves, (check, mesh)),
        "neck": (_on(neck, square), (check, mesh)),
        "weighted": (_on(weighted, square), (check, mesh)),
        "quadrics": (quadrics, (check, as_json, mesh)),
        "patches": (corner.surface, (check, mesh)),
        "through": (through, (check,)),
        "net": (pas.bezier_patches(surface)[0], (check, as_json, mesh)),
        "tetra": (tetra, (check, as_json, ("write", "{}", "a.ply"))),
    }
    with TemporaryDirectory() as folder:
        return tuple(
            Base(f"{name}.pas.json", thing.save(Path(folder) / f"{name}.pas.json").read_text(), commands)
            for name, (thing, commands) in things.items()
        )


@cache
def further() -> tuple[Base, ...]:
    """Project files of the kinds that no changed file is drawn of, and of blends with wishes and a given basis."""
    outer = pas.blend([pas.Pipe((1, 0, 0), 1, 2), pas.Pipe((-1, 0, 0), "1/2", 2)], 1, energy=pas.ThinPlate())
    inner = [pas.Contact("y^2 + z^2 - 4/9", "x - 2"), pas.Contact("y^2 + z^2 - 1/9", "-x - 2")]
    space = pas.solutions([pas.Pipe(axis, "1/3", 1) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))], 1, 4)
    wished = space.fit(
        inside=[(0, 0, "1/4")], outside=[("-1/2",) * 3], through=[("-1/5",) * 3], near=[("-1/4", "-1/5", "-1/5")],
        energy=pas.ThinPlate(), limits=pas.FairnessLimits(2, 2, 2, 2), prove=False,
    )  # fmt: skip
    handle = space.determining_set()[0]
    given = space.restricted(space.basis[:6]).fit(
        energy=pas.ThinPlate(), prove=False, guard=False, handles={handle: 1}, normalize=pas.SumOfCoefficients()
    )
    things: dict[str, Any] = {
        "hollow blend": outer.hollow("1/5"),
        "hollow blend of given contacts": outer.hollow(inner=inner),
        "wished": wished,
        "given": given,
        "layout": outer.surface.partition.layout,
        "node": outer,
        "a part": solid.assembly(ball=solid.ball((0, 0, 0), 1))["ball"],
        "teapot": pas.teapot("paper"),
        "network": pas.network.Network([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1), (0, 2)], "1/8", "1/8").blend(
            1, "lowest"
        ),
    }
    with TemporaryDirectory() as folder:
        return tuple(
            Base(f"{name}.pas.json", thing.save(Path(folder) / f"{name}.pas.json").read_text(), ())
            for name, thing in things.items()
        )


def _on(blend: pas.ParametricBlend, domain: Any) -> pas.ParametricBlend:
    from dataclasses import replace

    return replace(blend, surface=blend.surface.with_domain(domain))
