"""An enclosure with round corners and four bosses for screws, and its lid, as two parts.  In millimetres."""

from pas import solid

outside = solid.rounded_rectangle(80, 50, 6)
inside = solid.rounded_rectangle(76, 46, 4, corner=(2, 2), face="inside")
boss = solid.circle((8, 8), 4, face="boss").pattern(2, (64, 0)).pattern(2, (0, 34))
screw = solid.circle((8, 8), "1.5", face="screw").pattern(2, (64, 0)).pattern(2, (0, 34))
walls = (outside - inside) | (boss - screw)
part = solid.assembly(
    base=(outside.extrude(2) | walls.extrude(24).translate(0, 0, 1), "#7d9db5"),
    lid=((outside - screw).extrude(3).translate(0, 0, 25), "#e8a33d"),
)

if __name__ == "__main__":
    part.draw("enclosure.png", exploded=True, view="iso")
    part.write("enclosure.3mf", unit="mm")
    part.write("enclosure.step", unit="mm")
