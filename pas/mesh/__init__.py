"""Triangle meshes of implicit surfaces given on tetrahedral cells."""
