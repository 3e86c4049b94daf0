"""Meshes, seed points, UV maps and nearest points, in numpy."""
