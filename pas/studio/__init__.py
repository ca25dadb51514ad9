"""The studio: a page on this machine in which shapes are dragged, and seen with their curvature and their proofs."""
