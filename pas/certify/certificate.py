"""The certificate of a piecewise surface: what was promised of it, and what the proofs came to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pas.algebra.brief import brief
from pas.verdicts import Verdict, Verdicts


@dataclass(frozen=True)
class Certificate(Verdicts):
    """All verdicts about one surface.

    `contacts`: one for each contact: exact GC^k, alpha > 0 on its curve, the curve closed and
    regular inside its clip face (or inside the region, where the clip is none of its faces).
    `faces`: one for each interior face: exact C^k.  `one_sheet`: every ray from the centre meets
    the surface at most once, transversally.  `enclosed`: the surface leaves the region through the
    contact curves only.  `further`: what the claims of `pas.certify.proofs.CLAIMS` came to.
    """

    contacts: tuple[Verdict, ...]
    faces: tuple[Verdict, ...]
    one_sheet: Verdict
    enclosed: Verdict
    further: tuple[Verdict, ...] = ()

    __repr__ = brief

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """All verdicts in the order of proof."""
        return (*self.contacts, *self.faces, self.one_sheet, self.enclosed, *self.further)

    def __str__(self) -> str:
        width = max(len(verdict.claim) for verdict in self.verdicts)
        lines = []
        for verdict in self.verdicts:
            at = ""
            if verdict.witness is not None:
                at = " at ({:.5g}, {:.5g}, {:.5g})".format(*verdict.witness)
            lines.append(f"{verdict.claim:<{width}}  {verdict.status.value:<9} {verdict.reason}{at}")
        return "\n".join(lines)

    def to_record(self) -> dict[str, Any]:
        """A JSON-ready form; `further` only where there is something."""
        record = {
            "contacts": [v.to_record() for v in self.contacts],
            "faces": [v.to_record() for v in self.faces],
            "one_sheet": self.one_sheet.to_record(),
            "enclosed": self.enclosed.to_record(),
        }
        return record | ({"further": [v.to_record() for v in self.further]} if self.further else {})

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Certificate:
        """The certificate that `to_record` wrote."""
        return cls(
            tuple(Verdict.from_record(v) for v in record["contacts"]),
            tuple(Verdict.from_record(v) for v in record["faces"]),
            Verdict.from_record(record["one_sheet"]),
            Verdict.from_record(record["enclosed"]),
            tuple(Verdict.from_record(v) for v in record.get("further", ())),
        )
