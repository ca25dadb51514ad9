"""A teapot of one's own: a spout with a wide mouth, and a handle that stands out farther.

    python examples/teapot/own_design.py out/own_design.stl

The joints are proved for the changed parts as for the first ones, whatever the points and radii are: bends are blends,
fillets are taken from the ideals of their joints. What cannot be made is refused in one sentence that names the joint.
"""

import sys
from pathlib import Path

import pas
from pas.designs import Handle, Spout, Teapot, points

SPOUT = Spout(  # (x, z, radius) where the lines of its axis end; the last one widens towards the mouth
    axis=points((1, -0.3, 0.28), (2.12, -0.02, 0.19), (2.35, 0.75, 0.12), (2.62, 1.15, 0.15))
)
HANDLE = Handle(reach="7/5", thickness="1/10")


def main(path: Path) -> Teapot:
    """Build and prove the pot, and write it."""
    pot = pas.teapot(spout=SPOUT, handle=HANDLE)
    print(pot.solid)  # the part list with the verdict on each joint
    print(f"volume {pot.solid.volume(0.01):.3f}")
    pas.write(pot.solid, path, tolerance=0.01)
    try:
        pas.teapot(spout=SPOUT, handle=Handle(middle="3/10"))
    except pas.GeometryError as error:
        print(f"refused: {error}")
    return pot


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "out/own_design.stl")
    target.parent.mkdir(parents=True, exist_ok=True)
    main(target)
