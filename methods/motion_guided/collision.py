"""The collision stage (section 5.1): at run time, a residual displacement map pushes the garment out of the body.

The blend weights stay as they were predicted, so a vertex moves linearly with its residual: g~ = g + B theta, where B
is the vertex's blended rotation times H_0. Nothing else of the model is needed in the optimisation, and the gradient of
its loss is written out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from garmentbench.geometry.mesh import laplacian
from garmentbench.methods.motion_guided.body_surface import Planes
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import Collision
from garmentbench.methods.motion_guided.push_out import PushOut
from garmentbench.sequence import Body

ADAM_EPS = 1e-8


@dataclass(frozen=True)
class Residual:
    """The residual displacement map Theta [m], Adam's moments of it, shape (S^2, 3) each, and its step count."""

    map: np.ndarray
    first: np.ndarray
    second: np.ndarray
    steps: int

    @classmethod
    def none(cls, size: int) -> "Residual":
        """No displacement."""
        return cls(*(np.zeros((size * size, 3), np.float32) for _ in range(3)), steps=0)

    def stepped(self, gradient: np.ndarray, learning_rate: float, betas: tuple[float, float]) -> "Residual":
        """After one step of Adam."""
        decay1, decay2 = betas
        n = self.steps + 1
        first = decay1 * self.first + (1 - decay1) * gradient
        second = decay2 * self.second + (1 - decay2) * gradient**2
        change = first / (np.sqrt(second / (1 - decay2**n)) + ADAM_EPS)
        return Residual(self.map - learning_rate / (1 - decay1**n) * change, first, second, n)


class CollisionStage:
    """The stage for one garment and one body mesh."""

    def __init__(self, canonical: Canonical, body: Body, options: Collision) -> None:
        self.options = options
        self.push = PushOut.of(canonical.rest, canonical.faces, canonical.seams, body, options)
        self.surface = self.push.surface
        self.sampling = sp.csr_matrix(canonical.sampling(options.map_size), dtype=np.float32)
        self.laplacian = sp.csr_matrix(laplacian(canonical.faces, len(canonical.rest)), dtype=np.float32)
        self.spreading, self.transposed = (sp.csr_matrix(m.T) for m in (self.sampling, self.laplacian))

    def resolve(
        self, garment: np.ndarray, directions: Callable[[], np.ndarray], body: np.ndarray, residual: Residual
    ) -> tuple[np.ndarray, Residual]:
        """The garment [m], shape (V, 3), pushed out of the body where that is triggered, and the residual map.

        Args:
            garment: The prediction g [m], shape (V, 3), finite.
            directions: Gives B, shape (V, 3, 3); asked only where the stage runs.
            body: Body vertices [m], shape (B, 3), in the same coordinates.
            residual: Where to start (option `carry`).
        """
        planes = self.surface.planes(garment, body)
        depths = np.maximum(planes.depths(garment), 0)
        amount = depths.sum() if self.options.trigger == "sum" else depths.mean()
        if amount <= self.options.threshold:
            return garment, residual
        if not self.options.carry:
            residual = Residual.none(self.options.map_size)
        if self.options.solver == "push":
            return self.push(garment, body, planes), residual
        return self.optimise(garment, directions(), planes, residual)

    def optimise(
        self, garment: np.ndarray, directions: np.ndarray, planes: Planes, residual: Residual
    ) -> tuple[np.ndarray, Residual]:
        """Minimise L_Theta; see `resolve`."""
        depth = planes.depths(garment)
        for _ in range(self.options.steps):
            offset = self.offset(residual.map, directions)
            behind = depth > np.einsum("vx,vx->v", offset, planes.normals)
            if not behind.any():
                break
            pushed = self.gradient(offset, behind, planes.normals)
            gradient = self.spreading @ np.einsum("vxy,vx->vy", directions, pushed)
            residual = residual.stepped(gradient, self.options.learning_rate, self.options.betas)
        return garment + self.offset(residual.map, directions), residual

    def offset(self, values: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """How far each vertex is moved [m], shape (V, 3), by a residual map, shape (S^2, 3)."""
        return np.einsum("vxy,vy->vx", directions, self.sampling @ values)

    def gradient(self, offset: np.ndarray, behind: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Of L_Theta by the vertices' offsets, shape (V, 3), where `behind`, shape (V,), are behind their planes.

        L_Theta = w_p mean |offset| + w_l mean |Laplacian offset| + w_c (sum or mean) of depths.
        """
        o = self.options
        collision = o.collision_weight / (1 if o.trigger == "sum" else len(offset))
        result = (o.position_weight / offset.size) * np.sign(offset)
        result += (o.laplacian_weight / offset.size) * (self.transposed @ np.sign(self.laplacian @ offset))
        result[behind] -= np.float32(collision) * normals[behind]
        return result
