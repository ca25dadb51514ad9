"""A gear of 12 teeth with a hub, a bore with a keyway, and its number cut through.  In millimetres."""

from pas import solid

tooth = solid.polygon([(20, "-4.6"), (27, "-1.8"), (27, "1.8"), (20, "4.6")], face="tooth")
blank = tooth.circular_pattern(12) | solid.circle((0, 0), "21.5", face="root")
bore = solid.circle((0, 0), 5, face="bore") | solid.rectangle(3, "6.5", ("-1.5", 0), face="keyway")
number = solid.text("12", 6, corner=(-4, 12))
part = (blank - bore - number).extrude(8) | (solid.circle((0, 0), 9, face="hub") - bore).extrude(14)

if __name__ == "__main__":
    part.draw("gear.png", view="iso")
    part.write("gear.3mf", unit="mm")
    part.write("gear.step", unit="mm")
