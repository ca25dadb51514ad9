"""A bottle: one outline of lines and tangent arcs, outside and inside, turned around.  In millimetres."""

from pas import solid

outline = solid.sketch((0, 0)).line_to(28, 0).arc_to(32, 4).line_to(32, 90)
outline = (
    outline.arc_to(23, 108).arc_to(14, 126).line_to(14, 138)
)  # the shoulder: each arc goes on as the last one ends
outline = outline.arc_to(12, 138).line_to(12, 126).arc_to(21, 108).arc_to(30, 90)
outline = outline.line_to(30, 4).arc_to(28, 2).line_to(0, 2).close()
part = outline.revolve()

if __name__ == "__main__":
    part.draw("bottle.png", cut=True, view=(0.35, -1, 0.3))
    part.write("bottle.3mf", unit="mm")
    part.write("bottle.step", unit="mm")
