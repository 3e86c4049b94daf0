"""What a regression is told of the body: seed points over a few frames, as the root sees them now."""

import numpy as np

from garmentbench.geometry.seeds import SeedPoints


def seed_features(seeds: SeedPoints | None, bodies: np.ndarray | None) -> np.ndarray:
    """Seed points relative to the root of the last frame, less their rest places, shape (H * 3 N,).

    The root is the seeds' mean, turned about the vertical as they have turned on the whole since the canonical pose. So
    it does not matter where on the ground the body stands and which way it faces, but it does how it moves and leans.

    Args:
        seeds: N seed points; None where there is no body, then the result is empty.
        bodies: The last H bodies, oldest first [m], shape (H, B, 3).
    """
    if seeds is None:
        return np.zeros(0)
    rest = seeds.rest - seeds.rest.mean(axis=0)
    points = bodies[:, seeds.vertices]
    points = points - points[-1].mean(axis=0)
    (x, y), (u, v) = rest[:, :2].T, points[-1, :, :2].T
    angle = np.arctan2(np.sum(x * v - y * u), np.sum(x * u + y * v))  # least squares, in the plane
    c, s = np.cos(angle), np.sin(angle)
    back = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return (points @ back.T - rest).ravel()
