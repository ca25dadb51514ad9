"""Bezier generatrix blends between any two surfaces, plane sections and intersections of quadrics."""
