"""How many fillets of drawn pairs of crossing primitives are proved, beside those of Open CASCADE in the same run.

Hosts are a box, a cylinder, a ball, a cone and a torus in turn, pegs a tilted cylinder, cone or ball; the radius is a
share of the peg's, drawn from 0.15 to 0.5 (small) or 0.5 to 1.5 (large).  Pairs whose faces do not cross are drawn
again.  Prints a line for each fillet that is not proved, with the radius that is, and a table: made and proved (by Open
CASCADE: made and valid), processor seconds, and the largest curvature times the radius, which is 1 at least.

    python benchmarks/fillets.py [--count 100] [--first 0] [--orders 1 2] [--seed 2026]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from flint import fmpq

import pas
from pas import solid
from pas.algebra.rational import rational, to_float
from pas.solid.fillets import Filling

HOSTS, PEGS = ("box", "cylinder", "ball", "cone", "torus"), ("cylinder", "cone", "ball")
SIZES = {"small": (0.15, 0.5), "large": (0.5, 1.5)}
LENGTH = 2.2  # of pegs that are no balls


def decimal(value: float) -> str:
    """A number as both programs get it."""
    return f"{value:.3f}"


@dataclass(frozen=True)
class Pair:
    """What is drawn: the kinds, where the peg begins, its direction, and its radius."""

    host: str
    peg: str
    start: tuple[str, ...]
    end: tuple[str, ...]
    radius: str

    @classmethod
    def drawn(cls, number: int, rng: np.random.Generator) -> Pair:
        """A peg that leaves the host through its smooth side."""
        host, peg = HOSTS[number % 5], PEGS[number // 5 % 3]
        out = np.array([1.0, 0, 0] if host == "torus" else [0, 0, 1.0])
        tilt, turn = rng.uniform(0, 0.6), rng.uniform(0, 2 * np.pi)
        aside = np.cos(turn) * np.array([0, 1.0, 0]) + np.sin(turn) * np.cross(out, [0, 1.0, 0])
        way = np.cos(tilt) * out + np.sin(tilt) * aside
        size = 0.8 if host == "torus" else 1.0
        start = np.array([2.0 if host == "torus" else 0, 0, 0]) + rng.uniform(-0.15, 0.15, 3) * size
        radius, length = size * rng.uniform(0.2, 0.6), 0.85 * size if peg == "ball" else LENGTH
        ends = ([decimal(x) for x in point] for point in (start, start + length * way))
        return cls(host, peg, *map(tuple, ends), decimal(1.3 * radius if peg == "ball" else radius))

    @property
    def tip(self) -> str:
        """The radius at the end of a peg that is no ball."""
        return decimal(float(self.radius) * (0.6 if self.peg == "cone" else 1))

    @property
    def ours(self) -> tuple[solid.Solid, tuple[str, str]]:
        """The union, and the names of its faces."""
        host = {
            "box": lambda: solid.box((-2, -2, -1), (2, 2, 1), face="host"),
            "cylinder": lambda: solid.cylinder((-3, 0, 0), (3, 0, 0), 1, face="host"),
            "ball": lambda: solid.ball((0, 0, 0), 1, face="host"),
            "cone": lambda: solid.cone((-3, 0, 0), (3, 0, 0), "1.3", "0.7", face="host"),
            "torus": lambda: solid.torus((0, 0, 0), (0, 0, 1), 2, "0.8", face="host"),
        }[self.host]()
        if self.peg == "ball":
            peg = solid.ball(self.end, self.radius, face="peg")
        else:
            peg = solid.cone(self.start, self.end, self.radius, self.tip, face="peg")
        return host | peg, ("host z+" if self.host == "box" else "host", "peg")

    def theirs(self, radius: float) -> tuple[bool, bool, float]:
        """Whether Open CASCADE has a fillet, whether it is valid, and its largest curvature."""
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
        from OCP.BRepCheck import BRepCheck_Analyzer
        from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
        from OCP.BRepPrimAPI import (
            BRepPrimAPI_MakeBox,
            BRepPrimAPI_MakeCone,
            BRepPrimAPI_MakeCylinder,
            BRepPrimAPI_MakeSphere,
            BRepPrimAPI_MakeTorus,
        )
        from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
        from OCP.Standard import Standard_Failure
        from OCP.TopoDS import TopoDS

        along = gp_Ax2(gp_Pnt(-3, 0, 0), gp_Dir(1, 0, 0))
        host = {
            "box": lambda: BRepPrimAPI_MakeBox(gp_Pnt(-2, -2, -1), gp_Pnt(2, 2, 1)),
            "cylinder": lambda: BRepPrimAPI_MakeCylinder(along, 1.0, 6.0),
            "ball": lambda: BRepPrimAPI_MakeSphere(1.0),
            "cone": lambda: BRepPrimAPI_MakeCone(along, 1.3, 0.7, 6.0),
            "torus": lambda: BRepPrimAPI_MakeTorus(2.0, 0.8),
        }[self.host]()
        start, end, thick = np.array(self.start, float), np.array(self.end, float), float(self.radius)
        frame, length = gp_Ax2(gp_Pnt(*start.tolist()), gp_Dir(*(end - start).tolist())), np.linalg.norm(end - start)
        peg = {
            "cylinder": lambda: BRepPrimAPI_MakeCylinder(frame, thick, float(length)),
            "cone": lambda: BRepPrimAPI_MakeCone(frame, thick, float(self.tip), float(length)),
            "ball": lambda: BRepPrimAPI_MakeSphere(gp_Pnt(*end.tolist()), thick),
        }[self.peg]()
        whole = BRepAlgoAPI_Fuse(host.Shape(), peg.Shape())
        maker, edges = BRepFilletAPI_MakeFillet(whole.Shape()), [TopoDS.Edge(edge) for edge in whole.SectionEdges()]
        for edge in edges:
            maker.Add(radius, edge)
        try:
            maker.Build()
        except Standard_Failure:
            return False, False, 0.0
        if not maker.IsDone():
            return False, False, 0.0
        valid = BRepCheck_Analyzer(maker.Shape()).IsValid()
        bends = [bend for edge in edges for face in maker.Generated(edge) for bend in curvatures(face)]
        return True, valid, max(bends, default=0.0)


def curvatures(face: Any) -> Iterator[float]:
    """The larger principal curvature of a face of Open CASCADE, at a grid of its parameters."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepLProp import BRepLProp_SLProps
    from OCP.TopoDS import TopoDS

    surface = BRepAdaptor_Surface(TopoDS.Face(face))
    ends = (surface.FirstUParameter(), surface.LastUParameter(), surface.FirstVParameter(), surface.LastVParameter())
    for u in np.linspace(*ends[:2], 18)[1:-1].tolist():
        for v in np.linspace(*ends[2:], 18)[1:-1].tolist():
            at = BRepLProp_SLProps(surface, u, v, 2, 1e-9)
            if at.IsCurvatureDefined():
                yield max(abs(at.MaxCurvature()), abs(at.MinCurvature()))


