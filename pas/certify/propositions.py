"""Claims about a surface, and the verdicts that proofs come to; places are in the surface's local coordinates."""

from __future__ import annotations

from dataclasses import dataclass

from pas.algebra.monomials import Floats
from pas.bernstein.signs import SignResult
from pas.surface.function import PiecewisePolynomial
from pas.verdicts import Point, Status, Verdict


@dataclass(frozen=True)
class Proposition:
    """What is claimed of a surface, in words."""

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
        return Verdict(Status.REFUTED, self.words, reason, None if place is None else self._point(place), measure)

    def failed(self, signs: SignResult, reason: str) -> Verdict | None:
        """The verdict of a proof of signs that did not succeed, None where it did; `reason` says what is wrong where it
        is refuted."""
        if signs.status is Status.PROVED:
            return None
        if signs.witness is not None:
            return self.refuted(reason, signs.witness, signs.examined)
        x, y, z = self._point(signs.undecided[0])
        place = f"{len(signs.undecided)} simplices undecided, one around ({x:.4g}, {y:.4g}, {z:.4g})"
        said = f"open whether {reason}: {place}"
        return Verdict(Status.UNDECIDED, self.words, said, measure=signs.examined)

    def settled(self, signs: SignResult, wrong: str, right: str) -> Verdict:
        """The verdict of a proof of signs, whose reason is `right` where it is proved; see `failed`."""
        failed = self.failed(signs, wrong)
        return self.proved(right, signs.examined) if failed is None else failed

    def _point(self, place: Floats) -> Point:
        x, y, z = self.surface.partition.frame.global_points(place).tolist()
        return x, y, z
