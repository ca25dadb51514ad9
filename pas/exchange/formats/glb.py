"""GLB (binary glTF), by trimesh: a named node and a material for each part, normals of the points, single precision.

Points are doubled along sharp edges; the unit is written as the scene's extras.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pas.exchange.formats import Format, Request
from pas.exchange.parts import TRIANGLES, Piece
from pas.limits import checkpoint


def write_glb(parts: Sequence[Piece], path: Path, request: Request) -> None:
    """All parts as a scene."""
    import trimesh

    names = [p.name for p in parts]
    root = "root"
    while root in names:
        root += "_"
    scene: Any = trimesh.Scene(metadata={"unit": request.unit}, base_frame=root)
    for part in parts:
        checkpoint()
        scene.add_geometry(part.mesh.to_trimesh(), node_name=part.name, geom_name=part.name)

    def paint(tree: dict[str, Any]) -> None:
        tree["materials"] = [_material(p) for p in parts]
        for mesh in tree["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["material"] = names.index(mesh["name"])

    checkpoint()
    path.write_bytes(scene.export(file_type="glb", include_normals=True, tree_postprocessor=paint))


def _material(part: Piece) -> dict[str, Any]:
    """A material of glTF, in which colours are linear, not those of screens (sRGB, IEC 61966-2-1)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (c / 255 for c in part.color)]
    surface = {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6}
    return {"name": part.name, "pbrMetallicRoughness": surface}


GLB = Format(".glb", TRIANGLES, write_glb)
