"""A mug: a turned body with a round lip and foot, and a handle that is filleted where it grows out.  In millimetres."""

from pas import solid

outline = solid.sketch((0, 0)).line_to(38, 0).arc_to(42, 4).line_to(42, 92, face="outside").arc_to(38, 92)
outline = outline.line_to(38, 10, face="inside").arc_to(34, 6).line_to(0, 6).close()
handle = solid.torus((42, 0, 48), (0, 1, 0), 26, 6, face="handle") - solid.cylinder((0, 0, -1), (0, 0, 99), 40)
part = (outline.revolve() | handle).fillet("handle", "outside", radius=4)

if __name__ == "__main__":
    part.draw("mug.png", view=(0.4, -1, 0.5))
    part.write("mug.3mf", unit="mm")
    part.write("mug.step", unit="mm")
