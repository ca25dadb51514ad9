"""A solution space prepared for the fit: its working basis, sampled constraints and rays, which no energy changes.

`FitSettings` are the constants of the fit, with a reason for each: see `pas.fairing.solver`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import _lru_cache_wrapper, cached_property, lru_cache

import numpy as np
from flint import fmpq_mat

from pas.algebra.matrices import Products
from pas.algebra.polynomial import Polynomial
from pas.arrays import Floats
from pas.fairing.basis import WorkingBasis
from pas.fairing.constraints import Inequalities, Margins, RayLattice, SampledConstraints
from pas.fairing.energy import Energy, as_energy
from pas.piecewise import PiecewiseSurface
from pas.surface.placed import PlacedContacts

SLIM = 0.1
"""The least share of the usual margins that is asked for: members with it exist in lower degrees."""


class PreparedSpace:
    """The members of one solution space in floating point, and the way back to exact surfaces.

    `source` holds the members' patches (m, C(n+3, 3)) in local coordinates, exact.
    """

    def __init__(self, placed: PlacedContacts, degree: int, source: Products) -> None:
        self.placed, self.partition, self.degree = placed, placed.partition, degree
        if not placed.partition.cells:
            raise ValueError(
                "a choice by shape needs a region: give the cell a box, as in pas.SingleCell(lower, upper)"
            )
        self.basis = WorkingBasis.of(placed.partition, source, degree)

    @cached_property
    def guard(self) -> SampledConstraints:
        """The sampled constraints of this space; raises `ValueError` where a clip is on no side of the region."""
        for number, join in enumerate(self.placed.joins, start=1):
            if not join.confined:
                what = (
                    f"the clip of contact {number} passes through the region"
                    if join.faces
                    else f"no side of the region lies in the clip plane of contact {number}"
                )
                raise ValueError(
                    f"{what}, so the surface can be neither guarded nor proved there: fit with prove=False, "
                    "guard=False and another normalisation than pas.MeanAlpha(), or give the region such a side"
                )
        return SampledConstraints(self.basis, self.placed)

    @cached_property
    def rays(self) -> _lru_cache_wrapper[RayLattice]:
        """The rays to the lattice of so many subdivisions on the outer faces; made once."""
        return lru_cache(maxsize=4)(lambda subdivisions: RayLattice(self.guard, subdivisions))

    def forget(self) -> None:
        """Let go of what is kept for lattices of points, some 30 MB, as many blends are held at once; made again."""
        self.rays.cache_clear()
        if "guard" in vars(self):
            self.guard.edges.cache_clear()

    @cached_property
    def thin_plate(self) -> Floats:
        """The quadratic form that choices begin with; see `form`."""
        return self.form(as_energy(None))

    @cached_property
    def sobolev_gram(self) -> Floats:
        """The Gram matrix (m, m) of products of values and of second derivatives over the region, in local units, as in
        the Sobolev space H^2: by it steps are damped, whichever basis was found."""
        return self.basis.gram + self.basis.scale * self.thin_plate

    @cached_property
    def coefficient_gram(self) -> Floats:
        """The squared Euclidean length of the polynomials' coefficients (user's coordinates, all
        pieces) as a quadratic form in the working basis, (m, m)."""
        total = np.zeros((self.basis.size, self.basis.size))
        for patch in self.basis.patches:
            members = [self.partition.frame.globalise(Polynomial.from_row(row, self.degree)) for row in patch.tolist()]
            dense = np.array([member.dense(self.degree) for member in members])
            total += dense @ dense.T
        return total

    def form(self, energy: Energy) -> Floats:
        """The matrix H (m, m) of the part of an energy that is a quadratic form, in the user's units: `1/2 q^T H q`."""
        hessian, m = np.asarray(energy.hessian(self.basis)), self.basis.size
        if hessian.shape != (m, m) or not np.isfinite(hessian).all():
            raise ValueError(f"the energy {energy.kind!r} must give a finite matrix of shape {m, m}")
        return hessian

    def surface(self, working: fmpq_mat) -> PiecewiseSurface:
        """The exact surface with given working coefficients (1, m)."""
        return PiecewiseSurface.in_place(self.placed, self.basis.combine(working), self.degree)


@dataclass(frozen=True)
class SampledConditions:
    """What members are asked at sample points: at a share of the usual margins, on lattices of so many subdivisions of
    the outer faces, and along the rays that end there.

    Half of the margins is to be reached everywhere: the other half keeps points between those that were asked for from
    being asked for in turn, round after round.
    """

    space: PreparedSpace
    share: float = 1.0
    subdivisions: int = 32
    reached: float = 0.5

    @property
    def margins(self) -> Margins:
        """How clearly all is asked."""
        return Margins().times(self.share)

    @property
    def first(self) -> Inequalities:
        """The inequalities to begin with: of walls, clip faces and the centre."""
        return self.space.guard.initial(self.margins).unit

    def missed(self, member: Floats) -> Inequalities:
        """The inequalities that a member with a mean alpha of 1 misses by too much."""
        on_faces = self.space.guard.edges(self.subdivisions, self.margins).missed(member, self.reached)
        return (on_faces + self.space.rays(self.subdivisions).missed(member, self.margins, self.reached)).unit


@dataclass(frozen=True)
class FitSettings:
    """The constants of the fit; shares of Phi, of margins, and, for the damping, of the mean eigenvalue of the
    programme's matrix relative to `PreparedSpace.sobolev_gram`."""

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

    sets: int = 12
    """Programmes for one trial until it is known where limits are passed; most need 2 to 4."""

    damping: float = 2e-4
    least: float = 1e-9
    """The first damping and the least; a way does not end where the damping is more than the first, and hides what
    there is to gain.  With first ones from 3e-5 to 1e-3 at least 78 of 80 corners at GC^3 and 39 of 42 nodes of a foam
    became fair."""

    slower: float = 4.0
    faster: float = 0.1
    """The factor by which the damping grows where Phi does not fall, and shrinks to where it falls as foreseen."""

    brief: int = 40
    """Steps that are taken while more than `hopeless` is beyond the limits."""

    enough: float = 3e-4
    """A step that lowers Phi by a smaller share is the last one."""

    several: int = 4
    fall: float = 0.01
    """So many steps that together lower Phi by a smaller share than this are the last ones: in a poor minimum the
    damping grows and hides that there is nothing to gain."""

    met: float = 1e-3
    """The share of its margin that an inequality may lack where a member is said to meet it; solvers leave 1e-9."""

    closer: int = 3
    """Times that rays are added where curvature is beyond the limits between those that there are."""

    hopeless: float = 1.0
    """Where more than this share of the energy is beyond the limits no more rays are added, and no finer lattice is
    taken once a member is proved: of 84 corners and nodes one became fair from there, and nodes of five pipes took a
    sixth longer."""

    loss: float = 0.0
    """The share of Phi that a step may lose to constraints that it adds (single steps of sliders only: they ask for a
    margin that the member itself has not, so that it would stay where it is)."""


SETTINGS = FitSettings()
BRIEF = FitSettings(brief=8)
"""Where another space follows and few members of this one are fair: of 42 nodes of a foam the same ones, at the same
degrees, became fair with 40 steps, which are 1118 in all and 970 with these."""

LIVE = FitSettings(lattices=(16,), margins=(0.1,), enough=0.0, loss=0.01, faster=1 / 3)
"""For single steps of sliders: damping shrinks as in Nielsen's rule, so that what they hardly move goes slowly."""
