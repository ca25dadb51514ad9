"""A second checker of blends, which shares nothing with the first but polynomials and the file's container."""
