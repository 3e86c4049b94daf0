"""The inputs of the networks: maps in the garment's UV space, and the UV encoding."""

import math

import numpy as np
import scipy.sparse as sp
import torch
from jaxtyping import Float
from torch import Tensor, nn

from garmentbench.geometry.uvmap import Chart
from garmentbench.methods.motion_guided.sparse import SparseMatrix

FORCE_REACH = 0.04  # sigma of the interaction force [m]; the paper does not give it, the code does
UV_BANDS = 8


class VertexToMap(nn.Module):
    """Values at V vertices, shape (batch, V, D), to a map, shape (batch, D, S, S), 0 outside the chart."""

    covered: Tensor
    mask: Tensor

    def __init__(self, table: Chart, vertices: int) -> None:
        super().__init__()
        size = table.size
        rows = np.repeat(table.pixels, 3)
        matrix = sp.csr_matrix((table.weights.ravel(), (rows, table.vertices.ravel())), (size * size, vertices))
        self.register_buffer("covered", torch.from_numpy(table.pixels), persistent=False)
        mask = np.zeros(size * size, np.float32)
        mask[table.pixels] = 1
        self.size, self.sparse = size, matrix
        self.matrix = SparseMatrix(matrix)
        self.register_buffer("mask", torch.from_numpy(mask.reshape(size, size)), persistent=False)

    def forward(self, values: Float[Tensor, "batch vertices channels"]) -> Float[Tensor, "batch channels size size"]:
        return self.matrix(values).transpose(1, 2).unflatten(-1, (self.size, self.size))

    def pixels(self, values: Float[Tensor, "batch vertices channels"]) -> Float[Tensor, "batch pixels channels"]:
        """The same in the chart's P pixels only, shape (batch, P, D)."""
        return self.matrix(values)[:, self.covered]


class MapToVertex(nn.Module):
    """A map, shape (batch, D, S, S), to values at vertices, shape (batch, V, D), by a matrix, shape (V, S^2)."""

    def __init__(self, sampling: sp.csr_matrix) -> None:
        super().__init__()
        self.matrix = SparseMatrix(sampling)

    def forward(self, values: Float[Tensor, "batch channels size size"]) -> Float[Tensor, "batch vertices channels"]:
        return self.matrix(values.flatten(2).transpose(1, 2))


def force_strength(
    garment: Float[Tensor, "batch vertices 3"],
    seeds: Float[Tensor, "batch seeds 3"],
    normals: Float[Tensor, "batch seeds 3"],
    distance_to: Float[Tensor, "batch seeds 3"] | None = None,
) -> Float[Tensor, "batch vertices seeds"]:
    """Signed size s_ij of the interaction force f_ij = s_ij n_j, shape (batch, V, N) (section 5).

    s_ij = exp(-|g_{t-1,i} - b_tj|^2 / (2 sigma^2)) Relu(-q_ij), q_ij = (g_{t-1,i} - b_tj) . n_tj.

    Args:
        garment: g_{t-1} [m], shape (batch, V, 3).
        seeds: b_t [m], shape (batch, N, 3).
        normals: n_t, shape (batch, N, 3).
        distance_to: What the weight measures the distance to: b_t (the paper, and the default) or b_{t-1} (the code).
    """
    depth = (seeds * normals).sum(-1)[:, None] - garment @ normals.transpose(1, 2)
    centres = seeds if distance_to is None else distance_to
    squared = torch.cdist(garment, centres, compute_mode="donot_use_mm_for_euclid_dist").square()
    return torch.exp(-squared / (2 * FORCE_REACH**2)) * torch.relu(depth)


def uv_encoding(uv: Float[Tensor, "vertices 2"]) -> Float[Tensor, "vertices 32"]:
    """Positional encoding of (u, v) * 256, shape (V, 32); per band sin u, sin v, cos u, cos v.

    Args:
        uv: UV coordinates in [0, 1], shape (V, 2).
    """
    bands = [uv * 256 * (math.pi / 2 ** (k + 1)) for k in range(UV_BANDS)]  # rounded as in the authors' code
    return torch.cat([wave for band in bands for wave in (torch.sin(band), torch.cos(band))], dim=-1)
