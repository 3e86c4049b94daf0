"""Do the faces point where the reference's do? What light shows of a fold, wherever the cloth is.

    normal_angle = mean_t sum_f A_f angle(n_tf, m_tf) / sum_f A_f    [deg]

n and m are the normals of face f in the prediction and in the reference, A_f its area without load.

When it lies. A fold that is right but a centimetre beside its place costs as much as a missing one, and a smooth cloth
without any fold costs about the folds' own angle: on chaotic cloth another run of the simulator may score worse than a
blurred one. A whole sleeve turned round its arm shows here though no fold is wrong.
"""

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.cloth_rest import rest_areas
from garmentbench.geometry.mesh import angles, face_normals
from garmentbench.metrics.metric import Metric, blocks


def normal_angle(
    predicted: Float[np.ndarray, "frames vertices 3"],
    reference: Float[np.ndarray, "frames vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    areas: Float[np.ndarray, " faces"],
) -> float:
    """Mean angle between the normals of the same face [deg].

    Args:
        predicted, reference: [m], shape (T, V, 3), finite.
        faces: Shape (F, 3).
        areas: Weights of the faces, in any unit, shape (F,).
    """
    means = []
    for x, y in zip(blocks(predicted), blocks(reference), strict=True):
        means.append(angles(face_normals(x, faces), face_normals(y, faces)) @ areas / areas.sum())
    return float(np.degrees(np.mean(np.concatenate(means))))


NORMAL_ANGLE = Metric(
    "normal_angle",
    "deg",
    "angle of normals",
    lambda m: normal_angle(m.predicted, m.reference, m.template.garment.faces, rest_areas(m.template.garment)),
)
