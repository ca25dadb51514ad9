"""Solids by script: primitives, set operations, patches and joints, assemblies.  For example:

    from pas import solid
    cross = solid.cylinder((-2, 0, 0), (2, 0, 0), 1) | solid.cylinder((0, -2, 0), (0, 2, 0), 1)
    mesh = (cross - solid.ball((0, 0, 0), "3/4")).mesh(1e-3)

Public names are those of `__all__`.
"""

from typing import TYPE_CHECKING, NoReturn

from pas.errors import missing
from pas.mesh.mesh import Mesh
from pas.solid.assembly import Assembly, Part, assembly, intersection, union
from pas.solid.joints import Joint
from pas.solid.lettering import text
from pas.solid.pipe import pipe
from pas.solid.primitives import ball, box, cone, cylinder, flange, half_space, implicit, torus, transition
from pas.solid.profile import Profile
from pas.solid.sketch import Sketch, circle, polygon, rectangle, regular_polygon, rounded_rectangle, sketch
from pas.solid.smooth_union import smooth_union
from pas.solid.solid import Solid, patch
from pas.solid.thread import thread
from pas.solid.tube import tube

SolidMesh = Mesh
"""The former name of the meshes of solids."""

__all__ = [
    "Assembly",
    "Joint",
    "Part",
    "Profile",
    "Sketch",
    "Solid",
    "SolidMesh",
    "assembly",
    "ball",
    "box",
    "circle",
    "cone",
    "cylinder",
    "flange",
    "half_space",
    "implicit",
    "intersection",
    "patch",
    "pipe",
    "polygon",
    "rectangle",
    "regular_polygon",
    "rounded_rectangle",
    "sketch",
    "smooth_union",
    "text",
    "thread",
    "torus",
    "transition",
    "tube",
    "union",
]

if not TYPE_CHECKING:  # else every name would be known

    def __getattr__(name: str) -> NoReturn:
        """Raises `AttributeError` with the nearest of the names above."""
        raise missing("pas.solid", name, __all__)
