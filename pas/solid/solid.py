"""Solids: sets of points bounded by algebraic patches, as values with set operations.

    pipe = pas.solid.cylinder((0, 0, -2), (0, 0, 2), radius="1/2")
    part = (pas.solid.ball((0, 0, 0), 1) - pipe).translate((0, 0, 1))

A solid is a tree of inequalities; nothing is approximated until it is meshed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from operator import or_
from typing import Any, NoReturn, Unpack

import numpy as np
from numpy.typing import ArrayLike

from pas.algebra.affine import Affine, AffineShape, numbered
from pas.algebra.brief import listed
from pas.algebra.inputs import check_names, points_of
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.algebra.rational import Exact, check_tolerance, rational, to_float
from pas.arrays import Bools, Floats
from pas.errors import GeometryError, meant
from pas.limits import WorkLimits, limited
from pas.mesh.closed import triangulate_faces
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.mesh.refusals import FaceMesh
from pas.registry import loaded
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape, refuse_mixed
from pas.solid.bounds import bounding_box, narrowed
from pas.solid.edge_verbs import WithEdges
from pas.solid.faces import SolidBoundary
from pas.solid.field import SolidField
from pas.solid.functions import polynomials_of
from pas.solid.joints import Joint, Known, orders, prove, verdict_list
from pas.solid.measures import Measures, curved_measures
from pas.solid.operands import Operands, combined_boundary, renamed_boundary
from pas.solid.sheets import face_mesh, merged, surface_box
from pas.solid.shell import shelled
from pas.solid.tree import Atom, Tree, atoms, combined, complement, mapped, moved
from pas.verdicts import Findings, Verdict

CARRIER_OF = "pas.exchange.step.carriers:carrier_of"
"""The function that recognises planes, cylinders and the like, in a layer below."""


@dataclass(frozen=True, eq=False)
class Solid(AffineShape["Solid"], WithEdges, Shape):
    """A closed set of points with named faces; made by the functions of `pas.solid`.

    `a | b`, `a & b` and `a - b` are union, intersection and difference.  All methods return new solids.  `joints` are
    the claims of `joined`; `verdicts` proves them.  Where `sheets` bound it, as they do solids of blends and profiles,
    it is meshed from these; what set operations make of such from their meshes; all else from a lattice.
    """

    tree: Tree
    joints: tuple[Joint, ...] = ()
    special_points: tuple[tuple[float, float, float], ...] = ()
    sheets: SolidBoundary | None = None
    known: Known | None = field(default=None, repr=False)
    _cache: dict[Any, Any] = field(default_factory=dict, repr=False, init=False)
    kind = "solid"

    def __or__(self, other: Solid) -> Solid:
        return self._with(other, union=True)

    def __and__(self, other: Solid) -> Solid:
        return self._with(other, union=False)

    def __sub__(self, other: Solid) -> Solid:
        return self._with(other, union=False, less=True)

    def __invert__(self) -> NoReturn:
        """Raises `TypeError`: what is outside a solid is unbounded, and no solid."""
        raise TypeError("~ of a solid is unbounded, and no solid; take it from a larger one, as in solid.box(...) - a")

    def _with(self, other: Solid, union: bool, less: bool = False) -> Solid:
        if not isinstance(other, Solid):
            refuse_mixed(self, other)
        tree = combined(union, self.tree, complement(other.tree) if less else other.tree)
        joints = tuple(dict.fromkeys(self.joints + other.joints))
        sheets = combined_boundary(self, other, "Add" if union else "Subtract" if less else "Intersect")
        return Solid(tree, joints, self.special_points + other.special_points, sheets)

    def _moved(self, map_: Affine) -> Solid:
        joints = tuple(joint.moved(map_) for joint in self.joints)
        points = tuple((x, y, z) for x, y, z in map_.points(np.array(self.special_points).reshape(-1, 3)).tolist())
        return Solid(moved(self.tree, map_), joints, points, self.sheets and self.sheets.moved(map_))

    def _patterned(self, maps: Sequence[Affine]) -> Solid:
        copies = enumerate((self, *map(self._moved, maps)), start=1)
        return reduce(or_, (copy._called(numbered(copy.faces, n)) for n, copy in copies))

    def cap(self, plane: PolynomialLike, name: str = "cap") -> Solid:
        """The part where `plane <= 0`, with a face of that name where it is cut.

        Where the solid already ends on that surface, its end gets the name.
        """
        polynomial = Polynomial.named(plane, "plane", constant=False)

        def rename(atom: Atom) -> Atom:
            known, is_wall = atom.function, not atom.face
            same = is_wall and isinstance(known, Polynomial) and known.primitive() == polynomial.primitive()
            return replace(atom, face=name) if same else atom

        renamed = mapped(self.tree, rename)
        if renamed == self.tree:
            renamed = combined(False, self.tree, Atom(polynomial, name))
        return replace(self, tree=renamed, sheets=None)

    @limited("hollowing out a solid", "a coarser tolerance")
    def shell(
        self, thickness: Exact, open: Sequence[str] = (), tolerance: Exact | None = None, **limits: Unpack[WorkLimits]
    ) -> Solid:
        """The solid hollowed out: its points up to `thickness` from its faces, but for the `open` ones.

        Each inner face is named "inside of ..." after the faces that it follows.  Claimed joints stay.  The thickness
        is meant to be below the faces' radii of curvature; `tolerance` is that of a mesh which helps to find distances.
        Raises `GeometryError` where nothing would be hollow, or an open face does not exist.

            solid.box((0, 0, 0), (4, 3, 2)).shell(0.1, open=["box z+"])
        """
        size = to_float(rational(thickness, "thickness"))
        if not 0 < size < np.inf:
            raise ValueError(f"thickness must be a positive number, not {thickness}")
        if isinstance(open, str):
            raise TypeError(f"open must be a sequence of names of faces, as in open=[{open!r}]")
        return replace(self, tree=shelled(self, size, open, self._tolerance(tolerance)), sheets=None)

    def renamed(self, name: str | Mapping[str, str]) -> Solid:
        """The solid with all its faces, walls included, under one name, or some under new ones; claimed joints stay.

        Raises `ValueError` for a name that is empty or no text, and `GeometryError` for a face that there is not."""
        check_names([name] if isinstance(name, str) else name.values())
        if unknown := [] if isinstance(name, str) else [face for face in name if face not in self.faces]:
            raise GeometryError(f"the solid has no face {unknown[0]!r}{meant(unknown[0], self.faces) or ''}")
        return self._called(dict.fromkeys((*self.faces, ""), name) if isinstance(name, str) else name)

    def _called(self, names: Mapping[str, str]) -> Solid:
        """The solid with other names of some faces."""
        new = {face: names.get(face, face) for face in (*self.faces, "")}
        joints = (replace(j, first=new[j.first], second=new[j.second]) for j in self.joints)
        tree = mapped(self.tree, lambda atom: replace(atom, face=new[atom.face]))
        return Solid(tree, tuple(dict.fromkeys(joints)), self.special_points, renamed_boundary(self.sheets, new))

    def joined(self, first: str, second: str, along: Sequence[PolynomialLike], order: int) -> Solid:
        """The solid with the claim that two faces meet with GC^`order` along V(g, h), `along = (g, h)`.

        The claim is proved by `verdicts`; meshes use the curve.  Raises `GeometryError` where a face does not exist.
        """
        joint = Joint(first, second, along, order)
        if unknown := [name for name in (first, second) if name not in self.faces]:
            known = ", ".join(self.faces)
            raise GeometryError(f"the solid has no face {unknown[0]!r} for the joint; its faces are {known}")
        return replace(self, joints=(*self.joints, joint))

    @property
    def faces(self) -> tuple[str, ...]:
        """The names of the faces in the order in which they were made; `mesh().names` are those that are not hidden."""
        return tuple(dict.fromkeys(atom.face for atom in atoms(self.tree) if atom.face))

    @property
    def polynomials(self) -> dict[str, tuple[Polynomial, ...]]:
        """The polynomials, negative inside, that carry each face."""
        result: dict[str, dict[Polynomial, None]] = {}
        for atom in atoms(self.tree):
            for polynomial in polynomials_of(atom.function) if atom.face else ():
                result.setdefault(atom.face, {})[-polynomial if atom.outside else polynomial] = None
        return {face: tuple(found) for face, found in result.items()}

    @cached_property
    def verdicts(self) -> tuple[Verdict, ...]:
        """The exact verdict on each claimed joint, in the order of the claims."""
        return tuple(prove(j, self.tree, lambda: self.box, self.known) for j in self.joints)

    @cached_property
    def certificate(self) -> Findings:
        """The verdicts on the claimed joints as a certificate: proved where joints are claimed and all are proved."""
        return Findings(self.verdicts)

    @property
    def proved(self) -> bool:
        """Whether joints are claimed and all of them are proved."""
        return self.certificate.proved

    def require_joints(self) -> Solid:
        """The solid itself; raises `GeometryError` for the first joint that is not proved."""
        if wrong := [verdict for verdict in self.verdicts if not verdict.proved]:
            raise GeometryError(f"joint not there: {wrong[0]}")
        return self

    @cached_property
    def box(self) -> Floats:
        """Two corners (2, 3) of a box that certainly holds the solid, a little larger than it.

        Raises `GeometryError` for an empty or unbounded solid.
        """
        return bounding_box(self.tree)

    @cached_property
    def _around(self) -> Floats:
        """Two corners (2, 3) of a box in which it is meshed: where sheets bound it that of a coarse mesh, for speed."""
        if isinstance(self.sheets, Operands) and self.sheets.box is not None:
            return self.sheets.box if self.sheets.is_union else narrowed(self.tree, self.sheets.box)
        return surface_box(self.sheets.coarse) if self.sheets and self.sheets.coarse else self.box

    @cached_property
    def field(self) -> SolidField:
        """The solid as the mesher and evaluation want it."""
        return self._field_of(self.tree)

    def _field_of(self, tree: Tree) -> SolidField:
        return SolidField(tree, self._around, orders(self.joints), np.array(self.special_points).reshape(-1, 3))

    def contains(self, points: ArrayLike) -> Bools:
        """Whether points (..., 3) are inside, shape (...).

        Points on a face count as inside, on one that a difference left as outside.
        """
        array = points_of(points)
        flat = array.reshape(-1, 3)
        evaluator, wide = self.field.evaluator, np.ptp(self._around, axis=0)
        near = ((flat >= self._around[0] - wide) & (flat <= self._around[1] + wide)).all(axis=1)
        result = np.zeros(len(flat), dtype=bool)
        result[near] = evaluator.contains(evaluator.local(flat[near]))
        return result.reshape(array.shape[:-1])

    def value(self, points: ArrayLike) -> Floats:
        """A signed field at points (..., 3), shape (...): negative inside, positive outside, 0 on the boundary.

        The polynomials of the faces combined by minimum and maximum; not a distance, and not continuous
        across walls between patches.
        """
        array = points_of(points)
        evaluator = self.field.evaluator
        return evaluator.field(evaluator.local(array.reshape(-1, 3))).reshape(array.shape[:-1])

    @limited("meshing a solid", "a coarser tolerance")
    def mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> Mesh:
        """A closed triangle mesh within `tolerance` (the model's units) of the boundary.

        Every triangle lies on one face; edges between faces on their common curve.  Where faces lie on one another,
        seen from one side, that is called "a + b"; equal names are one face.  By default the tolerance is 1e-3 of the
        longest side of the box.  Along straight lines triangles are long; with `quality` "angles" they are not, with
        "count" however long that leaves fewest.  Raises `MeshError` where it is too thin or has an unclaimed tangency,
        `GeometryError` where it is empty or unbounded.
        """
        how = Quality.of(quality)
        found = None if how is Quality.ANGLES else self._sheet_mesh(tolerance, how)
        return self.face_mesh(tolerance, quality=how).named(self.field) if found is None else merged(found, self.faces)

    def _sheet_mesh(self, tolerance: Exact | None, quality: Quality) -> Mesh | None:
        if self.sheets is None:
            return None
        if tolerance is not None:
            return self.sheets.mesh(check_tolerance(tolerance), quality)
        coarse = self.sheets.coarse  # the box takes longer
        return coarse and self.sheets.mesh(RELATIVE_TOLERANCE * float(np.ptp(coarse.box, axis=0).max()), quality)

    @limited("meshing a solid", "a coarser tolerance")
    def face_mesh(
        self, tolerance: Exact | None = None, *, quality: Quality | str = Quality.BALANCED, **limits: Unpack[WorkLimits]
    ) -> FaceMesh:
        """The mesh as the mesher makes it: labelled, in the local coordinates of `field`."""
        key = self._tolerance(tolerance), Quality.of(quality)
        if key not in self._cache:
            found = self._sheet_mesh(tolerance, key[1])
            made = self._from_lattices(*key) if found is None else face_mesh(found, self.field, *key)
            if key[1] is Quality.COUNT:  # long triangles may need more of them on coarse meshes
                made = min(made, self.face_mesh(tolerance), key=lambda found: len(found.mesh.triangles))
            self._cache[key] = made
        return self._cache[key]

    def _from_lattices(self, tolerance: float, quality: Quality) -> FaceMesh:
        self.field.refuse_coincident()
        within, known = tolerance / self.field.scale, self.sheets
        first = known.first_mesh(self.field, within) if isinstance(known, Operands) else None
        return triangulate_faces(self.field, within, quality, first)

    def _tolerance(self, tolerance: Exact | None) -> float:
        if tolerance is not None:
            check_tolerance(tolerance)  # before the box, which takes a while
        size = float(np.ptp(self._around, axis=0).max())
        return RELATIVE_TOLERANCE * size if tolerance is None else check_tolerance(tolerance, size)

    @limited("measuring a solid", "a coarser tolerance")
    def volume(self, tolerance: Exact | None = None, **limits: Unpack[WorkLimits]) -> float:
        """The volume, with an error of second order in the tolerance of its mesh, of order 3/2 on cones.

        Where `sheets` bound the solid it is that of their mesh, whose distance from them is measured.
        """
        return self.measures(tolerance).volume

    @limited("measuring a solid", "a coarser tolerance")
    def area(self, tolerance: Exact | None = None, **limits: Unpack[WorkLimits]) -> float:
        """The area of the boundary, with an error of the same order as that of the volume."""
        return self.measures(tolerance).area

    @limited("measuring a solid", "a coarser tolerance")
    def measures(self, tolerance: Exact | None = None, **limits: Unpack[WorkLimits]) -> Measures:
        """Volume, area, centre of mass and moments of inertia, with errors of the same order as that of the volume.

        They say how far they are off those of a mesh within `tolerance` (the model's units).
        """
        key = ("measures", self._tolerance(tolerance))
        if key not in self._cache:
            found = self._sheet_mesh(tolerance, Quality.BALANCED)
            faces = (atom for atom in atoms(self.tree) if atom.face)  # all that is asked about what a mesh shows
            field = self.field if found is None else self._field_of(combined(True, *faces))
            made = self.face_mesh(tolerance) if found is None else face_mesh(found, field, key[1], Quality.BALANCED)
            self._cache[key] = curved_measures(made, field).scaled(field.scale, field.world(np.zeros(3)))
        measured: Measures = self._cache[key]
        return measured

    @property
    def description(self) -> str:
        """A table of the faces with their degrees, and what each is that every CAD program knows."""
        polynomials, width = self.polynomials, max(map(len, self.faces), default=4)
        lines = [f"{'face':<{width}}  degree"]
        for face in self.faces:
            told = ((p.degree, loaded(CARRIER_OF)(p)) for p in polynomials.get(face, ()))
            kinds = sorted({f"{degree}" + (f" ({found.kind.value})" if found else "") for degree, found in told})
            lines.append(f"{face:<{width}}  {', '.join(kinds) or 'not polynomial'}")
        return "\n".join(lines)

    def __str__(self) -> str:
        return f"{self.description}\n\n{verdict_list(self.verdicts)}"

    def __repr__(self) -> str:
        return listed("<Solid with faces", self.faces)


def patch(name: str, polynomial: PolynomialLike, *region: PolynomialLike) -> Solid:
    """The set `polynomial <= 0` inside a region, each inequality of which reads `r >= 0`.

    The face `polynomial = 0` gets the name; the region's walls have none and are meant to be shared
    with other patches (what is left open ends flat).  Raises `ValueError` for a constant.
    """
    walls = [Atom(-Polynomial.named(r, f"region[{i}]", constant=False), "") for i, r in enumerate(region)]
    return Solid(combined(False, Atom(Polynomial.named(polynomial, "polynomial", constant=False), name), *walls))
