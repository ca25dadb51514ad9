"""Pictures of surfaces: shaded, with isophotes or highlight lines, coloured by curvature, with curvature combs."""
