"""The surface of a project file, read anew: points, cells, patches, contacts, and where cells meet."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from itertools import combinations, product
from operator import index
from typing import Any

from flint import fmpq, fmpq_mpoly

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import rational
from pas.independent.signs import RING, Point, on_simplex

HIGHEST_ORDER, HIGHEST_DEGREE = 20, 20
"""Beyond these, exact arithmetic on all of a region takes minutes; corners of order 4 have degree 8."""

Face = tuple[tuple[int, ...], int]
"""Three point numbers, and the cell from which the face is looked at."""

CORNERS_OF_SIX = ((1, 1, 1), (-1, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 1, 0), (-1, 0, 1), (0, -1, 1), (1, -1, 0))
"""Z1, Z2, V1, ..., V6 of the six tetrahedra Z1 Z2 V_(i-1) V_i, as sums of the three legs."""


class Surface:
    """What a project file says of a surface.  All polynomials are homogeneous, the patches of one degree.

    Raises `KeyError`, `TypeError` or `ValueError` for a record that makes no sense.
    """

    def __init__(self, record: dict[str, Any]) -> None:
        self.order = record["order"]
        if type(self.order) is not int or not 0 <= self.order <= HIGHEST_ORDER:
            raise ValueError(f"the order must be a whole number from 0 to {HIGHEST_ORDER}, not {self.order!r}")
        given = [(Polynomial(str(c["surface"])), Polynomial(str(c["clip"]))) for c in record["contacts"]]
        if any(f.degree < 1 or h.degree < 1 or not f.raw.gcd(h.raw).is_constant() for f, h in given):
            raise ValueError("a clip must cut its surface in a curve")
        self.contacts = [(_homogeneous(f, f.degree), _homogeneous(h, h.degree)) for f, h in given]
        patches = [Polynomial({(i, j, k): c for i, j, k, c in terms}) for terms in record["patches"]]
        if any(len({tuple(term[:3]) for term in terms}) < len(terms) for terms in record["patches"]):
            raise ValueError("a patch has two terms with the same exponents")
        if any(p.degree > HIGHEST_DEGREE for p in (*patches, *(p for contact in given for p in contact))):
            raise ValueError(f"the independent checker serves degrees up to {HIGHEST_DEGREE}")
        self.patches = [_homogeneous(p, max(p.degree for p in patches)) for p in patches]
        self.points, cells, pieces, self.centre = _partition(record["partition"])
        self.cells = [tuple(map(index, cell)) for cell in cells]
        if len(pieces) != len(self.patches) or sorted(c for p in pieces for c in p) != list(range(len(self.cells))):
            raise ValueError("each cell must have one patch")
        if any(len(set(cell)) != 4 or not set(cell) <= set(range(len(self.points))) for cell in self.cells):
            raise ValueError("each cell must have four corners")
        self.patch_of = {cell: number for number, piece in enumerate(pieces) for cell in piece}
        self.owners = _owners(self.cells)
        self.outer: list[Face] = [(triangle, cells[0]) for triangle, cells in self.owners.items() if len(cells) == 1]

    def corners(self, numbers: Iterable[int]) -> list[Point]:
        """The points of a cell or a triangle."""
        return [self.points[i] for i in numbers]

    def off(self, face: Face) -> Point:
        """The corner of a face's cell that is not on it."""
        return self.points[next(i for i in self.cells[face[1]] if i not in face[0])]

    def patch(self, cell: int) -> fmpq_mpoly:
        """The polynomial in a cell."""
        return self.patches[self.patch_of[cell]]

    def inner(self) -> dict[tuple[int, int], list[Face]]:
        """The faces between each two patches that meet."""
        found: dict[tuple[int, int], list[Face]] = defaultdict(list)
        for triangle, cells in self.owners.items():
            for one, other in combinations(sorted(cells, key=self.patch_of.__getitem__), 2):
                if self.patch_of[one] != self.patch_of[other]:
                    found[self.patch_of[one], self.patch_of[other]].append((triangle, one))
        return found

    def clipped(self, number: int) -> list[Face]:
        """The outer faces in a contact's clip plane; none where the clip is no plane."""
        clip = self.contacts[number][1]
        flat = clip.total_degree() == 1
        return [face for face in self.outer if flat and all(clip(*p) == 0 for p in self.corners(face[0]))]

    def series(self, p: fmpq_mpoly, face: Face) -> list[fmpq_mpoly]:
        """p = p_0 + p_1 t + ..., t the barycentric coordinate across the face: the coefficients up to t^order."""
        terms: list[dict[tuple[int, ...], Any]] = [{} for _ in range(self.order + 1)]
        for (i, j, k, power), value in on_simplex(p, [*self.corners(face[0]), self.off(face)]).to_dict().items():
            if power <= self.order:
                terms[power][i, j, k, 0] = value
        return [RING.from_dict(t) for t in terms]


def _owners(cells: list[Any]) -> dict[tuple[int, ...], list[int]]:
    """The cells of each triangle."""
    owners: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for number, cell in enumerate(cells):
        for triangle in combinations(sorted(cell), 3):
            owners[triangle].append(number)
    return owners


def _homogeneous(p: Polynomial, degree: int) -> fmpq_mpoly:
    return RING.from_dict({(*e, degree - sum(e)): c for e, c in p.raw.to_dict().items()})


def _point(record: Any) -> Point:
    x, y, z = (rational(c, "coordinate") for c in record)
    return x, y, z, fmpq(1)


def _partition(record: dict[str, Any]) -> tuple[list[Point], list[Any], list[Any], Point | None]:
    """Points, cells (four point numbers each), the cells of each patch, and the centre."""
    kind, centre = record["kind"], None if record["center"] is None else _point(record["center"])
    if kind == "tetrahedra":
        return [_point(p) for p in record["vertices"]], record["cells"], record["pieces"], centre
    if kind == "six tetrahedra" and centre is not None:
        a, b, c = map(_point, record["legs"])
        points = [
            (*(centre[i] + u * a[i] + v * b[i] + w * c[i] for i in range(3)), fmpq(1)) for u, v, w in CORNERS_OF_SIX
        ]
        return points, [(0, 1, 2 + (i - 1) % 6, 2 + i) for i in range(6)], [(i,) for i in range(6)], centre
    if kind == "single cell" and "lower" not in record:
        return [], [], [()], centre
    if kind == "single cell" and centre is not None:
        ends = zip(_point(record["lower"])[:3], _point(record["upper"])[:3], strict=True)
        points = [*((*corner, fmpq(1)) for corner in product(*ends)), centre]
        sides = [[v for v in range(8) if (v >> axis) % 2 == end] for axis in range(3) for end in (0, 1)]
        return points, [(8, *side[i : i + 3]) for side in sides for i in (0, 1)], [tuple(range(12))], centre
    raise ValueError(f"there is no partition {kind!r} with centre {record['center']!r}")
