"""The part list of a solid: its faces with degrees, its joints with verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pas.solid.solid import Solid


def face_list(solid: Solid) -> str:
    """A table of the faces with their degrees."""
    polynomials = solid.polynomials
    width = max(map(len, solid.faces), default=4)
    lines = [f"{'face':<{width}}  degree"]
    for face in solid.faces:
        degrees = sorted({p.degree for p in polynomials.get(face, ())})
        lines.append(f"{face:<{width}}  {', '.join(map(str, degrees)) or 'not polynomial'}")
    return "\n".join(lines)


def part_list(solid: Solid) -> str:
    """A table of faces and joints; says so where no joint was claimed."""
    lines = [face_list(solid), ""]
    if not solid.joints:
        return "\n".join([*lines, "joints: none claimed, none proved"])
    proved = sum(v.proved for v in solid.verdicts)
    lines.append(f"joints: {proved} of {len(solid.joints)} proved")
    claims = max(len(v.claim) for v in solid.verdicts)
    lines += [f"  {v.claim:<{claims}}  {v.status.value:<9}  {v.reason}" for v in solid.verdicts]
    return "\n".join(lines)