def largest_curvature(made: solid.Solid) -> float:
    """Of the fillet, at the vertices of its mesh."""
    mesh, (f,) = made.mesh(), made.polynomials["fillet"]
    points = mesh.points[np.unique(mesh.triangles[mesh.faces == mesh.names.index("fillet")])]
    slopes, second = f.gradient(points), pas.Evaluator(f).hessians(points)
    lengths = np.linalg.norm(slopes, axis=1)
    normals = slopes / lengths[:, None]
    flat = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    shape = flat @ second @ flat / lengths[:, None, None]
    return float(np.abs(np.linalg.eigvalsh(shape)).max())


@dataclass
class Row:
    """What a table says of fillets of a size and an order, or of Open CASCADE's."""

    tried: int = 0
    made: int = 0
    sound: int = 0
    seconds: float = 0.0
    bends: tuple[float, ...] = ()

    def __str__(self) -> str:
        bends = f"{median(self.bends):.2f} | {max(self.bends):.2f}" if self.bends else " | "
        return f"{self.tried} | {self.made} | {self.sound} | {self.seconds:.1f} | {bends}"


def measured(pair: Pair, radius: fmpq, orders: list[int], rows: dict[str, Row], size: str, title: str) -> None:
    """Both programs' fillets of one radius."""
    whole, names = pair.ours
    for order in orders:
        row, start = rows.setdefault(f"GC^{order}, {size}", Row()), time.process_time()
        filling = Filling.of(whole, names, order, ())
        found = filling.made(radius)
        row.seconds += time.process_time() - start
        row.tried += 1
        if isinstance(found, str):
            start = time.process_time()
            largest = filling.largest(radius)
            row.made += largest is not None
            took = time.process_time() - start
            print(f"{title}, GC^{order}: {found}; largest {largest} ({took:.1f} s)", flush=True)
            continue
        row.made, row.sound = row.made + 1, row.sound + found.proved
        row.bends = (*row.bends, to_float(radius) * largest_curvature(found))
    row, start = rows.setdefault(f"Open CASCADE, {size}", Row()), time.process_time()
    made, valid, bend = pair.theirs(to_float(radius))
    row.seconds, row.tried = row.seconds + time.process_time() - start, row.tried + 1
    row.made, row.sound = row.made + made, row.sound + valid
    row.bends = (*row.bends, to_float(radius) * bend) if made else row.bends


def main() -> None:
    """Draw, measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--orders", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--seed", type=int, default=2026)
    options = parser.parse_args()
    solid.box((0, 0, 0), (1, 1, 1)).mesh()  # imports
    rows: dict[str, Row] = {}
    for number in range(options.first, options.first + options.count):
        rng = np.random.default_rng((options.seed, number))
        pair = Pair.drawn(number, rng)
        while not crosses(pair):
            pair = Pair.drawn(number, rng)
        for size, share in SIZES.items():
            radius = rational(decimal(float(pair.radius) * rng.uniform(*share)))
            title = f"{number} {pair.host}, {pair.peg} of {pair.radius}, radius {radius}"
            measured(pair, radius, options.orders, rows, size, title)
    print("\n| fillets | tried | made, or a smaller one is | proved, or valid | s | curvature | largest |")
    print("|---|---|---|---|---|---|---|")
    for title, row in rows.items():
        print(f"| {title} | {row} |")


def crosses(pair: Pair) -> bool:
    """Whether the two faces meet in edges with an angle."""
    try:
        Filling.of(*pair.ours, 1, ())
    except pas.errors.GeometryError:
        return False
    return True


if __name__ == "__main__":
    main()
