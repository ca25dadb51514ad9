"""The first mesh of a boundary: from the coarsest lattice that shows it soundly, and as finer ones do.

Cubes are halved where the boundary is not proved to be one sheet, then about the places where the mesh that they give
is not sound, until there are none and the next lattices show the same pieces, holes and faces.  That ends with a reason
where it is in vain (see `diagnostics`), or has cost many times what the first lattice did.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pas.arrays import Floats
from pas.errors import GeometryError
from pas.mesh.cleaning import FOLD, cleaned
from pas.mesh.diagnostics import Diagnosis, diagnosis
from pas.mesh.faces import BoundaryCrossings
from pas.mesh.field import FaceField, extent_of, place_of
from pas.mesh.labelled import Labelled
from pas.mesh.octree import DEEPEST, MOST_CUBES, NOWHERE, OPEN, QUIET, Octree
from pas.mesh.projection import cosines, least_norm, placing
from pas.mesh.refusals import RefusalError
from pas.mesh.rows import norms

PARTS, HALVINGS, COMPARED = 25, 9, 3
"""Small cubes along the longest side of the box in the first lattice; how many finer ones are tried at most, and how
many must show the same pieces, holes and faces, unless all of the boundary is clear."""

THIN = 0.3
"""Share of the cubes of a lattice that do not show one sheet, above which the set is thin: then surfaces are meshed one
by one, and a lattice is made finer whatever the next one shows."""

MANY = 0.01
"""Share of the cubes in which more than one sheet may be, above which a lattice is made finer without a look."""

PATIENCE, UNCLEAR = 3, 1000
"""Lattices that show no less trouble than the first of them, and cubes in which the boundary is not clear, after which
a reason is looked for why it does not come out."""

CROWDED = f"the solid is empty or too thin for its size: its lattice needs more than {MOST_CUBES} cubes"


def first_lattice(field: FaceField) -> Octree:
    """The lattice to begin with."""
    return Octree(field, extent_of(field) / PARTS)


def first_mesh(field: FaceField, tolerance: float, octree: Octree | None = None) -> Labelled:
    """The mesh of the coarsest lattice that shows all faces soundly, and as all finer ones looked at do.

    The `octree` to begin with is that of `first_lattice`, if it is known.  Raises `RefusalError` where no lattice does.
    """
    start = _cleared(field, first_lattice(field) if octree is None else octree)
    ahead, failures, reason = [_Lattice(field, start)], list[tuple[int, int]](), ""
    for _ in range(HALVINGS):
        found = _shown(ahead, tolerance)
        if isinstance(found, Labelled):
            return found
        (last, places), first = found, ahead[0].octree
        reason = last or reason
        if len(places):
            failures.append((first.count, len(places)))
            room = 3 * start.count + 30_000  # cubes that all lattices in which the boundary does not come out may have
            _check_hope(field, first, failures, room, last, places)
        if not any(len(one.crossings.edges) for one in ahead):
            ahead = [ahead[-1].refined(least=QUIET)]
        elif len(places) or len(ahead) == 1:
            ahead = [ahead[0].refined(places)]
        else:
            ahead = ahead[1:]
    if not reason:
        raise RefusalError(f"the solid is empty, or thinner everywhere than {ahead[-1].octree.finest}")
    trouble = diagnosis(field, places, ahead[0].octree.spacing)
    raise RefusalError(_sentence(trouble, ahead[-1].octree, reason))


def _cleared(field: FaceField, octree: Octree) -> Octree:
    """A lattice, refined until something of the set is seen, and the boundary is clear in most of its cubes.

    Or until no smaller share is clear in a finer one, if that is small: along a curve on which two faces are nearly
    tangent it grows from lattice to lattice.  Raises `GeometryError` where there is nothing.
    """
    while not octree.crowded and not octree.is_seen:
        if not octree.count:
            raise GeometryError("the solid is empty: its inequalities hold together nowhere")
        # Cubes above which a set of which no sample was inside counts as empty: to show it would take far more.
        most_unseen = 30_000
        if octree.count > most_unseen or octree.levels == DEEPEST:
            where = f"with a lattice of {octree.finest} nothing of it is seen"
            raise RefusalError(f"the solid is empty or too thin for its size: {where}")
        octree = octree.refined(least=QUIET)
    while not octree.crowded and octree.open_share > MANY and octree.levels < DEEPEST:
        places = octree.open_places
        found = diagnosis(field, places, octree.spacing) if len(places) > UNCLEAR else None
        if found is not None and found.stays:
            raise RefusalError(_sentence(found, octree))
        finer = octree.refined()
        # Along curves there are twice as many in the next lattice, and on surfaces that come close four times as many.
        fewer, more = 0.7 * len(octree.open_places), 3 * len(octree.open_places)
        if not finer.crowded and octree.open_share < THIN and fewer <= len(finer.open_places) <= more:
            break
        octree = finer
    if octree.crowded:
        raise RefusalError(CROWDED)
    return octree


@dataclass(frozen=True)
class _Lattice:
    """An octree and where the boundary crosses it."""

    field: FaceField
    octree: Octree

    @cached_property
    def crossings(self) -> BoundaryCrossings:
        return BoundaryCrossings(self.field, *self.octree.tetrahedra())

    def refined(self, places: Floats = NOWHERE, least: int = OPEN) -> _Lattice:
        """The next one; see `Octree.refined`."""
        return _Lattice(self.field, self.octree.refined(places, least))


def _shown(ahead: list[_Lattice], tolerance: float) -> Labelled | tuple[str, Floats]:
    """The mesh of the first of some lattices, to which finer ones are added until there are enough to compare it.

    Or why it shows no boundary that can be trusted, and the places (K, 3), if it is because of some.
    """
    field, first = ahead[0].field, ahead[0]
    if first.octree.crowded:
        raise RefusalError(CROWDED)
    raw = first.crossings.mesh()
    if not isinstance(raw, Labelled):
        return f"near {place_of(field, raw[0])} too many faces meet", raw
    while len(ahead) < COMPARED and ahead[-1].octree.open_share > 0:
        ahead.append(ahead[-1].refined())
    if ahead[-1].octree.crowded:
        raise RefusalError(CROWDED)
    others = [other.crossings for other in ahead[1:]]
    if any(first.crossings.shape != other.shape for other in others):
        return "its pieces or holes are too small", NOWHERE
    if not all(other.faces <= first.crossings.faces for other in others):
        return "its faces are too small", NOWHERE
    if not len(first.crossings.edges):
        return "", NOWHERE
    mesh = cleaned(raw, field, tolerance)
    reason, places = unsound(mesh, field, tolerance)
    return (reason, places) if reason else mesh


def _check_hope(
    field: FaceField, octree: Octree, failures: list[tuple[int, int]], most: int, reason: str, where: Floats
) -> None:
    """Raise `RefusalError` where no finer lattice is looked at: too many cubes, or no fewer faulty places.

    The cubes and the number of places of each that failed are given, the reason and places (K, 3) of the last one; all
    may have `most` cubes together.
    """
    cubes, places = zip(*failures, strict=True)
    spent = sum(cubes) > most
    if not spent and (len(failures) < PATIENCE or 2 * places[-1] <= places[-PATIENCE]):
        return
    found = diagnosis(field, where, octree.spacing)
    if spent or (found is not None and found.stays):
        raise RefusalError(_sentence(found, octree, reason))


def _sentence(found: Diagnosis | None, octree: Octree, reason: str = "") -> str:
    if found is not None and found.stays:
        return f"the solid could not be meshed: {found.sentence}"
    why = reason if found is None else found.sentence
    return f"the solid could not be meshed with a lattice of {octree.finest}: {why}"


def unsound(mesh: Labelled, field: FaceField, tolerance: float) -> tuple[str, Floats]:
    """Why the mesh cannot be trusted, or an empty string; and where (K, 3)."""
    placed, corner_off = 1e-7 * mesh.sizes, 0.5 * tolerance  # how far a vertex may be off its faces, and a corner
    folded = np.flatnonzero(cosines(mesh, field) < FOLD)
    if len(folded):
        places = mesh.points[mesh.triangles[folded]].mean(axis=1)
        return f"near {place_of(field, places[0])} it is too thin or two faces meet too flatly", places
    far = np.zeros(len(mesh.points))
    corner = mesh.topology.label_count > 2
    for vertices, functions in placing(field, mesh.topology.vertex_labels):
        steps = least_norm(field, functions, mesh.points[vertices])
        far[vertices] = norms(steps) / placed[vertices]
    vertices, labels = mesh.topology.pairs[corner[mesh.topology.pairs[:, 0]]].T
    far[corner] = 0.0  # a corner may be one only within the tolerance
    steps = least_norm(field, labels[:, None], mesh.points[vertices])
    np.maximum.at(far, vertices, norms(steps) / corner_off)
    if far.max() > 1:
        worst = int(far.argmax())
        around = mesh.topology.vertex_labels[worst]
        around = around[around >= 0]
        names = dict.fromkeys(
            f"the wall {field.face(label)}" if wall else repr(field.face(label))
            for label, wall in zip(around.tolist(), field.walls(around).tolist(), strict=True)
        )
        place = place_of(field, mesh.points[worst])
        return f"near {place} {' and '.join(names)} come close without meeting", mesh.points[far > 1]
    return "", NOWHERE
