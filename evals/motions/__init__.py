"""How the motions are distributed."""
