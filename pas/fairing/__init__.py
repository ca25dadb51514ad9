"""Choosing a member of a solution space: energies, constraints, and the quadratic programme."""
