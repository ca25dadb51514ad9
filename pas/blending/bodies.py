"""Blends as solids: the inside of the surface with pieces of its neighbours, capped.

The surface's pieces are one face, bounded by the cells of the partition; each neighbour goes on from its
clip and ends in a flat cap.  The claims of contact become joints, which the solid proves anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import fmpq

from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import exact, rational
from pas.errors import GeometryError
from pas.solid.pieces import Pieces, region
from pas.solid.solid import Solid, patch, union
from pas.solid.tree import Atom, combined
from pas.surface.contact import Contact
from pas.surface.piecewise import PiecewiseSurface


def body(surface: PiecewiseSurface, length: Any = None, names: Sequence[str] | None = None) -> Solid:
    """The solid inside a surface and its neighbours; see `Blend.solid`."""
    if not surface.partition.cells:
        raise GeometryError("the blend has no region, so it bounds no solid: give its cell one, as in SingleCell(box)")
    titles = _names(names, len(surface.contacts))
    pieces = Pieces(surface.partition, surface.polynomials)
    inner = Solid(combined(False, Atom(pieces, "blend"), region(surface.partition)))
    reach = _length(length, surface)
    caps = [_cap(contact, number, reach) for number, contact in enumerate(surface.contacts)]
    ends = [
        patch(name, contact.surface, contact.clip, -cap).cap(cap, f"{name} end")
        for name, contact, cap in zip(titles, surface.contacts, caps, strict=True)
        if reach > 0
    ]
    solid = union([inner, *ends])
    for name, contact in zip(titles, surface.contacts, strict=True):
        if reach > 0:
            solid = solid.joined("blend", name, (contact.surface, contact.clip), surface.order)
        else:
            solid = solid.cap(contact.clip, f"{name} end")
    return solid


def _cap(contact: Contact, number: int, length: fmpq) -> Polynomial:
    """The plane at a distance of `length` beyond the clip, rounded to a double where that is irrational."""
    if contact.clip.degree != 1:
        raise GeometryError(
            f"neighbour {number + 1} ends in {contact.clip} = 0, which is no plane, so it has no flat cap; "
            "compose the solid with pas.solid.patch instead"
        )
    size = exact(float(np.linalg.norm(contact.clip.dense(1)[1:])))
    return contact.clip - Polynomial(length * size)


def _length(length: Any, surface: PiecewiseSurface) -> fmpq:
    """The neighbours' length: by default half of the region's scale."""
    if length is None:
        return surface.partition.frame.scale / 2
    number = rational(length, "length")
    if number < 0:
        raise ValueError(f"length must not be negative, not {length!r}")
    return number


def _names(names: Sequence[str] | None, size: int) -> tuple[str, ...]:
    if names is None:
        return tuple(f"neighbour {i + 1}" for i in range(size))
    if isinstance(names, str) or len(names) != size or len({*names, "blend"}) != size + 1:
        raise ValueError(
            f"names must be {size} different names for the neighbours, none of them 'blend'; they are {names!r}"
        )
    return tuple(map(str, names))
