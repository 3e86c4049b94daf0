"""Liveliness: does the cloth move on the body as much as it should?

    E(x) = sum_t sum_i m_i | (x_ti - x_t-1,i) - (b_tk - b_t-1,k) |^2,   k the body vertex nearest to the *reference*
    liveliness = E(prediction) / E(reference)    [1]

1 is as lively as the reference, below 1 stiff, above 1 restless. m_i is a third of the area without load round
vertex i; the same k for both, so that only the cloth's own motion differs. Without a body the cloth's motion itself is
taken.

When it lies. It is a sum over the whole garment and time: too much flutter at the hem makes up for a dead sleeve, and
jitter counts as life: read `jitter` beside it. Cloth that turns with a limb moves a little relative to the nearest
skin, so plain skinning doesn't score 0. It is NaN where the reference does not move relative to the body.
"""

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.cloth_rest import cloth_at_rest
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.metrics.metric import Metric, Motion


def relative_energy(
    garment: Float[np.ndarray, "frames vertices 3"],
    near: Float[np.ndarray, "frames-1 vertices 3"] | None,
    mass: Float[np.ndarray, " vertices"],
) -> float:
    """Sum of mass times squared displacement a frame, relative to the body.

    Args:
        garment: [m], shape (T, V, 3).
        near: Displacement over each frame of the body near each vertex [m], shape (T - 1, V, 3); None without a body.
        mass: Of each vertex, in any unit, shape (V,).
    """
    moved = np.diff(garment, axis=0) if near is None else np.diff(garment, axis=0) - near
    return float(np.sum(np.square(moved, dtype=np.float64).sum(axis=-1) @ mass))


def near_displacements(
    garment: Float[np.ndarray, "frames vertices 3"], body: Float[np.ndarray, "frames body_vertices 3"]
) -> Float[np.ndarray, "frames-1 vertices 3"]:
    """Displacement over each frame of the body vertex nearest to each garment vertex [m], shape (T - 1, V, 3)."""
    near = [d[nearest_vertices(g, b)[1]] for d, g, b in zip(np.diff(body, axis=0), garment[1:], body[1:], strict=True)]
    return np.array(near, body.dtype).reshape(-1, *garment.shape[1:])


def vertex_areas(
    rest: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"]
) -> Float[np.ndarray, " vertices"]:
    """A third of the area of the faces round each vertex of cloth at rest [m^2], shape (V,), float64."""
    a, b, c = (rest[faces[:, k]].astype(np.float64) for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return np.bincount(faces.ravel(), np.repeat(area / 3, 3), minlength=len(rest))


def liveliness(
    predicted: Float[np.ndarray, "frames vertices 3"],
    reference: Float[np.ndarray, "frames vertices 3"],
    near: Float[np.ndarray, "frames-1 vertices 3"] | None,
    mass: Float[np.ndarray, " vertices"],
) -> float:
    """Kinetic energy relative to the body over the reference's.

    Args:
        predicted: [m], shape (T, V, 3), finite.
        reference: [m], shape (T, V, 3).
        near, mass: As for `relative_energy`, near the reference.
    """
    energy = relative_energy(reference, near, mass)
    return relative_energy(predicted, near, mass) / energy if energy > 0 else float("nan")


def _near(positions: np.ndarray, motion: Motion) -> np.ndarray | None:
    return None if motion.body is None else near_displacements(positions, motion.body)


def _liveliness(motion: Motion) -> float:
    garment = motion.template.garment
    mass = vertex_areas(cloth_at_rest(garment), garment.faces)
    return liveliness(motion.predicted, motion.reference, motion.once(_near, motion.reference), mass)


LIVELINESS = Metric(
    "liveliness",
    "1",
    "liveliness",
    _liveliness,
    best="one",
    compares=True,
)
