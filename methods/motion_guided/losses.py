"""Losses of both stages. All are means, as in the code; the paper writes norms and does not say."""

import torch
from torch import Tensor

from garmentbench.methods.motion_guided.sparse import SparseMatrix


def reconstruction(predicted: Tensor, true: Tensor, laplacian: SparseMatrix) -> tuple[Tensor, Tensor]:
    """The two terms of L_rec, position and Laplacian L1 [m] (section 4.2), of vertices, shape (batch, V, 3)."""
    error = predicted - true
    return error.abs().mean(), laplacian(error).abs().mean()


def latent_regulariser(code: Tensor) -> Tensor:
    """L_reg = | sum z^2 / |Z| - 1 |, mean over the batch, of codes, shape (batch, latent) (section 4.2)."""
    return (code.square().mean(dim=-1) - 1).abs().mean()


def edge_deviation(displaced: Tensor, edges: Tensor, lengths: Tensor) -> Tensor:
    """L_rand: mean difference of canonical edge lengths [m] to the template's (section 4.2).

    Args:
        displaced: Canonical displaced vertices [m], shape (batch, V, 3).
        edges: Vertex pairs; a seam's pair is an edge of rest length 0, shape (E, 2).
        lengths: The template's lengths [m], shape (E,).
    """
    spokes = displaced[:, edges[:, 0]] - displaced[:, edges[:, 1]]
    # The smallest normal square keeps the gradient of a seam that is closed finite.
    return ((spokes.square().sum(-1) + 1e-16).sqrt() - lengths).abs().mean()


def sdf_violation(distance: Tensor, margin: float) -> Tensor:
    """L_SDF0: mean of max(eps - SDF_0, 0) [m] (section 4.2), of signed distances to the canonical body."""
    return torch.relu(margin - distance).mean()


def dynamic_pair(predicted: Tensor, true: Tensor) -> Tensor:
    """One L1 term of L_geo or L_Z (eq. 2)."""
    return (predicted - true).abs().mean()
