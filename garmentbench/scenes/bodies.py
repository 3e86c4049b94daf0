"""The baked human bodies and their linear blend skinning. `datasets/bake/bake_bodies.py` makes the files."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench import paths
from garmentbench.errors import unknown_name
from garmentbench.sequence import Body

_CHUNK = 64  # frames skinned at once, which bounds memory at the full size to about 0.3 GB


@dataclass(frozen=True)
class BakedBody:
    """A human body with its skeleton, in its canonical pose (an A-pose).

    Attributes:
        body: Template: rest positions, faces, part labels.
        uv: UV coordinates in [0, 1], shape (B, 2), float32; at a UV seam those of one side.
        joint_names: Names of the joints, a parent before its children; the first is the root.
        parents: Parent of each joint, -1 for the root, shape (J,), int32.
        joints: Rest positions of the joints [m], shape (J, 3), float64.
        weights: Blend weights, rows sum to 1, shape (B, J), float64.
    """

    body: Body
    uv: np.ndarray
    joint_names: tuple[str, ...]
    parents: np.ndarray
    joints: np.ndarray
    weights: np.ndarray


def body_names() -> list[str]:
    """Names of the body shapes."""
    return sorted({path.stem.rsplit("-", 1)[0] for path in _files("*-*.npz")})


def body_file(name: str, size: str) -> Path:
    """The file of a body at a size: one that comes with the benchmark, or the user's own. Raises as `load_body`."""
    if name not in body_names():
        raise unknown_name("body", name, body_names())
    found = _files(f"{name}-{size}.npz")
    if not found:
        raise unknown_name("body size", size, [path.stem.rsplit("-", 1)[1] for path in _files(f"{name}-*.npz")])
    return found[0]


def _files(pattern: str) -> list[Path]:
    return [path for folder in (paths.BODIES, paths.own_bodies()) for path in folder.glob(pattern)]


def load_body(name: str, size: str) -> BakedBody:
    """The baked body `name` ("base", "slim" ..., or your own) at `size` ("small", "full").

    All shapes share faces, UV, weights and vertex order at a size. Raises `UsageError` for an unknown name or size.
    """
    with np.load(body_file(name, size), allow_pickle=False) as data:
        weights = data["weights"].astype(np.float64)
        body = Body(
            name=name,
            rest=data["rest"].astype(np.float32),
            faces=data["faces"].astype(np.int32),
            labels=data["labels"].astype(np.int8),
            part_names=tuple(data["part_names"].tolist()),
        )
        return BakedBody(
            body=body,
            uv=data["uv"].astype(np.float32),
            joint_names=tuple(data["joint_names"].tolist()),
            parents=data["parents"].astype(np.int32),
            joints=data["joints"].astype(np.float64),
            weights=weights / weights.sum(axis=1, keepdims=True),
        )


def joint_positions(baked: BakedBody, rotations: np.ndarray, root: np.ndarray) -> np.ndarray:
    """Forward kinematics.

    Args:
        baked: The body.
        rotations: World-oriented rotation of each bone from its rest orientation, shape (T, J, 3, 3).
        root: World position of the root joint [m], shape (T, 3).

    Returns:
        World positions of the joints [m], shape (T, J, 3), float64.
    """
    positions = np.empty((len(rotations), len(baked.parents), 3))
    positions[:, 0] = root
    for joint, parent in enumerate(baked.parents[1:], start=1):
        bone = baked.joints[joint] - baked.joints[parent]
        positions[:, joint] = positions[:, parent] + rotations[:, parent] @ bone
    return positions


def pose_exact(
    baked: BakedBody,
    rotations: np.ndarray,
    root: np.ndarray,
    vertices: np.ndarray | slice = slice(None),
) -> np.ndarray:
    """Linear blend skinning in float64: x = sum_j w_j (R_j (v - p_j) + q_j), p and q a joint at rest and posed.

    Args:
        baked: The body.
        rotations: World-oriented bone rotations, shape (T, J, 3, 3).
        root: World position of the root joint [m], shape (T, 3).
        vertices: Only these vertices.

    Returns:
        Vertex positions [m], shape (T, B, 3), float64.
    """
    weights, rest = baked.weights[vertices], baked.body.rest[vertices].astype(np.float64)
    offsets = joint_positions(baked, rotations, root) - np.einsum("tjab,jb->tja", rotations, baked.joints)
    transforms = np.concatenate([rotations, offsets[..., None]], axis=-1)  # (T, J, 3, 4)
    homogeneous = np.concatenate([rest, np.ones((len(rest), 1))], axis=1)
    out = np.empty((len(rotations), len(rest), 3))
    for start in range(0, len(out), _CHUNK):
        frames = slice(start, start + _CHUNK)
        blended = np.tensordot(transforms[frames], weights, axes=(1, 1))  # (chunk, 3, 4, B)
        out[frames] = np.einsum("tabv,vb->tva", blended, homogeneous, optimize=True)
    return out


def pose(baked: BakedBody, rotations: np.ndarray, root: np.ndarray) -> np.ndarray:
    """`pose_exact`, rounded to float32 at the end; shape (T, B, 3)."""
    return pose_exact(baked, rotations, root).astype(np.float32)
