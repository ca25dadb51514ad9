"""Joints: claims that two faces of a solid continue each other with GC^k along a curve; part lists tell them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from pas.algebra.brief import brief
from pas.algebra.inputs import check_order
from pas.algebra.polynomial import Polynomial, PolynomialLike
from pas.errors import GeometryError
from pas.verdicts import Verdict


@dataclass(frozen=True)
class Joint:
    """The claim that two faces, by name, meet with GC^`order` along the curve V(g, h)."""

    first: str
    second: str
    along: tuple[Polynomial, Polynomial]
    order: int

    __repr__ = brief

    def __init__(self, first: str, second: str, along: Sequence[PolynomialLike], order: int) -> None:
        if not isinstance(along, Sequence) or isinstance(along, str) or len(along) != 2:
            raise TypeError(f"along must be the two polynomials (g, h) of the joint's curve, not {along!r}")
        g, h = Polynomial(along[0]), Polynomial(along[1])
        common = g.raw.gcd(h.raw)
        if g.is_zero or h.is_zero or not common.is_constant():
            raise ValueError(
                f"along must be two polynomials whose surfaces meet in curves; {g} and {h} share a surface"
            )
        object.__setattr__(self, "first", first)
        object.__setattr__(self, "second", second)
        object.__setattr__(self, "along", (g, h))
        object.__setattr__(self, "order", check_order(order))

    @property
    def claim(self) -> str:
        """What is to be proved, in words."""
        return f"{self.first} meets {self.second} with GC^{self.order}"


def refuse_unknown(joint: Joint, faces: Sequence[str]) -> None:
    """Raise `GeometryError` where a joint names a face that the solid does not have."""
    for name in (joint.first, joint.second):
        if name not in faces:
            raise GeometryError(f"the solid has no face {name!r} for the joint; its faces are {', '.join(faces)}")


class Jointed(Protocol):
    """A solid as part lists tell it."""

    @property
    def faces(self) -> tuple[str, ...]:
        """The names of the faces."""

    @property
    def polynomials(self) -> dict[str, tuple[Polynomial, ...]]:
        """The polynomials that carry each face."""

    @property
    def joints(self) -> tuple[Joint, ...]:
        """What is claimed."""

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """What of that is proved."""


def face_list(solid: Jointed) -> str:
    """A table of the faces with their degrees."""
    polynomials = solid.polynomials
    width = max(map(len, solid.faces), default=4)
    lines = [f"{'face':<{width}}  degree"]
    for face in solid.faces:
        degrees = sorted({p.degree for p in polynomials.get(face, ())})
        lines.append(f"{face:<{width}}  {', '.join(map(str, degrees)) or 'not polynomial'}")
    return "\n".join(lines)


def part_list(solid: Jointed) -> str:
    """A table of faces and joints; says so where no joint was claimed."""
    lines = [face_list(solid), ""]
    if not solid.joints:
        return "\n".join([*lines, "joints: none claimed, none proved"])
    proved = sum(v.proved for v in solid.verdicts)
    lines.append(f"joints: {proved} of {len(solid.joints)} proved")
    claims = max(len(v.claim) for v in solid.verdicts)
    lines += [f"  {v.claim:<{claims}}  {v.status.value:<9}  {v.reason}" for v in solid.verdicts]
    return "\n".join(lines)
