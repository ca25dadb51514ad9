"""The constants of the fit, with a reason for each: see `pas.fairing.solver`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FitSettings:
    """The constants of the fit; shares of Phi, of margins, and of the mean of the programme's diagonal."""

    lattices: tuple[int, ...] = (32, 64)
    """Subdivisions of the outer faces on whose rays members are asked; a finer one where a member is not proved."""

    margins: tuple[float, ...] = (1.0, 0.1)
    """Shares of the usual margins, in turn: members with a tenth of them exist in lower degrees."""

    rounds: int = 16
    """Programmes until a first member is clean; successes took 1 to 6."""

    steps: int = 40
    """Steps that are taken at the most, from a first member and from where rays are added."""

    trials: int = 16
    """Programmes for one step, half of which may add constraints."""

    damping: float = 1e-4
    least: float = 1e-9
    """The first damping and the least; a way does not end where the damping is more than the first, and hides what
    there is to gain."""

    slower: float = 4.0
    faster: float = 0.1
    """What the damping grows by where Phi does not fall, and shrinks to where it falls as foreseen."""

    enough: float = 3e-4
    """A step that lowers Phi by a smaller share is the last one."""

    met: float = 1e-3
    """What an inequality may lack, as a share of its margin, where a member is said to meet it; solvers leave 1e-9."""

    closer: int = 3
    """Times that rays are added where curvature is beyond the limits between those that there are."""

    hopeless: float = 1.0
    """Where more than this share of the energy is beyond the limits no more rays are added: of 84 corners and nodes one
    became fair from there, and nodes of five pipes took a sixth longer."""

    stiff: int = 4
    """Spaces with fewer unknowns for each piece are stiff: few have a fair surface, and no other margins are tried
    where the end is hopeless.  In others they are: of 60 junctions and the nodes of examples two became fair.  By the
    first member: around four pipes it had an energy of 280 with a tenth of the margins; with all it had 41 000 and
    stayed unfair, with the energy alone to begin with too."""

    loss: float = 0.0
    """The share of Phi that a step may lose to constraints that it adds (single steps of sliders only: they ask for a
    margin that the member itself has not, so that it would stay where it is)."""


SETTINGS = FitSettings()
LIVE = FitSettings(lattices=(16,), margins=(0.1,), enough=0.0, loss=0.01, faster=1 / 3)
"""For single steps of sliders: damping shrinks as in Nielsen's rule, so that what they hardly move goes slowly."""
