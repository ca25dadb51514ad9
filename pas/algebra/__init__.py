"""Exact algebra over the rationals: numbers, trivariate polynomials, normal forms, nullspaces."""
