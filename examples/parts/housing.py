"""A cover: a pocket with a filleted floor, a boss with a filleted foot and a round top, and a bore.  In millimetres."""

from pas import solid

plate = solid.box((0, 0, 0), (80, 60, 12), face="plate")
boss = solid.rounded_rectangle(24, 36, 8, corner=(48, 12), face="boss").extrude(24)
pocket = solid.rounded_rectangle(32, 44, 6, corner=(8, 8), face="pocket").extrude(10).translate(0, 0, 4)
part = (plate | boss) - pocket
part = part.fillet("plate z+", "boss", radius=3, face="foot")
part = part.fillet("top", "boss", radius=2, order=2, face="round")
part = part.fillet("bottom", "pocket", radius=4, face="floor round")
part -= solid.cylinder((60, 30, -1), (60, 30, 25), 5, face="bore")

if __name__ == "__main__":
    part.draw("housing.png", view="iso")
    part.write("housing.3mf", unit="mm")
    part.write("housing.step", unit="mm")
