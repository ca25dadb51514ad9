"""A name plate for two colours: raised letters on a rounded plate with two holes, as two parts.  In millimetres."""

from pas import solid

outline = solid.rounded_rectangle(90, 32, 8, face="side")
holes = solid.circle((8, 16), 2, face="hole").pattern(2, (74, 0))
part = solid.assembly(
    plate=((outline - holes).extrude(3), "#22303c"),
    letters=(solid.text("Maker", 18, corner=(17, 10)).extrude(2).translate(0, 0, 3), "#e8a33d"),
)

if __name__ == "__main__":
    part.draw("nameplate.png", view=(0, -0.7, 1))
    part.write("nameplate.3mf", unit="mm")
    part.write("nameplate.step", unit="mm")
