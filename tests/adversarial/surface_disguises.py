"""The same surface in other words: whatever holds of it holds of its disguise.

Coefficients are multiplied by numbers of any size, everything is moved by an affine map, vertices,
cells and pieces get other numbers, and the degree in which it is written is raised.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

from adversarial.exact_checks import Point, exact
from adversarial.surface_bases import Known, with_patches

from pas import Contact, Partition, PiecewiseSurface, Polynomial
from pas.algebra.inputs import HIGHEST_SURFACE_DEGREE

VARIABLES = tuple(map(Polynomial, "xyz"))


def disguised(known: Known, random: Random) -> Known:
    """The same surface in other words: moved, scaled, sheared, coefficients times a number, renumbered."""
    f = known.surface
    story = []
    if random.random() < 0.4:
        c = extreme(random)
        f = with_patches(f, [c * p for p in f.patches])
        story.append(f"coefficients times {float(c):.3g}")
    if random.random() < 0.5:
        f = moved(f, *motion(random))
        story.append("moved")
    if random.random() < 0.4:
        f, order = renumbered(f, random)
        story.append("renumbered")
        faces = tuple(known.faces[i] for i in order)
        known = known.but(f, "", faces=faces)
    if random.random() < 0.2:
        degree = min(f.degree + random.randint(1, 2), HIGHEST_SURFACE_DEGREE)
        f = PiecewiseSurface(f.partition, f.contacts, f.order, f.patches, degree)
        story.append(f"written in degree {f.degree}")
    return known.but(f, ", ".join(story)) if story else known


def motion(random: Random) -> tuple[list[list[Fraction]], Point]:
    """A linear map and an offset: of any size, turned, sheared or far away."""
    kind = random.randrange(4)
    one, nil = Fraction(1), Fraction(0)
    unit = [[one, nil, nil], [nil, one, nil], [nil, nil, one]]
    if kind == 0:
        s = Fraction(10) ** random.choice((-30, -7, 5, 30))
        return [[s * c for c in row] for row in unit], (nil, nil, nil)
    if kind == 1:
        return unit, tuple(Fraction(random.randint(-(10**6), 10**6)) for _ in range(3))
    if kind == 2:  # a rational rotation
        a, b = Fraction(3, 5), Fraction(4, 5)
        return [[a, -b, nil], [a * b, a * a, -b], [b * b, a * b, a]], (one / 3, nil, nil)
    shear = Fraction(random.randint(-3, 3), 4)
    return [[one, shear, nil], [nil, one, -shear], [nil, nil, Fraction(3, 2)]], (nil, one, nil)


def moved(surface: PiecewiseSurface, matrix: list[list[Fraction]], offset: Point) -> PiecewiseSurface:
    """The image of a surface, its region and its contacts under an affine map."""
    old = surface.partition
    image = [_image(matrix, offset, exact(v)) for v in old.vertices]
    center = None if old.center is None else _image(matrix, offset, exact(old.center))
    partition = Partition(image, old.cells, center, old.pieces)
    inverse = _inverse(matrix)
    back = [sum((inverse[i][j] * (VARIABLES[j] - offset[j]) for j in range(3)), Polynomial(0)) for i in range(3)]
    contacts = [Contact(c.surface.compose(*back), c.clip.compose(*back)) for c in surface.contacts]
    polynomials = [p.compose(*back) for p in surface.polynomials]
    return PiecewiseSurface.from_polynomials(partition, contacts, surface.order, polynomials)


def renumbered(surface: PiecewiseSurface, random: Random) -> tuple[PiecewiseSurface, list[int]]:
    """The same surface with other numbers of vertices, cells and pieces, and where each face was before."""
    old = surface.partition
    vertices, cells, pieces = (random.sample(range(n), n) for n in (len(old.vertices), len(old.cells), len(old.pieces)))
    new_vertex = {v: i for i, v in enumerate(vertices)}
    new_cell = {c: i for i, c in enumerate(cells)}
    shuffled = [random.sample([new_vertex[v] for v in old.cells[c]], 4) for c in cells]
    groups = [[new_cell[c] for c in old.pieces[p]] for p in pieces]
    partition = Partition([old.vertices[v] for v in vertices], shuffled, old.center, groups)
    changed = PiecewiseSurface.from_polynomials(
        partition, surface.contacts, surface.order, [surface.polynomials[p] for p in pieces]
    )
    before = {_face_key(f, None): i for i, f in enumerate(old.interior_faces)}
    return changed, [before[_face_key(f, pieces)] for f in partition.interior_faces]


def _face_key(face, pieces: list[int] | None) -> tuple:
    numbers = (face.first, face.second) if pieces is None else (pieces[face.first], pieces[face.second])
    return frozenset(numbers), face.plane.primitive()


def extreme(random: Random) -> Fraction:
    """A positive factor of any size."""
    return Fraction(random.randint(1, 9), random.randint(1, 9)) * Fraction(10) ** random.choice((-300, -30, 0, 30, 300))


def _image(matrix: list[list[Fraction]], offset: Point, p: Point) -> Point:
    return tuple(sum((m * c for m, c in zip(row, p, strict=True)), o) for row, o in zip(matrix, offset, strict=True))


def _inverse(m: list[list[Fraction]]) -> list[list[Fraction]]:
    a, b, c = m
    det = sum(a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]) for i in range(3))

    def minor(i: int, j: int) -> Fraction:
        return (
            m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
            - m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3]
        )

    return [[minor(j, i) / det for j in range(3)] for i in range(3)]
