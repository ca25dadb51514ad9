"""The classic teapot as a solid of algebraic patches, built from contacts, ideals and least squares."""
