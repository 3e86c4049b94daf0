"""How many substeps a frame needs: from the stability bound of the integrator, never by hand."""

import math

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import Fabric


def squared_frequencies(fabric: Fabric) -> tuple[float, float]:
    """Upper bounds of the squared angular frequencies [1/s^2] of stretch and of bending.

    Stretch is bounded for every shape the cloth can take, by letting each spring act in all directions at once.
    """
    count, (a, b), k = len(fabric.mass), fabric.edges.T, fabric.stiffness
    springs = sp.csr_matrix(
        (np.concatenate([k, k, -k, -k]), (np.r_[a, b, a, b], np.r_[a, b, b, a])), shape=(count, count)
    )
    return _largest(springs, fabric.mass), _largest(fabric.bending, fabric.mass)


def substeps(fabric: Fabric, material: Material, settings: Settings, frame_time: float) -> int:
    """Substeps a frame, a multiple of `settings.queries`.

    One mode of frequency w and damping time t is stable in symplectic Euler, forces explicit, while
    dt^2 w^2 + 2 dt t w^2 < 4, which is dt < 2 (sqrt(1 + z^2) - z) / w with z = t w / 2. Stretch and bending add up.
    """
    stretch, bend = squared_frequencies(fabric)
    square = stretch + bend
    damping = material.stretch_damping * stretch + material.bend_damping * bend
    if square == 0:
        return settings.queries * settings.substep_factor
    bound = (math.sqrt(damping**2 + 4 * square) - damping) / square
    least = frame_time / (settings.step_margin * bound)
    return settings.queries * math.ceil(least / settings.queries) * settings.substep_factor


def _largest(matrix: sp.csr_matrix, mass: np.ndarray) -> float:
    """Largest eigenvalue of M^-1 K."""
    if matrix.nnz == 0:
        return 0.0
    root = sp.diags(1 / np.sqrt(mass))
    start = np.random.default_rng(0).standard_normal(len(mass))
    options: dict = {"which": "LA", "v0": start, "tol": 1e-3, "return_eigenvectors": False}
    return float(eigsh(root @ matrix @ root, k=1, **options)[0])
