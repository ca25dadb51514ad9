"""A lug of a bicycle's frame: the head tube goes through, the top and the down tube join it.  In millimetres."""

import pas

tubes = [((0, 0, 1), 18), ((0, 0, -1), 18), ((4, 0, -3), 16)]  # directions and radii
lug = pas.node(tubes, order=1).hollow("3/2")
part = lug.solid(length=12)

if __name__ == "__main__":
    part.draw("lug.png", view=(0.7, -1, 0.3))
    part.write("lug.3mf", unit="mm", tolerance=0.2)
    part.write("lug.step", unit="mm", tolerance=0.2)
