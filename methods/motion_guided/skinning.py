"""From local displacements to posed garments (eq. 1)."""

import torch
from jaxtyping import Float
from torch import Tensor


def displace(
    template: Float[Tensor, "*batch_or_none vertices 3"],
    frames: Float[Tensor, "vertices 3 3"],
    displacement: Float[Tensor, "batch vertices 3"],
) -> Float[Tensor, "batch vertices 3"]:
    """Canonical displaced vertices g^ = g_0 + H_0 d [m], shape (batch, V, 3) (eq. 1, second line).

    Args:
        template: g_0 [m], shape (V, 3), or (batch, V, 3).
        frames: H_0, columns tangent, bitangent, normal, shape (V, 3, 3).
        displacement: d [m], shape (batch, V, 3).
    """
    return template + torch.einsum("vxk,bvk->bvx", frames, displacement)


def blend_weights(
    displaced: Float[Tensor, "batch vertices 3"],
    canonical_seeds: Float[Tensor, "seeds 3"],
    radii: Float[Tensor, " seeds"],
) -> Float[Tensor, "batch vertices seeds"]:
    """Blend weights w_ij, softmax over the seeds of -d^2 / (2 rho^2), shape (batch, V, N) (section 4.2).

    Args:
        displaced: Canonical displaced vertices [m], shape (batch, V, 3).
        canonical_seeds: b_0 [m], shape (N, 3).
        radii: Kernel radius rho of each seed [m], shape (N,).
    """
    # |g - b|^2 / (2 rho^2) written out: one product instead of a (V, N, 3) difference. The seeds' mean goes first,
    # so that the squares stay small.
    centre = canonical_seeds.mean(dim=0)
    g, b, scale = displaced - centre, canonical_seeds - centre, 0.5 / radii**2
    squared = torch.cat([g.square().sum(-1, keepdim=True), g, torch.ones_like(g[..., :1])], dim=-1)
    per_seed = torch.cat([scale[:, None], -2 * scale[:, None] * b, (scale * b.square().sum(-1))[:, None]], dim=-1)
    return torch.softmax(-(squared @ per_seed.T), dim=-1)


def seed_transforms(
    rotations: Float[Tensor, "*batch seeds 3 3"],
    canonical_seeds: Float[Tensor, "seeds 3"],
    seeds: Float[Tensor, "*batch seeds 3"],
) -> Float[Tensor, "*batch seeds 12"]:
    """Each seed's rigid motion x -> R (x - b_0) + b_0 + T as [R | b_t - R b_0], shape (..., N, 12), row by row.

    Args:
        rotations: R, shape (..., N, 3, 3).
        canonical_seeds: b_0 [m], shape (N, 3).
        seeds: b_t = b_0 + T [m], shape (..., N, 3).
    """
    offsets = seeds - torch.einsum("...nxy,ny->...nx", rotations, canonical_seeds)
    return torch.cat([rotations, offsets[..., None]], dim=-1).flatten(-2)


def skin(
    displaced: Float[Tensor, "batch vertices 3"],
    weights: Float[Tensor, "#batch vertices seeds"],
    transforms: Float[Tensor, "batch seeds 12"],
) -> Float[Tensor, "batch vertices 3"]:
    """Posed vertices g [m], shape (batch, V, 3) (eq. 1, first line), as weights @ [N, 12].

    Args:
        displaced: Canonical displaced vertices [m], shape (batch, V, 3).
        weights: Blend weights, shape (batch or 1, V, N).
        transforms: `seed_transforms`, shape (batch, N, 12).
    """
    blended = (weights @ transforms).unflatten(-1, (3, 4))
    return (blended[..., :3] @ displaced[..., None])[..., 0] + blended[..., 3]


def blended_rotations(
    weights: Float[Tensor, "#batch vertices seeds"], transforms: Float[Tensor, "batch seeds 12"]
) -> Float[Tensor, "batch vertices 3 3"]:
    """The linear part of `skin` at each vertex, shape (batch, V, 3, 3)."""
    return (weights @ transforms).unflatten(-1, (3, 4))[..., :3]
