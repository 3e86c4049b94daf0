"""How wrinkled the cloth is: the angles between neighbouring faces, over the reference's.

    D(x) = sqrt(mean_t mean_e angle_te^2),   angle_te between the normals of the two faces at inner edge e    [rad]
    dihedral_rms = D(prediction) / D(reference)    [1]

1 is as wrinkled as the reference, below 1 smoother. An average of several garments, or a network that hedges between
folds that it can't tell apart, is smoother: its error may be small, this is not near 1.

When it lies. It doesn't know where the folds are: wrinkles in the wrong place, and noise from vertex to vertex,
count as folds. Read `normal_angle` beside it. The finer the mesh, the smaller the angles of the same fold: it compares
nothing across meshes. NaN where the reference is flat.
"""

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.mesh import angles, face_normals
from garmentbench.geometry.weld import weld
from garmentbench.metrics.metric import Metric, Motion, blocks
from garmentbench.sequence import Garment


def face_pairs(garment: Garment) -> Int[np.ndarray, "pairs 2"]:
    """The two faces at each inner edge, seams sewn, shape (E, 2)."""
    faces = weld(len(garment.rest), garment.seams)[0][garment.faces]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, edge = np.unique(edges, axis=0, return_inverse=True)
    order = np.argsort(edge.ravel(), kind="stable")
    same = np.flatnonzero(np.diff(edge.ravel()[order]) == 0)
    return np.column_stack([order[same], order[same + 1]]) % len(faces)


def dihedral_rms(
    positions: Float[np.ndarray, "frames vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    pairs: Int[np.ndarray, "pairs 2"],
) -> float:
    """Root of the mean squared angle between neighbouring faces [rad].

    Args:
        positions: [m], shape (T, V, 3), finite.
        faces: Shape (F, 3).
        pairs: Neighbouring faces, shape (E, 2).
    """
    squares = []
    for x in blocks(positions):
        normals = face_normals(x, faces)
        squares.append((angles(normals[:, pairs[:, 0]], normals[:, pairs[:, 1]]) ** 2).mean(axis=1))
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def _wrinkled(positions: np.ndarray, motion: Motion) -> float:
    garment = motion.template.garment
    return dihedral_rms(positions, garment.faces, face_pairs(garment))


def _ratio(motion: Motion) -> float:
    wrinkled = motion.once(_wrinkled, motion.reference)
    return motion.once(_wrinkled, motion.predicted) / wrinkled if wrinkled > 0 else float("nan")


DIHEDRAL_RMS = Metric(
    "dihedral_rms",
    "1",
    "wrinkles over the reference's",
    _ratio,
    best="one",
)
