"""Piecewise algebraic surfaces: contacts, values, rays, and the proofs of what is promised."""
