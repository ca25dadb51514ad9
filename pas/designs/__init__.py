"""The classic teapot, a design made of patches, joints and solids alone, of which each part can be changed.

`teapot` puts together what the other files of this room make: the `Body`, its `Lid`, a handle and a spout, each a
frozen dataclass of exact numbers and polynomials (`exact`) with a method that adds it to a solid, joints included.

    import pas
    from pas.designs import Handle, Spout

    pot = pas.teapot(spout=Spout(tilt="1/10"), handle=Handle(reach=1))

The command `pas teapot` builds it; whoever wants another pot gives one of its four parts other numbers, or an object
of a class of his own with the same methods.
"""

from pas.designs.body import Body
from pas.designs.exact import points
from pas.designs.handle import Handle, PaperHandle
from pas.designs.lid import Lid
from pas.designs.spout import PaperSpout, PrintedSpout, Spout
from pas.designs.teapot import STYLES, Teapot, teapot

__all__ = [
    "STYLES",
    "Body",
    "Handle",
    "Lid",
    "PaperHandle",
    "PaperSpout",
    "PrintedSpout",
    "Spout",
    "Teapot",
    "points",
    "teapot",
]
