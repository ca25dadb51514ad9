"""Files: problem files in, project files and meshes out; nothing is left half-written."""
