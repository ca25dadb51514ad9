"""The first mesh of a boundary: from the coarsest lattice that shows it soundly, and as finer ones do.

The lattice is refined where the boundary is not proved to be one sheet, then where the mesh does not come out.  That
ends with a reason where it is in vain (see `trouble`), or has cost many times what the first lattice did.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pas.errors import MeshError
from pas.mesh.cleaning import FOLD, cleaned
from pas.mesh.faces import BoundaryCrossings
from pas.mesh.field import FaceField, place_of
from pas.mesh.labelled import Labelled
from pas.mesh.nodes import Known
from pas.mesh.octree import DEEPEST, NOWHERE, QUIET, Octree
from pas.mesh.projection import cosines, least_norm, placing
from pas.mesh.rows import Floats, norms
from pas.mesh.trouble import Trouble, find_trouble

FIRST_PARTS, OTHER_PARTS, HALVINGS, COMPARED = 25, 27, 9, 3
"""Small cubes along the longest side of the box in the first lattice, and in another one that is tried; how many finer
ones are tried at most, and how many must show the same pieces, holes and faces, unless all of the boundary is clear."""

MANY = 0.01
"""Share of the cubes in which more than one sheet may be, above which a lattice is made finer without a look."""

ALONG_CURVES = 0.03
"""Such a share that is no smaller in a finer lattice is left for a look."""

PATIENCE, UNCLEAR = 3, 4000
"""Lattices that show no less trouble than the first of them, and cubes in which the boundary is not clear, after which
a reason is looked for why it does not come out."""

SUPERFLUOUS = 3
"""Lattices in which a boundary does not come out, after which it is tried without functions that others imply."""

FEW = 0.002
"""Number of places, over that of the cubes, below which the lattice is made finer twice there: another look takes more
time than more cubes."""

ROOM, TIMES = 30_000, 3
"""Cubes, and times the first lattice's, that all lattices together may have in which the boundary does not come out."""

ON_FACE = 1e-7
"""Distance from its faces, over the length of its edges, up to which a vertex counts as placed."""

CORNER = 0.5
"""How far a corner may be off each of its faces, over the tolerance."""


def first_mesh(field: FaceField, tolerance: float, octree: Octree | None = None, even: bool = False) -> Labelled:
    """The mesh of the coarsest lattice that shows all faces soundly, and as all finer ones looked at do.

    The `octree` to begin with is that of `first_lattice`, if it is known.  An `even` mesh has triangles about as
    large as the lattice's cubes, on planes as well.  Where the boundary does not come out of one lattice another
    is tried: its planes may lie unluckily.
    """
    start = first_lattice(field) if octree is None else octree
    try:
        return _first_mesh(field, tolerance, start, even)
    except _InVainError as refusal:
        if field.needed() is not field:
            raise
        try:
            return _first_mesh(field, tolerance, first_lattice(field, OTHER_PARTS), even)
        except MeshError:
            raise MeshError(str(refusal)) from None


def _first_mesh(field: FaceField, tolerance: float, octree: Octree, even: bool) -> Labelled:
    octree, known = _resolved(field, octree), Known()
    ahead, effort = [_Lattice(field, octree, known)], _Effort(field, TIMES * octree.count + ROOM)
    reason = ""
    for _ in range(HALVINGS):
        first, places = ahead[0].crossings, NOWHERE
        raw = first.mesh()
        if not isinstance(raw, Labelled):
            reason, places = f"near {place_of(field, raw[0])} too many faces meet", raw
        else:
            while len(ahead) < COMPARED and ahead[-1].octree.open_share > 0:
                ahead.append(_Lattice(field, ahead[-1].octree.refined(), known))
            if any(first.shape != other.crossings.shape for other in ahead[1:]):
                reason = "its pieces or holes are too small"
            elif not all(first.shows_faces_of(other.crossings) for other in ahead[1:]):
                reason = "its faces are too small"
            elif len(first.edges):
                mesh = cleaned(raw, field, tolerance, even)
                reason, places = unsound(mesh, field, tolerance)
                if not reason:
                    return mesh
        if len(places):
            effort.failed(ahead[0].octree, places, reason)
        if not any(len(one.crossings.edges) for one in ahead):
            ahead = [_Lattice(field, ahead[-1].octree.refined(least=QUIET), known)]
        elif len(places) or len(ahead) == 1:
            finer = ahead[0].octree.refined(places)
            twice = len(places) < FEW * ahead[0].octree.count
            ahead = [_Lattice(field, finer.refined(places) if twice else finer, known)]
        else:
            ahead = ahead[1:]
    if not reason:
        raise MeshError(f"the solid is empty, or thinner everywhere than {ahead[-1].octree.finest}")
    raise _refusal(find_trouble(field, places, ahead[0].octree.spacing), ahead[-1].octree, reason)


