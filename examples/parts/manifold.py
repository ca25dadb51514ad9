"""A hollow manifold of three branches with flanges and twelve bolt holes.  In centimetres."""

import numpy as np

import pas
from pas import solid

branches = [((1, 0, 0), 1), ((-1, 0, 1), "4/5"), ((0, 1, 0), "3/5")]  # directions and radii
wall = pas.node(branches, order=2).hollow("1/8")
part = wall.solid(length=1)
for end in wall.ends(1):
    center, axis, radius = np.array(end.center), np.array(end.direction), end.radius
    sizes = {"bolts": 4, "bolt_radius": 0.1, "bolt_circle": radius + 0.28}
    part |= solid.flange(center - 0.05 * axis, -axis, radius - 0.06, radius + 0.5, 0.25, **sizes)

if __name__ == "__main__":
    mesh = part.mesh(5e-3)
    part.draw("manifold.png", mesh=mesh, view=(1, 1, 1))
    part.write("manifold.3mf", tolerance=5e-3, unit="cm")
    part.write("manifold.step", tolerance=5e-3, unit="cm")
