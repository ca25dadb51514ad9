"""Bezier generatrix blends between any two surfaces (Cheng and Gao), plane sections and intersections of quadrics."""
