"""A heat sink: a plate with 25 tapered pins and four screw holes.  In millimetres."""

from pas import solid

pin = solid.cone((10, 10, 3), (10, 10, 25), 3, 2, face="pin")
part = solid.box((0, 0, 0), (60, 60, 5), face="plate") | pin.pattern(5, (10, 0, 0)).pattern(5, (0, 10, 0))
part -= solid.cylinder((4, 4, -1), (4, 4, 6), "3/2", face="screw").pattern(2, (52, 0, 0)).pattern(2, (0, 52, 0))

if __name__ == "__main__":
    part.draw("heatsink.png", view="iso")
    part.write("heatsink.3mf", unit="mm")
    part.write("heatsink.step", unit="mm")
