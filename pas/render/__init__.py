"""Pictures of surfaces: shaded, with isophotes (zebra stripes), or coloured by curvature."""
