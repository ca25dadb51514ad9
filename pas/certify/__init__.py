"""Proofs: that a surface meets its contacts and is one clean sheet, that a mesh is it, that one is inside another."""
