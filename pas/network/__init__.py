"""Networks of struts: graphs whose nodes become proved blends and whose struts exact cylinders.

    from pas import network
    mesh = network.lattice("octet", cells=(4, 4, 4), radius="1/20").blend(order=1).mesh(1e-3)

Public names are those of `__all__`.
"""

from pas.network.blocks import EngineLostError
from pas.network.certified_mesh import NetworkMesh
from pas.network.classes import NodeClass
from pas.network.graph import NetworkError, NetworkProblem, StrutGraph
from pas.network.lattices import UnitCell, lattice, voronoi
from pas.network.network import Network
from pas.network.part import NetworkPart

__all__ = [
    "EngineLostError",
    "Network",
    "NetworkError",
    "NetworkMesh",
    "NetworkPart",
    "NetworkProblem",
    "NodeClass",
    "StrutGraph",
    "UnitCell",
    "lattice",
    "voronoi",
]
