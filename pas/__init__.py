"""pas: a modeler of piecewise algebraic surfaces.

    import pas

    pipes = [pas.Pipe(axis=(1, 0, 0), radius="1/3", clip=1),
             pas.Pipe(axis=(0, 1, 0), radius="1/4", clip=1),
             pas.Pipe(axis=(0, 0, 1), radius="2/5", clip=1)]
    blend = pas.blend(pipes, order=2)

The way of the data: problem (contacts, order) -> partition -> solution space -> fit -> surface and
certificate -> mesh -> file.  Names are loaded when first used, so the import is fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from pas._version import __version__

if TYPE_CHECKING:
    from pas.algebra.ideal import Ideal as Ideal
    from pas.algebra.module import Submodule as Submodule
    from pas.algebra.module import syzygies as syzygies
    from pas.algebra.polynomial import Polynomial as Polynomial
    from pas.algebra.rational_function import RationalFunction as RationalFunction
    from pas.blending.existence import Existence as Existence
    from pas.blending.existence import ExistenceCase as ExistenceCase
    from pas.blending.existence import existence as existence
    from pas.blending.generators import Generator as Generator
    from pas.blending.method import SolvingMethod as SolvingMethod
    from pas.blending.multipliers import Multipliers as Multipliers
    from pas.blending.normal_form_system import NormalFormSystem as NormalFormSystem
    from pas.blending.normal_form_system import normal_form_system as normal_form_system
    from pas.blending.shaping import LeastSquares as LeastSquares
    from pas.blending.shaping import Optimum as Optimum
    from pas.blending.solving import register_method as register_method
    from pas.blending.trivial import TrivialPart as TrivialPart
    from pas.errors import GeometryError as GeometryError
    from pas.errors import InfeasibleError as InfeasibleError
    from pas.errors import InputError as InputError
    from pas.errors import LimitError as LimitError
    from pas.errors import MeshError as MeshError
    from pas.errors import MissingLibraryError as MissingLibraryError
    from pas.errors import NoSolutionError as NoSolutionError
    from pas.errors import NotProvedError as NotProvedError
    from pas.errors import NotSolvedError as NotSolvedError
    from pas.errors import PasError as PasError
    from pas.errors import ProblemFileError as ProblemFileError
    from pas.errors import ProjectFileError as ProjectFileError
    from pas.exchange.boundaries import boundary_from as boundary_from
    from pas.exchange.problem import read_parametric_problem as read_parametric_problem
    from pas.exchange.problem import read_problem as read_problem
    from pas.exchange.rational import ball_patches as ball_patches
    from pas.exchange.rational import cone_patches as cone_patches
    from pas.exchange.rational import cylinder_patches as cylinder_patches
    from pas.exchange.rational import torus_patches as torus_patches
    from pas.exchange.volume import VolumeMesh as VolumeMesh
    from pas.exchange.volume import VolumeSettings as VolumeSettings
    from pas.exchange.volume import volume_mesh as volume_mesh
    from pas.exchange.write import write as write
    from pas.exchange.write import write_cells as write_cells
    from pas.exchange.write import write_mesh as write_mesh
    from pas.exchange.write import write_solid as write_solid
    from pas.exchange.write import write_step as write_step
    from pas.fairing.energies.membrane import Membrane as Membrane
    from pas.fairing.energies.thin_plate import ThinPlate as ThinPlate
    from pas.fairing.energy import Energy as Energy
    from pas.fairing.energy import register_energy as register_energy
    from pas.fairing.quadrature import Box as Box
    from pas.fairing.wishes import MeanAlpha as MeanAlpha
    from pas.fairing.wishes import SumOfCoefficients as SumOfCoefficients
    from pas.fairing.wishes import UnitCoefficients as UnitCoefficients
    from pas.fairing.wishes import ValueAt as ValueAt
    from pas.fairing.wishes import Wishes as Wishes
    from pas.generatrix.align import Alignment as Alignment
    from pas.generatrix.blend import GeneratrixBlend as GeneratrixBlend
    from pas.generatrix.blend import generatrix_blend as generatrix_blend
    from pas.generatrix.boundary import Boundary as Boundary
    from pas.generatrix.branch import QuadricBranch as QuadricBranch
    from pas.generatrix.intersection import quadric_intersection as quadric_intersection
    from pas.generatrix.quadric import Quadric as Quadric
    from pas.generatrix.quadric import QuadricKind as QuadricKind
    from pas.generatrix.quadrics import SphereBlend as SphereBlend
    from pas.generatrix.quadrics import blend_quadrics as blend_quadrics
    from pas.generatrix.quadrics import blend_through_sphere as blend_through_sphere
    from pas.generatrix.sections import plane_section as plane_section
    from pas.generatrix.shape import GeneratrixShape as GeneratrixShape
    from pas.generatrix.shape import ShapeFunction as ShapeFunction
    from pas.generatrix.verdicts import GeneratrixCertificate as GeneratrixCertificate
    from pas.kinds.files import load as load
    from pas.kinds.files import load_solid as load_solid
    from pas.kinds.files import save as save
    from pas.kinds.files import save_parametric as save_parametric
    from pas.kinds.files import save_solid as save_solid
    from pas.limits import limit as limit
    from pas.mesh.mesh import Mesh as Mesh
    from pas.parametric.base_points import BasePoint as BasePoint
    from pas.parametric.base_points import base_points as base_points
    from pas.parametric.blends import ParametricBlend as ParametricBlend
    from pas.parametric.blends import PolynomialCriterion as PolynomialCriterion
    from pas.parametric.blends import has_polynomial_solution as has_polynomial_solution
    from pas.parametric.blends import hermite_blend as hermite_blend
    from pas.parametric.blends import weighted_blend as weighted_blend
    from pas.parametric.conversion import bezier_patch as bezier_patch
    from pas.parametric.conversion import bezier_patches as bezier_patches
    from pas.parametric.curves import SurfaceCurve as SurfaceCurve
    from pas.parametric.curves import iso_curve as iso_curve
    from pas.parametric.data import BlendingData as BlendingData
    from pas.parametric.data import IsolatedPoint as IsolatedPoint
    from pas.parametric.data import PointKind as PointKind
    from pas.parametric.fitting import FittedPatch as FittedPatch
    from pas.parametric.fitting import fit_patch as fit_patch
    from pas.parametric.hermite import hermite_basis as hermite_basis
    from pas.parametric.hermite import hermite_determinant as hermite_determinant
    from pas.parametric.meshing import ParametricMesh as ParametricMesh
    from pas.parametric.patches import RationalPatch as RationalPatch
    from pas.parametric.proofs import ParametricCertificate as ParametricCertificate
    from pas.parametric.regularity import regularity as regularity
    from pas.parametric.shapes import ellipsoid as ellipsoid
    from pas.parametric.shapes import elliptic_cone as elliptic_cone
    from pas.parametric.shapes import elliptic_cylinder as elliptic_cylinder
    from pas.parametric.shapes import elliptic_paraboloid as elliptic_paraboloid
    from pas.parametric.shapes import helicoid as helicoid
    from pas.parametric.shapes import one_sheet_hyperboloid as one_sheet_hyperboloid
    from pas.parametric.shapes import plane as plane
    from pas.parametric.shapes import surface_of_revolution as surface_of_revolution
    from pas.parametric.shapes import torus as torus
    from pas.parametric.shapes import tube as tube
    from pas.parametric.shapes import two_sheet_hyperboloid as two_sheet_hyperboloid
    from pas.parametric.solutions import ParametricSolutions as ParametricSolutions
    from pas.parametric.surface import ParametricSurface as ParametricSurface
    from pas.parametric.weights import WeightPole as WeightPole
    from pas.parametric.weights import Weights as Weights
    from pas.partition.cells import Partition as Partition
    from pas.partition.kinds import register_partition as register_partition
    from pas.partition.single_cell import SingleCell as SingleCell
    from pas.partition.six_tetrahedra import SixTetrahedra as SixTetrahedra
    from pas.pipeline.blend import blend as blend
    from pas.pipeline.result import Blend as Blend
    from pas.pipeline.space import SolutionSpace as SolutionSpace
    from pas.pipeline.space import solutions as solutions
    from pas.render.picture import draw as draw
    from pas.render.scene import Picture as Picture
    from pas.render.scene import Style as Style
    from pas.render.window import show as show
    from pas.shape import Kind as Kind
    from pas.shape import Shape as Shape
    from pas.surface.certificate import Certificate as Certificate
    from pas.surface.contact import Contact as Contact
    from pas.surface.contact import Pipe as Pipe
    from pas.surface.contact import contact_ideal as contact_ideal
    from pas.surface.curvature import CurvatureContact as CurvatureContact
    from pas.surface.curvature import curvature_contact as curvature_contact
    from pas.surface.piecewise import PiecewiseSurface as PiecewiseSurface
    from pas.verdicts import Status as Status
    from pas.verdicts import Verdict as Verdict
    from pas.verdicts import Verdicts as Verdicts

_HOMES = {
    "pas.algebra.ideal": ("Ideal",),
    "pas.algebra.module": ("Submodule", "syzygies"),
    "pas.algebra.polynomial": ("Polynomial",),
    "pas.pipeline.blend": ("blend",),
    "pas.pipeline.result": ("Blend",),
    "pas.blending.existence": ("Existence", "ExistenceCase", "existence"),
    "pas.blending.generators": ("Generator",),
    "pas.blending.method": ("SolvingMethod",),
    "pas.blending.multipliers": ("Multipliers",),
    "pas.blending.normal_form_system": ("NormalFormSystem", "normal_form_system"),
    "pas.blending.shaping": ("LeastSquares", "Optimum"),
    "pas.pipeline.space": ("SolutionSpace", "solutions"),
    "pas.blending.solving": ("register_method",),
    "pas.blending.trivial": ("TrivialPart",),
    "pas.errors": (
        "GeometryError",
        "InfeasibleError",
        "InputError",
        "LimitError",
        "MeshError",
        "MissingLibraryError",
        "NoSolutionError",
        "NotProvedError",
        "NotSolvedError",
        "PasError",
        "ProblemFileError",
        "ProjectFileError",
    ),
    "pas.exchange.boundaries": ("boundary_from",),
    "pas.exchange.problem": ("read_parametric_problem", "read_problem"),
    "pas.exchange.rational": ("ball_patches", "cone_patches", "cylinder_patches", "torus_patches"),
    "pas.exchange.write": ("write", "write_cells", "write_mesh", "write_solid", "write_step"),
    "pas.exchange.volume": ("VolumeMesh", "VolumeSettings", "volume_mesh"),
    "pas.fairing.wishes": ("MeanAlpha", "SumOfCoefficients", "UnitCoefficients", "ValueAt", "Wishes"),
    "pas.fairing.energies.membrane": ("Membrane",),
    "pas.fairing.energies.thin_plate": ("ThinPlate",),
    "pas.fairing.energy": ("Energy", "register_energy"),
    "pas.fairing.quadrature": ("Box",),
    "pas.generatrix.align": ("Alignment",),
    "pas.generatrix.blend": ("GeneratrixBlend", "generatrix_blend"),
    "pas.generatrix.boundary": ("Boundary",),
    "pas.generatrix.branch": ("QuadricBranch",),
    "pas.generatrix.intersection": ("quadric_intersection",),
    "pas.generatrix.quadric": ("Quadric", "QuadricKind"),
    "pas.generatrix.quadrics": ("SphereBlend", "blend_quadrics", "blend_through_sphere"),
    "pas.generatrix.sections": ("plane_section",),
    "pas.generatrix.shape": ("GeneratrixShape", "ShapeFunction"),
    "pas.generatrix.verdicts": ("GeneratrixCertificate",),
    "pas.kinds.files": ("load", "load_solid", "save", "save_parametric", "save_solid"),
    "pas.limits": ("limit",),
    "pas.mesh.mesh": ("Mesh",),
    "pas.parametric.base_points": (
        "BasePoint",
        "base_points",
    ),
    "pas.parametric.blends": (
        "ParametricBlend",
        "PolynomialCriterion",
        "has_polynomial_solution",
        "hermite_blend",
        "weighted_blend",
    ),
    "pas.parametric.conversion": ("bezier_patch", "bezier_patches"),
    "pas.parametric.fitting": ("FittedPatch", "fit_patch"),
    "pas.parametric.curves": (
        "SurfaceCurve",
        "iso_curve",
    ),
    "pas.parametric.data": (
        "BlendingData",
        "IsolatedPoint",
        "PointKind",
    ),
    "pas.parametric.hermite": (
        "hermite_basis",
        "hermite_determinant",
    ),
    "pas.parametric.meshing": ("ParametricMesh",),
    "pas.parametric.patches": ("RationalPatch",),
    "pas.parametric.proofs": ("ParametricCertificate",),
    "pas.algebra.rational_function": ("RationalFunction",),
    "pas.parametric.regularity": ("regularity",),
    "pas.parametric.shapes": (
        "ellipsoid",
        "elliptic_cone",
        "elliptic_cylinder",
        "elliptic_paraboloid",
        "helicoid",
        "one_sheet_hyperboloid",
        "plane",
        "surface_of_revolution",
        "torus",
        "tube",
        "two_sheet_hyperboloid",
    ),
    "pas.parametric.solutions": ("ParametricSolutions",),
    "pas.parametric.surface": ("ParametricSurface",),
    "pas.parametric.weights": (
        "WeightPole",
        "Weights",
    ),
    "pas.partition.cells": ("Partition",),
    "pas.partition.kinds": ("register_partition",),
    "pas.partition.single_cell": ("SingleCell",),
    "pas.partition.six_tetrahedra": ("SixTetrahedra",),
    "pas.render.picture": ("draw",),
    "pas.render.scene": ("Picture", "Style"),
    "pas.render.window": ("show",),
    "pas.shape": ("Kind", "Shape"),
    "pas.surface.certificate": ("Certificate",),
    "pas.surface.contact": ("Contact", "Pipe", "contact_ideal"),
    "pas.surface.curvature": ("CurvatureContact", "curvature_contact"),
    "pas.surface.piecewise": ("PiecewiseSurface",),
    "pas.verdicts": ("Status", "Verdict", "Verdicts"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = ["__version__", *sorted(_HOME_OF)]


def __getattr__(name: str) -> Any:
    if name == "solid":
        return import_module("pas.solid")
    if name not in _HOME_OF:
        raise AttributeError(f"module 'pas' has no attribute {name!r}")
    value = getattr(import_module(_HOME_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
