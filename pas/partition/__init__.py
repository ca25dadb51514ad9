"""Cells that a piecewise surface lives on: tetrahedra, their faces and the planes of these."""
