"""Pose noise: training on bodies that are posed a little otherwise than in the recording. Ours, not the paper's.

The seeds are moved by a random smooth field, and the garment with them by its blend weights. By eq. 1 this leaves its
local displacements as they were, so the latent code should stay too, while the descriptor changes: the encoders learn
to read the code off the garment's place among the seeds in poses that the recording does not have.
"""

import numpy as np
import torch
from scipy.spatial.distance import cdist
from torch import Tensor

from methods.motion_guided.frames import to_tensor
from methods.motion_guided.generative import GenerativeModel

SMOOTH = 0.15  # [m] Seeds nearer to each other than this in the canonical pose move much alike


class PoseNoise:
    """Random smooth fields over the seeds, of standard deviation `size` [m]."""

    def __init__(self, model: GenerativeModel, size: float) -> None:
        seeds = model.canonical_seeds.double().cpu().numpy()
        covariance = np.exp(-(cdist(seeds, seeds) ** 2) / (2 * SMOOTH**2)) + 1e-6 * np.eye(len(seeds))
        self.model = model
        self.root = to_tensor(size * np.linalg.cholesky(covariance), model.rest.device)

    @torch.no_grad()
    def __call__(self, garment: Tensor, seeds: Tensor, random: torch.Generator) -> tuple[Tensor, Tensor]:
        """A garment [m], shape (batch, V, 3), and its seeds [m], shape (batch, N, 3), posed otherwise."""
        moved = self.root @ torch.randn(seeds.shape, generator=random).to(seeds.device)
        return garment + self.model.weights(self.model.rest[None]) @ moved, seeds + moved
