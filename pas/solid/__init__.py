"""Solids by script: primitives, set operations, patches and joints, assemblies."""