def first_lattice(field: FaceField, parts: int = FIRST_PARTS) -> Octree:
    """The lattice to begin with."""
    return Octree(field, float(np.ptp(field.box, axis=0).max()) / parts)


class _InVainError(MeshError):
    """That finer lattices of the same kind show no less trouble."""


def _resolved(field: FaceField, octree: Octree) -> Octree:
    """A lattice, refined until the boundary is clear in most of its cubes.

    Or until no smaller share is clear in a finer one, if that is small: along a curve on which two faces are nearly
    tangent it grows from lattice to lattice.
    """
    octree = octree.until_seen()
    while octree.open_share > MANY and octree.levels < DEEPEST:
        places = octree.open_places
        found = find_trouble(field, places, octree.spacing) if len(places) > UNCLEAR else None
        if found is not None and found.stays:
            raise _refusal(found, octree)
        finer = octree.refined()
        if octree.open_share < ALONG_CURVES and finer.open_share >= octree.open_share:
            break
        octree = finer
    return octree


@dataclass
class _Effort:
    """What was spent on places where the boundary did not come out.

    `most` cubes may be, in all lattices; `bad` counts the places in each of them.
    """

    field: FaceField
    most: int
    cubes: int = 0
    bad: tuple[int, ...] = ()

    def failed(self, octree: Octree, places: Floats, reason: str) -> None:
        """Count a lattice; raises `MeshError` where finer ones are in vain, or too much was spent."""
        self.cubes += octree.count
        self.bad = (*self.bad, len(places))[-PATIENCE:]
        if len(self.bad) == SUPERFLUOUS and self.field.needed() is not self.field:
            raise _InVainError(str(_refusal(find_trouble(self.field, places, octree.spacing), octree, reason)))
        spent = self.cubes > self.most
        if spent or (len(self.bad) == PATIENCE and 2 * self.bad[-1] > self.bad[0]):
            found = find_trouble(self.field, places, octree.spacing)
            if spent or (found is not None and found.stays):
                refusal = _refusal(found, octree, reason)
                raise refusal if spent else _InVainError(str(refusal))


def _refusal(found: Trouble | None, octree: Octree, reason: str = "") -> MeshError:
    if found is not None and found.stays:
        return MeshError(f"the solid could not be meshed: {found.sentence}")
    why = reason if found is None else found.sentence
    return MeshError(f"the solid could not be meshed with a lattice of {octree.finest}: {why}")


@dataclass(frozen=True)
class _Lattice:
    """An octree and where the boundary crosses it; and what is known of nodes from other octrees."""

    field: FaceField
    octree: Octree
    known: Known

    @cached_property
    def crossings(self) -> BoundaryCrossings:
        return BoundaryCrossings(self.field, *self.octree.tetrahedra(), self.known)


def unsound(mesh: Labelled, field: FaceField, tolerance: float) -> tuple[str, Floats]:
    """Why the mesh cannot be trusted, or an empty string; and where (K, 3)."""
    folded = np.flatnonzero(cosines(mesh, field) < FOLD)
    if len(folded):
        places = mesh.points[mesh.triangles[folded]].mean(axis=1)
        return f"near {place_of(field, places[0])} it is too thin or two faces meet too flatly", places
    far = np.zeros(len(mesh.points))
    corner = mesh.topology.label_count > 2
    for vertices, functions in placing(field, mesh.topology.vertex_labels):
        steps = least_norm(field, functions, mesh.points[vertices])
        far[vertices] = norms(steps) / (ON_FACE * mesh.sizes[vertices])
    vertices, labels = mesh.topology.pairs[corner[mesh.topology.pairs[:, 0]]].T
    far[corner] = 0.0  # a corner may be one only within the tolerance
    steps = least_norm(field, labels[:, None], mesh.points[vertices])
    np.maximum.at(far, vertices, norms(steps) / (CORNER * tolerance))
    if far.max() > 1:
        worst = int(far.argmax())
        around = mesh.topology.vertex_labels[worst]
        names = dict.fromkeys(repr(field.face(label)) for label in around[around >= 0].tolist())
        place = place_of(field, mesh.points[worst])
        return f"near {place} {' and '.join(names)} come close without meeting", mesh.points[far > 1]
    return "", NOWHERE
