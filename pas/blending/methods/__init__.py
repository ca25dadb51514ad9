"""Ways to solve for all members of a degree, one a file; `pas.blending.solving` lists them."""
