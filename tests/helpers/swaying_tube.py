"""A tiny scene: a tube of cloth that lags behind a cylinder swaying and twisting in its middle."""

from dataclasses import replace

import numpy as np

from garmentbench.methods.motion_guided.config import Config, Training, config_for
from garmentbench.sequence import Body, Garment, Sequence, Template


def tube(radius: float, height: float, rows: int, columns: int, closed: bool) -> tuple[np.ndarray, ...]:
    """Vertices [m], outward faces, and the UV coordinates of each vertex, in [0, 1]."""
    rim = columns if closed else columns + 1
    row, column = np.divmod(np.arange(rows * rim), rim)
    angle = 2 * np.pi * column / columns
    z = height * (row / (rows - 1) - 0.5)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
    faces = []
    for r in range(rows - 1):
        for c in range(columns):
            a, b = r * rim + c, r * rim + (c + 1) % rim
            faces += [[a, b, b + rim], [a, b + rim, a + rim]]
    uv = np.stack([column / columns, row / (rows - 1)], axis=1)
    return vertices.astype(np.float32), np.array(faces, np.int32), uv


def cylinder() -> Body:
    """A closed cylinder with two parts, "upper_body" and "thigh"."""
    wall, faces, _ = tube(0.1, 0.8, rows=9, columns=12, closed=True)
    rest = np.concatenate([wall, [[0, 0, -0.4], [0, 0, 0.4]]]).astype(np.float32)
    n, around = len(wall), np.arange(12)
    after = (around + 1) % 12
    caps = [[n, after[i], around[i]] for i in around] + [[n + 1, 96 + around[i], 96 + after[i]] for i in around]
    labels = (rest[:, 2] > 0).astype(np.int8)
    return Body("cylinder", rest, np.concatenate([faces, caps]).astype(np.int32), labels, ("thigh", "upper_body"))


def sway(rest: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Rest positions, shape (V, 3), swayed, twisted and carried along, shape (T, V, 3)."""
    twist = 0.6 * np.sin(time)[:, None] * rest[:, 2]
    x = np.cos(twist) * rest[:, 0] - np.sin(twist) * rest[:, 1] + 0.1 * np.sin(time)[:, None] * rest[:, 2]
    y = np.sin(twist) * rest[:, 0] + np.cos(twist) * rest[:, 1] - 0.05 * time[:, None]
    return np.stack([x, y, np.broadcast_to(rest[:, 2], x.shape) + 1.0], axis=-1).astype(np.float32)


def make_sequence(frames: int, kind: str = "human") -> Sequence:
    """The tube's cloth, 2 cm off the body, follows with a lag of a fifth of a radian."""
    body = replace(cylinder(), kind=kind)
    if kind == "object":
        body = replace(body, labels=None, part_names=())
    rest, faces, uv = tube(0.12, 0.3, rows=6, columns=14, closed=False)
    rim = 15 * np.arange(6)
    seams = np.stack([rim, rim + 14], axis=1).astype(np.int32)
    garment = Garment("tube", rest, faces, (0.05 + 0.9 * uv).astype(np.float32), seams)
    time = 0.3 * np.arange(frames)
    return Sequence(Template(garment, body, 30.0), sway(rest, time - 0.2), sway(body.rest, time))


def ringing_sequence(frames: int) -> Sequence:
    """The tube swells and shrinks about a body that hardly moves, the more the higher up, and dips into it."""
    still, time = make_sequence(frames), np.arange(frames)
    rest = still.template.garment.rest
    body, garment = (sway(r, 0.05 * time) for r in (still.template.body.rest, rest))
    amount = 0.25 * np.sin(0.9 * time) + 0.1 * np.sin(0.37 * time)
    swollen = rest * np.float32([1, 1, 0]) * (0.6 + rest[:, 2:] / 0.3)
    return replace(still, garment=(garment + amount[:, None, None] * swollen).astype(np.float32), body=body)


def tiny_config() -> Config:
    """The published small configuration, smaller still, and a few steps a stage."""
    return sized(config_for("smoke"), Training(steps=6, batch=2, learning_rate=1e-3))


def sized(published: Config, training: Training) -> Config:
    """The published choices at the tube's size, trained as said."""
    return replace(
        published,
        model=replace(published.model, map_size=8, width=4, mlp_width=8, latent=6, seeds=12),
        sdf=replace(published.sdf, width=16, batch=16, training=replace(training, steps=6)),
        stage1=replace(published.stage1, training=training),
        stage2=replace(published.stage2, training=training),
        collision=replace(published.collision, map_size=8),
    )
