"""Boundary representations of solids for CAD programs: exact faces and edges where there are such, else splines."""
