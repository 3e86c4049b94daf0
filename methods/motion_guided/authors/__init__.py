"""What the authors of the motion-guided model released: their data and checkpoints, read into ours."""
