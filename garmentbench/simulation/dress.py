"""Putting a garment on: from its template to where it starts in a scene."""

import numpy as np
import trimesh

from garmentbench.sequence import Body, Garment


def dress(garment: Garment, cut_for: np.ndarray | None, body: Body, first: np.ndarray) -> np.ndarray:
    """Start positions [m], world axes, shape (V, 3), float64.

    Args:
        garment: Its rest positions fit the body it was cut for, in the canonical pose.
        cut_for: That body's rest positions, shape (B, 3), where it is another body (same faces) than `body`; the garment
            is then carried to `body` by the nearest points of the skin, and starts stretched or loose as it falls.
        body: Who wears it.
        first: The body's first frame [m], shape (B, 3), float64: its canonical pose, anywhere and however turned.
    """
    start = garment.rest.astype(np.float64)
    if cut_for is not None:
        start = _carry(start, cut_for.astype(np.float64), body)
    rotation, shift = _rigid(body.rest.astype(np.float64), first)
    return start @ rotation.T + shift


def _carry(points: np.ndarray, old: np.ndarray, body: Body) -> np.ndarray:
    """Points near the skin `old` moved with it to `body`."""
    skin = trimesh.Trimesh(old, body.faces, process=False)
    nearest, _, face = trimesh.proximity.closest_point(skin, points)
    weights = trimesh.triangles.points_to_barycentric(old[body.faces[face]], nearest)
    moved = (weights[:, :, None] * body.rest[body.faces[face]]).sum(axis=1)
    return points + moved - nearest


def _rigid(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and shift that take a to b best, both shape (B, 3) (Kabsch 1976)."""
    ca, cb = a.mean(axis=0), b.mean(axis=0)
    u, _, vt = np.linalg.svd((b - cb).T @ (a - ca))
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return rotation, cb - rotation @ ca
