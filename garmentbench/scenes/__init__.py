"""What is worn by whom in which motion: scenes, presets, and the baked garments and bodies."""
