"""An angle bracket: two plates with a round of GC^2 between them, two bolt holes and a pin hole.  In millimetres."""

from pas import solid

base = solid.box((0, 0, 0), (60, 40, 6), face="base")
base = base.fillet("base x+", "base y+", radius=8).fillet("base x+", "base y-", radius=8)
wall = solid.box((0, 0, 0), (6, 40, 50), face="wall")
part = (base | wall).fillet("base z+", "wall x+", radius=10, order=2, face="round")
part -= solid.cylinder((44, 10, -1), (44, 10, 7), 3, face="bolt hole").pattern(2, (0, 20, 0))
part -= solid.cylinder((-1, 20, 34), (7, 20, 34), 5, face="pin hole")

if __name__ == "__main__":
    part.draw("bracket.png", view="iso")
    part.write("bracket.3mf", unit="mm")
    part.write("bracket.step", unit="mm")
