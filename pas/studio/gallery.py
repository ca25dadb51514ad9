"""Starting points: documents by name, for a page that is opened without a file.

Nothing but plain data, so that the server is there at once.
"""

from __future__ import annotations

from typing import Any

Data = dict[str, Any]

TEAPOT = {"lid_height": "7/5", "spout_tilt": "0", "handle_size": "1"}
"""The teapot's parameters as they are without a word."""


def _pipe(axis: list[Any], radius: str, clip: Any = 1, **more: Any) -> dict[str, Any]:
    return {"axis": axis, "radius": radius, "clip": clip, **more}


def _pipes(name: str, order: int, pipes: list[dict[str, Any]], **more: Any) -> Data:
    return {"kind": "problem", "problem": {"name": name, "order": order, **more, "pipes": pipes}}


X, Y, Z = [1, 0, 0], [0, 1, 0], [0, 0, 1]
LEFT, BACK, DOWN = [-1, 0, 0], [0, -1, 0], [0, 0, -1]

QUADRICS = {
    "name": "quadrics",
    "method": "quadrics",
    "boundaries": [
        {"name": "the paraboloid", "quadric": "x^2 + y^2/2 + z", "plane": "z + 2"},
        {"name": "the hyperboloid", "quadric": "(y - 3)^2 + (z - 4)^2 - (x - 5)^2/2 - 1", "plane": "x - 4 + z/8"},
    ],
    "shape": {"l1": "5/2", "l2": "3/2", "lambda1": "1/4", "lambda2": "-1/3"},
}
HELICOID = {
    "name": "helicoid",
    "method": "generatrix",
    "boundaries": [
        {"name": "the helicoid", "x": "h*sin(t)", "y": "h*cos(t)", "z": "t + 2", "path": ["0", "4*s"]},
        {"name": "the pipe", "implicit": "(y - 2)^2 + (z - 5)^2 - 1", "curve": ["2*s - 1", "1", "5"]},
    ],
    "shape": {"l1": 1, "l2": 1},
}
OBSTACLE = {
    "name": "obstacle",
    "method": "generatrix",
    "boundaries": [
        {"name": "the left pipe", "implicit": "y^2 + z^2 - 1", "curve": ["-4", "cos(2*pi*s)", "sin(2*pi*s)"]},
        {"name": "the right pipe", "quadric": "y^2 + z^2 - 1", "plane": "x - 4"},
    ],
    "shape": {"l1": 2, "l2": 2, "middle": ["cos(2*pi*s)/4", "9 + cos(2*pi*s)", "sin(2*pi*s)"]},
}
HEMISPHERES = {
    "name": "hemispheres",
    "order": 2,
    "contacts": [
        {"surface": "(x + 2)^2 + y^2 + z^2 - 4", "clip": "-x - 2"},
        {"surface": "(x - 1)^2 + y^2 + z^2 - 1", "clip": "x - 1"},
    ],
    "partition": {"kind": "single cell", "lower": [-2, -3, -3], "upper": [1, 3, 3]},
    "points": {"near": [["0", "1/2", "0"]]},
}

PLATE = {
    "name": "plate",
    "order": 1,
    "pipes": [_pipe([0, 0, 1], "1/2", 1)],
    "plates": [{"axis": [0, 0, 1], "radius": 1}],
}
QUARTIC = {
    "name": "quartic",
    "order": 1,
    "degree": 4,
    "contacts": [
        {"surface": "y^2 + z^2 - 1", "clip": "x - 2"},
        {"surface": "x^2 + z^2 - 1", "clip": "y - 2"},
    ],
    "partition": {"kind": "single cell", "lower": [-2, -2, -2], "upper": [2, 2, 2]},
}

GALLERY: dict[str, Data] = {
    "Corner of three pipes": _pipes("corner", 2, [_pipe(X, "1/3"), _pipe(Y, "1/4"), _pipe(Z, "2/5")], degree=6),
    "Elbow": _pipes("elbow", 2, [_pipe(X, "1/3"), _pipe(Y, "1/3")]),
    "T joint": _pipes("tee", 1, [_pipe(X, "1/3"), _pipe(LEFT, "1/3"), _pipe(Z, "1/4")]),
    "Cross": _pipes("cross", 1, [_pipe(X, "1/3"), _pipe(LEFT, "1/3"), _pipe(Y, "1/4"), _pipe(BACK, "1/4")]),
    "Three pipes askew": _pipes(
        "askew", 2, [_pipe(X, "1", "auto"), _pipe([-1, 2, 0], "1", "auto"), _pipe([0, -1, 3], "3/4", "auto")]
    ),
    "Six-way node": _pipes("six", 1, [_pipe(axis, "1/3", "auto") for axis in (X, Y, Z, LEFT, BACK, DOWN)]),
    "Elbow of one quartic": {"kind": "problem", "problem": QUARTIC},
    "Pipe out of a plate": {"kind": "problem", "problem": PLATE},
    "Two hemispheres": {"kind": "problem", "problem": HEMISPHERES},
    "Two quadrics": {"kind": "problem", "problem": QUADRICS},
    "Helicoid to pipe": {"kind": "problem", "problem": HELICOID},
    "Round an obstacle": {"kind": "problem", "problem": OBSTACLE},
    "Teapot": {"kind": "teapot", "values": dict(TEAPOT)},
}
"""The documents; a test solves each."""
