"""The certificate of a piecewise surface: the claims about it, and the outcomes of their proofs.

Places are given in the surface's local coordinates, and told in those of its user.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pas.algebra.brief import brief
from pas.algebra.inputs import shown_point
from pas.arrays import Floats
from pas.bernstein.signs import SignResult
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Status, Verdict, Verdicts


@dataclass(frozen=True)
class Certificate(Verdicts):
    """All verdicts about one surface.

    `contacts`: one for each contact: exact GC^k, alpha > 0 on its curve, the curve closed and
    regular inside its clip face (or inside the region, where the clip is none of its faces).
    `faces`: one for each interior face: exact C^k.  `one_sheet`: every ray from the centre meets
    the surface at most once, transversally.  `enclosed`: the surface leaves the region through the
    contact curves only.  `further`: the verdicts on the claims in `pas.certify.proofs.CLAIMS`.
    """

    contacts: tuple[Verdict, ...]
    faces: tuple[Verdict, ...]
    one_sheet: Verdict
    enclosed: Verdict
    further: tuple[Verdict, ...] = ()

    __repr__ = brief

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        return (*self.contacts, *self.faces, self.one_sheet, self.enclosed, *self.further)

    def __str__(self) -> str:
        width = max(len(verdict.claim) for verdict in self.verdicts)
        lines = []
        for verdict in self.verdicts:
            at = "" if verdict.witness is None else f" at {shown_point(verdict.witness, 5)}"
            lines.append(f"{verdict.claim:<{width}}  {verdict.status.value:<9} {verdict.reason}{at}")
        return "\n".join(lines)

    def to_record(self) -> dict[str, Any]:
        """A JSON-ready form; `further` only where there is something."""
        told = {name: found for name, found in vars(self).items() if name != "further" or found}
        return {n: f.to_record() if isinstance(f, Verdict) else [v.to_record() for v in f] for n, f in told.items()}

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Certificate:
        """The certificate that `to_record` wrote."""
        contacts, faces, further = (
            tuple(map(Verdict.from_record, record.get(key, ()))) for key in ("contacts", "faces", "further")
        )
        one_sheet, enclosed = (Verdict.from_record(record[key]) for key in ("one_sheet", "enclosed"))
        return cls(contacts, faces, one_sheet, enclosed, further)


@dataclass(frozen=True)
class Proposition:
    """A claim about a surface, in words."""

    surface: PiecewisePolynomial
    words: str

    def proved(self, reason: str, measure: int = 0) -> Verdict:
        """The verdict that it holds; `measure` counts the simplices that were examined."""
        return Verdict(Status.PROVED, self.words, reason, measure=measure)

    def undecided(self, reason: str) -> Verdict:
        """The verdict that it is open."""
        return Verdict(Status.UNDECIDED, self.words, reason)

    def refuted(self, reason: str, place: Floats | None = None, measure: int = 0) -> Verdict:
        """The verdict that it fails, at a place (3,) if there is one."""
        return Verdict(
            Status.REFUTED,
            self.words,
            reason,
            None if place is None else self.surface.partition.frame.place(place),
            measure,
        )

    def unmet(self, achieved: int, place: Floats | None, measure: int = 0) -> Verdict:
        """The verdict that a patch is met with a lower order only (-1 for none), at a place (3,) if one is found."""
        ideal = f"f is not in <f_i, h_i^{self.surface.order + 1}>"
        if place is None:
            return self.undecided(f"{ideal}, and no point of the curve was found where it matters")
        met = "does not meet the contact at all" if achieved < 0 else f"meets it with GC^{achieved} only"
        return self.refuted(f"the patch {met}: {ideal}", place, measure)

    def failed(self, signs: SignResult, reason: str) -> Verdict | None:
        """The verdict of a proof of signs that did not succeed, None where it did; `reason` says what is wrong where it
        is refuted."""
        if signs.status is Status.PROVED:
            return None
        if signs.witness is not None:
            return self.refuted(reason, signs.witness, signs.examined)
        around = shown_point(self.surface.partition.frame.place(signs.undecided[0]))
        place = f"{len(signs.undecided)} simplices undecided, one around {around}"
        said = f"open whether {reason}: {place}"
        return Verdict(Status.UNDECIDED, self.words, said, measure=signs.examined)

    def settled(self, signs: SignResult, wrong: str, right: str) -> Verdict:
        """The verdict of a proof of signs, whose reason is `right` where it is proved; see `failed`."""
        failed = self.failed(signs, wrong)
        return self.proved(right, signs.examined) if failed is None else failed
