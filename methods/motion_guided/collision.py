"""The collision stage (section 5.1): at run time, a residual displacement map pushes the garment out of the body.

The blend weights stay as they were predicted, so a vertex moves linearly with its residual: g~ = g + B theta, where B
is the vertex's blended rotation times H_0. Nothing else of the model is needed in the optimisation.
"""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from garmentbench.geometry.mesh import corner_matrix, laplacian, vertex_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import Collision
from garmentbench.methods.motion_guided.descriptor import MapToVertex
from garmentbench.methods.motion_guided.frames import to_tensor
from garmentbench.methods.motion_guided.sparse import SparseMatrix
from garmentbench.sequence import Body

ADAM_EPS = 1e-8


@dataclass(frozen=True)
class Residual:
    """The residual displacement map Theta [m], Adam's moments of it, shape (1, 3, S, S) each, and its step count."""

    map: Tensor
    first: Tensor
    second: Tensor
    steps: int

    @classmethod
    def none(cls, size: int, device: torch.device) -> "Residual":
        """No displacement."""
        return cls(*(torch.zeros(1, 3, size, size, device=device) for _ in range(3)), steps=0)

    def stepped(self, gradient: Tensor, learning_rate: float, betas: tuple[float, float]) -> "Residual":
        """After one step of Adam."""
        decay1, decay2 = betas
        n = self.steps + 1
        first = decay1 * self.first + (1 - decay1) * gradient
        second = decay2 * self.second + (1 - decay2) * gradient.square()
        change = first / (1 - decay1**n) / ((second / (1 - decay2**n)).sqrt() + ADAM_EPS)
        return Residual(self.map - learning_rate * change, first, second, n)


@dataclass(frozen=True)
class Planes:
    """Tangent planes of each garment vertex's nearest body vertex: points [m] and unit normals, shape (V, 3)."""

    points: Tensor
    normals: Tensor

    def depths(self, garment: Tensor) -> Tensor:
        """Relu(-o) [m], shape (V,), of garment vertices [m], shape (V, 3): how far each is behind its plane."""
        return torch.relu(((self.points - garment) * self.normals).sum(-1))


class CollisionStage:
    """The stage for one garment and one body mesh."""

    def __init__(self, canonical: Canonical, body: Body, options: Collision, device: torch.device) -> None:
        self.options, self.faces = options, body.faces
        self.corners = corner_matrix(body.faces, len(body.rest))
        self.to_vertex = MapToVertex(canonical.sampling(options.map_size)).to(device)
        self.laplacian = SparseMatrix(laplacian(canonical.faces, len(canonical.rest))).to(device)

    def resolve(
        self, garment: Tensor, directions: Tensor, body: np.ndarray, residual: Residual
    ) -> tuple[Tensor, Residual]:
        """The garment [m], shape (V, 3), pushed out of the body where that is triggered, and the residual map.

        Args:
            garment: The prediction g [m], shape (V, 3), finite.
            directions: B, shape (V, 3, 3).
            body: Body vertices [m], shape (B, 3), in the same coordinates.
            residual: Where to start (option `carry`).
        """
        planes = self.planes(garment, body)
        depths = planes.depths(garment)
        amount = depths.sum() if self.options.trigger == "sum" else depths.mean()
        if amount <= self.options.threshold:
            return garment, residual
        if not self.options.carry:
            residual = Residual.none(self.options.map_size, garment.device)
        return self.optimise(garment, directions, planes, residual)

    def planes(self, garment: Tensor, body: np.ndarray) -> Planes:
        """Tangent planes of the nearest body vertices, found once a frame."""
        _, nearest = nearest_vertices(garment.cpu().numpy(), body)
        normals = vertex_normals(body, self.faces, self.corners)
        return Planes(*(to_tensor(x[nearest], garment.device) for x in (body, normals)))

    def optimise(
        self, garment: Tensor, directions: Tensor, planes: Planes, residual: Residual
    ) -> tuple[Tensor, Residual]:
        """Minimise L_Theta; see `resolve`."""
        for _ in range(self.options.steps):
            with torch.enable_grad():
                values = residual.map.clone().requires_grad_()
                offset = self._offset(values, directions)
                depths = planes.depths(garment + offset)
                if not depths.any():
                    break
                (gradient,) = torch.autograd.grad(self._loss(offset, depths), values)
            residual = residual.stepped(gradient, self.options.learning_rate, self.options.betas)
        return garment + self._offset(residual.map, directions), residual

    def _offset(self, values: Tensor, directions: Tensor) -> Tensor:
        """How far each vertex is moved [m], shape (V, 3)."""
        return (directions @ self.to_vertex(values)[0, ..., None])[..., 0]

    def _loss(self, offset: Tensor, depths: Tensor) -> Tensor:
        """L_Theta."""
        o = self.options
        collision = depths.sum() if o.trigger == "sum" else depths.mean()
        position, curvature = offset.abs().mean(), self.laplacian(offset[None]).abs().mean()
        return o.position_weight * position + o.laplacian_weight * curvature + o.collision_weight * collision
