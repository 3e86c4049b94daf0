"""The body as its root sees it: what a regression is told of it."""

import numpy as np
from jaxtyping import Float

from garmentbench.geometry.seeds import SeedPoints, seed_frames

ARM = 0.1  # [m] how far from a seed lie the points by which its turn is told


def root_map(seeds: SeedPoints, body: Float[np.ndarray, "body 3"]) -> Float[np.ndarray, "3 4"]:
    """Rigid map from the canonical pose to the root of a body [m], shape (B, 3), as a matrix of shape (3, 4).

    The root is where the seeds' mean has gone, turned about the vertical as they have turned on the whole (by least
    squares). It stays upright.
    """
    start, now = seeds.rest.mean(axis=0), body[seeds.vertices].mean(axis=0)
    (x, y), (u, v) = (seeds.rest - start)[:, :2].T, (body[seeds.vertices] - now)[:, :2].T
    angle = np.arctan2(np.sum(x * v - y * u), np.sum(x * u + y * v))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return np.concatenate([turn, (now - turn @ start)[:, None]], axis=1)


def seed_features(
    seeds: SeedPoints | None, bodies: Float[np.ndarray, "frames body 3"] | None
) -> Float[np.ndarray, " features"]:
    """Seed points in the last frame's root, less their rest places, shape (H * 3 N,).

    So it does not matter where the body stands and which way it faces, but it does how it moves and leans.

    Args:
        seeds: N seed points; None where there is no body, then the result is empty.
        bodies: The last H bodies, oldest first [m], shape (H, B, 3).
    """
    if seeds is None:
        return np.zeros(0)
    assert bodies is not None, "seed points need the body's vertices"
    root = root_map(seeds, bodies[-1])
    points = (bodies[:, seeds.vertices] - root[:, 3]) @ root[:, :3]  # rows times the turn: its inverse
    return (points - seeds.rest).ravel()


def seed_turns(seeds: SeedPoints | None, body: Float[np.ndarray, "body 3"] | None) -> Float[np.ndarray, " features"]:
    """How the seeds are turned against the root of a body [m], shape (B, 3): by how far points `ARM` along each seed's
    tangent and normal have moved [m], shape (6 N,); empty where there is no body."""
    if seeds is None:
        return np.zeros(0)
    assert body is not None, "seed points need the body's vertices"
    _, rotation, _ = seed_frames(body, seeds)
    turned = root_map(seeds, body)[:, :3].T @ rotation @ seeds.frames
    return ARM * (turned - seeds.frames)[..., [0, 2]].ravel()
