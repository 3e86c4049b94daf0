"""garmentbench: how well, how fast and how stably a method predicts a garment's motion from the body's motion."""

__version__ = "0.1.0"
