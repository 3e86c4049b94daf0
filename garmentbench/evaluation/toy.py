"""A tiny sequence made by formulas, to try methods and tools on: a tube of cloth on a swaying ellipsoid."""

import numpy as np

from garmentbench.sequence import GARMENT, HUMAN, OBJECT, Body, Garment, Sequence, Template

_ROWS, _COLUMNS = 7, 14
_RADII = np.array([0.20, 0.16, 0.80])  # of the ellipsoid [m]


def tiny_sequence(
    frames: int = 30, kind: str | None = HUMAN, fps: float = 30.0, phase: float = 0.0, runs: int = 0
) -> Sequence:
    """The tiny sequence.

    Args:
        frames: Its length.
        kind: "human" (a body with two parts), "object" (no parts), "garment" (an open tube beneath), or None (no body
            at all).
        fps: Frames a second.
        phase: Where the swaying begins [rad]: another phase, another sequence.
        runs: How many further runs it has, each of which sways a little later on the same body.
    """
    rest, faces, uv, seams = _tube()
    body = _ellipsoid(kind)
    swing = 0.5 * np.sin(2 * np.pi * 1.1 * np.arange(frames) / fps + phase)
    walk = np.stack([0.3 * np.arange(frames) / fps, 0.1 * swing, 0.9 + 0 * swing], axis=-1)[:, None]  # (T, 1, 3)
    template = Template(Garment("tube", rest, faces, uv, seams), body, fps)

    def cloth(lag: float) -> np.ndarray:
        late = 0.5 * np.sin(2 * np.pi * 1.1 * (np.arange(frames) / fps - lag * (1 + rest[:, 2:])) + phase).T  # (T, V)
        return (_turned(rest, late) + walk).astype(np.float32)

    moving = None if body is None else (_turned(body.rest, swing[:, None]) + walk).astype(np.float32)
    further = np.stack([cloth(0.03 + 0.01 * k) for k in range(1, runs + 1)]) if runs else None
    return Sequence(template, cloth(0.03), moving, {"scene": "tiny", "split": "train"}, further)


def _turned(points: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Points, shape (P, 3), turned about the vertical by angles [rad], shape (T, P) or (T, 1); shape (T, P, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
    return np.stack([x, y, np.broadcast_to(points[:, 2], x.shape)], axis=-1)


def _tube() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rest vertices, faces, UV and seam pairs of a tube, cut open along one line."""
    row, column = np.meshgrid(np.arange(_ROWS), np.arange(_COLUMNS + 1), indexing="ij")
    u, v = column.ravel() / _COLUMNS, row.ravel() / (_ROWS - 1)
    angle, height = 2 * np.pi * (u % 1), 0.7 * v - 0.35
    wide = 1.1 * np.sqrt(1 - (height / _RADII[2]) ** 2)
    rest = np.stack([_RADII[0] * wide * np.cos(angle), _RADII[1] * wide * np.sin(angle), height], axis=1)
    corner = (row * (_COLUMNS + 1) + column)[:-1, :-1].ravel()
    right, up = corner + 1, corner + _COLUMNS + 1
    faces = np.concatenate([np.stack([corner, right, up], 1), np.stack([right, up + 1, up], 1)])
    left = np.arange(_ROWS) * (_COLUMNS + 1)
    seams = np.stack([left, left + _COLUMNS], axis=1)
    uv = np.stack([u, v], axis=1)
    return rest.astype(np.float32), faces.astype(np.int32), uv.astype(np.float32), seams.astype(np.int32)


def _ellipsoid(kind: str | None) -> Body | None:
    """An ellipsoid with outward faces; closed, but a garment is open at both ends."""
    if kind is None:
        return None
    rings, around = 13, 12
    polar, turn = np.meshgrid(
        np.arange(1, rings) * np.pi / rings, np.arange(around) * 2 * np.pi / around, indexing="ij"
    )
    inner = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), -np.cos(polar)], -1).reshape(-1, 3)
    rest = (np.concatenate([inner, [[0, 0, -1], [0, 0, 1]]]) * _RADII).astype(np.float32)
    grid = np.arange(len(inner)).reshape(rings - 1, around)
    side, corner, up = np.roll(grid, -1, axis=1), grid[:-1].ravel(), grid[1:].ravel()
    right, above = side[:-1].ravel(), side[1:].ravel()
    bottom, top = np.full(around, len(inner)), np.full(around, len(inner) + 1)
    wall = [np.stack([corner, right, up], 1), np.stack([right, above, up], 1)]
    caps = [np.stack([side[0], grid[0], bottom], 1), np.stack([grid[-1], side[-1], top], 1)]
    faces = np.concatenate(wall + caps).astype(np.int32)
    if kind == GARMENT:
        return Body("ellipsoid", rest[: len(inner)], faces[: 2 * len(corner)], kind=GARMENT)
    if kind == OBJECT:
        return Body("ellipsoid", rest, faces, kind=OBJECT)
    return Body("ellipsoid", rest, faces, (rest[:, 2] > 0).astype(np.int8), ("lower", "upper"), HUMAN)
