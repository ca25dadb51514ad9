"""The ends of a blend at its contacts, in doubles, as a flange, a drawing or the next part needs them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pas.algebra.lengths import unit
from pas.algebra.rational import VectorLike, three, to_floats, vector
from pas.arrays import Floats
from pas.contacts.contact import ContactLike, as_contact

Triple = tuple[float, float, float]

FAR, SLENDER = 8.0, 10.0
"""A clip that is so many times the largest radius from the centre is unusual, and so are radii in such a ratio: two
pipes of one radius whose directions are 24 degrees apart end 8 times as far."""


@dataclass(frozen=True)
class ContactEnd:
    """The closed curve in which a blend ends at a contact, in the model's units.

    `center` (3,) is its centre in its plane, `direction` (3,) the unit normal of the plane away from the blend, `radii`
    the least and the largest distance of the curve from its centre, `distance` that of the centre from the node's
    (`surface.partition.center`); None where there is none.  `inner_radii` are those of the cavity of a hollow blend,
    else None.
    """

    center: Triple
    direction: Triple
    radii: tuple[float, float]
    distance: float | None = None
    inner_radii: tuple[float, float] | None = None

    @classmethod
    def of(cls, contact: ContactLike, center: VectorLike | None = None) -> ContactEnd:
        """The end at a contact with a clip, such as a pipe, around the `center` (3,) of a node.

        Raises `GeometryError` where the contact has no closed plane curve.
        """
        rim = as_contact(contact).rim
        place, normal = np.array(to_floats(rim.center)), unit(to_floats(rim.normal))
        if center is None:
            return cls(triple(place), triple(normal), rim.radii)
        away = place - to_floats(vector(center, "center"))
        outward = normal if away @ normal >= 0 else -normal
        return cls(triple(place), triple(outward), rim.radii, float(np.linalg.norm(away)))

    @property
    def radius(self) -> float | None:
        """The radius where the curve is round, else None."""
        return _round(self.radii)

    @property
    def inner_radius(self) -> float | None:
        """The radius of the cavity where there is one that is round, else None."""
        return None if self.inner_radii is None else _round(self.inner_radii)


def unusual(ends: Sequence[ContactEnd]) -> list[str]:
    """A sentence for each thing about the ends of a node that few nodes have, and what to do about it."""
    widths = [end.radii[1] for end in ends]
    found = []
    far, number = max(((end.distance or 0.0, i) for i, end in enumerate(ends, start=1)), default=(0.0, 0))
    if far > FAR * max(widths, default=0.0):
        found.append(
            f"contact {number} ends {far:.4g} from the centre, {far / max(widths):.3g} times the largest radius: "
            "give it a nearer clip, or let directions be further apart"
        )
    if widths and max(widths) > SLENDER * min(widths):
        thin, wide = (widths.index(pick(widths)) + 1 for pick in (min, max))
        found.append(
            f"contact {wide} is {max(widths) / min(widths):.3g} times as wide as contact {thin}: blend contact {thin} "
            f"with the wall of contact {wide} alone (see pas.Opening), which needs no ends along the wide one"
        )
    return found


def _round(radii: tuple[float, float]) -> float | None:
    rounding = 1e-9  # share of its radius within which a curve counts as round: rounding alone is far below
    least, largest = radii
    return largest if largest - least <= rounding * largest else None


def triple(vector: Floats) -> Triple:
    """The coordinates of a vector (3,)."""
    return three(map(float, vector))
