"""How far motions are apart: poses as seed points on the body, and their map to the plane by t-SNE.

Source: figure 5 of Zhang et al. 2022, "t-SNE computed over the 3D body seed points sampled on the dynamic body
sequences". It does not say whether where the body stands and which way it faces count; here neither does.
"""

from dataclasses import replace

import numpy as np

from garmentbench.geometry.seeds import farthest_points
from garmentbench.motion import animate
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene

SEEDS = 64  # on the whole body
EVERY = 3  # frames from one pose to the next ...
FRAMES = 495  # ... up to this one, the paper's longest training
PERPLEXITY = 30.0


def poses(scene: Scene, preset: Preset) -> np.ndarray:
    """Seed points of a scene's body [m], shape (poses, SEEDS, 3): over the origin, turned to face one way."""
    animation = animate(replace(scene, frames=min(scene.frames, FRAMES)), preset)
    body = animation.body
    seeds = farthest_points(body.rest, body.faces, np.arange(len(body.rest)), SEEDS)
    moving = animation.positions[animation.warm_up :: EVERY, seeds]
    return _upright(moving, body.rest[seeds].astype(np.float64))


def _upright(points: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Points without their mean place over the floor, turned about the vertical as near to the rest pose as can be.

    The turn that minimises the sum of squares is, with complex numbers for what is over the floor, the angle of
    sum conj(p_i) r_i.
    """
    centred = points - points.mean(axis=1, keepdims=True) * [1.0, 1.0, 0.0]
    to = rest - rest.mean(axis=0) * [1.0, 1.0, 0.0]
    flat, target = centred[..., 0] + 1j * centred[..., 1], to[:, 0] + 1j * to[:, 1]
    turn = np.sum(flat.conj() * target, axis=1)
    turned = flat * (turn / np.abs(turn))[:, None]
    return np.stack([turned.real, turned.imag, centred[..., 2]], axis=-1)


def nearest_cm(points: np.ndarray, others: np.ndarray) -> float:
    """How far poses are from the nearest of other poses [cm]: mean over poses, and over the seeds of the two.

    Args:
        points: Poses [m], shape (P, N, 3).
        others: Shape (Q, N, 3).
    """
    return 100 * float(np.mean([np.linalg.norm(others - pose, axis=-1).mean(axis=-1).min() for pose in points]))


def embed(points: np.ndarray) -> np.ndarray:
    """Poses, shape (P, N, 3), on the plane by t-SNE, shape (P, 2); the same every time on one thread."""
    from sklearn.manifold import TSNE

    perplexity = min(PERPLEXITY, (len(points) - 1) / 3)
    plane = TSNE(perplexity=perplexity, init="pca", random_state=0, n_jobs=1)
    return plane.fit_transform(points.reshape(len(points), -1)).astype(np.float32)
