"""Bernstein-Bezier forms on simplices: conversion, subdivision, integrals, proofs of sign.

A polynomial of degree n on a simplex with vertices v_0 .. v_d is `sum c_a B_a(b)` over the multi-indices a = (a_0, ..,
a_d) with |a| = n, where b are the barycentric coordinates and `B_a = n! / (a_0! .. a_d!) b^a`.  The order of the
coefficients is the order of `pas.algebra.monomials.homogeneous_exponents(n, d + 1)`, here and everywhere: descending
lexicographic, so the first coefficient belongs to v_0 (Lai and Schumaker 2007, chapters 2, 15).
"""
