"""A T of equal pipes with a wall of 3: a hollow node of GC^2 whose ends are straight pipes.  In millimetres."""

import pas

node = pas.node([((1, 0, 0), 25), ((-1, 0, 0), 25), ((0, 0, 1), 25)], order=2)
part = node.hollow(3).solid(length=30)

if __name__ == "__main__":
    part.draw("tee.png", cut=True, view=(0.6, -1, 0.5))
    part.write("tee.3mf", unit="mm", tolerance=0.2)
    part.write("tee.step", unit="mm", tolerance=0.2)
