"""The linear space of displacements that the training frames span, and a little round it. Ours, not the paper's."""

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
import torch
from torch import Tensor

from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.frames import Pose, to_tensor
from garmentbench.methods.motion_guided.generative import GenerativeModel

SMOOTH_MODES, SMOOTH_SIZE = 40, 0.005  # smooth bumps of any training: how many, and the largest's size [m]
SEAM_STIFFNESS = 50.0  # of a seam pair against an edge, so that the bumps leave seams closed
WEAKEST = 1e-4  # [m] No component is taken for weaker


@torch.no_grad()
def set_displacement_space(model: GenerativeModel, canonical: Canonical, garments: Tensor, pose: Pose) -> None:
    """Set the model's linear part of D to the principal components of the training frames' displacements.

    Smooth modes of the mesh, faint, are put beside the frames, so that the space is not only what they span.

    Args:
        model: Its displacement space is set, scaled so that the training frames' codes have the mean square of 1 that
            L_reg asks for.
        canonical: The canonical pose.
        garments: Training garments [m], shape (T, V, 3).
        pose: Their seeds.
    """
    displaced = undo_pose(model, garments, pose)
    mean = displaced.mean(dim=0)
    spread = (displaced - mean).flatten(1) / len(displaced) ** 0.5
    modes = np.einsum("vk,xy->kxvy", smooth_modes(canonical), np.eye(3)).reshape(-1, spread.shape[1])
    rows = torch.cat([spread, to_tensor(modes, spread.device)])
    _, strength, basis = torch.linalg.svd(rows, full_matrices=False)
    count = model.options.latent
    scaled = strength[:count, None].clamp_min(WEAKEST) * basis[:count]
    codes = (displaced - mean).flatten(1) @ basis[:count].T / scaled.norm(dim=1)
    model.space_mean.copy_(mean)
    model.space_basis.copy_(scaled * codes.square().mean().sqrt())


@torch.no_grad()
def displacement_scale(model: GenerativeModel, garments: Tensor, pose: Pose) -> Tensor:
    """Root mean square of the components of training garments' displacements [m], shape ().

    Args:
        model: Untrained.
        garments: Training garments [m], shape (T, V, 3).
        pose: Their seeds.
    """
    return (undo_pose(model, garments, pose) - model.rest).square().mean().sqrt()


def undo_pose(model: GenerativeModel, garments: Tensor, pose: Pose, iterations: int = 4) -> Tensor:
    """Canonical displaced vertices g^ [m], shape (T, V, 3), that eq. 1 poses as `garments`, shape (T, V, 3).

    A fixed-point iteration, since the blend weights depend on g^.
    """
    result = []
    for t in range(len(garments)):
        transforms, displaced = model.transforms(pose.at(slice(t, t + 1))), model.rest
        for _ in range(iterations):
            blended = (model.weights(displaced[None]) @ transforms)[0].unflatten(-1, (3, 4))
            offset = garments[t] - blended[..., 3]
            displaced = torch.linalg.solve(blended[..., :3], offset[..., None])[..., 0]
        result.append(displaced)
    return torch.stack(result)


def smooth_modes(canonical: Canonical) -> np.ndarray:
    """The smoothest modes of the mesh's graph, seams closed [m], shape (V, K): root mean square `SMOOTH_SIZE` for the
    first two, falling with their stiffness after."""
    edges, lengths = canonical.edges
    count = len(canonical.rest)
    weight = np.where(lengths > 0, 1.0, SEAM_STIFFNESS)
    adjacency = sp.csr_matrix((weight, edges.T), (count, count))
    adjacency = adjacency + adjacency.T
    graph = sp.diags(np.asarray(adjacency.sum(axis=1)).ravel()) - adjacency
    wanted = min(SMOOTH_MODES, count - 2)
    stiffness, modes = sla.eigsh(graph.tocsc(), wanted, sigma=-1e-4, which="LM", v0=np.ones(count))
    order = np.argsort(stiffness)
    stiffness, modes = np.maximum(stiffness[order], 0), modes[:, order]
    return SMOOTH_SIZE * np.sqrt(count) * modes * stiffness[1] / np.maximum(stiffness, stiffness[1])
