"""Copies of one point of cloth, which UV seams split, brought together: a prediction has no cracks.

Each copy is decoded at its own place in the maps, so the network leaves them apart by a millimetre or more. The authors
average them in what they save.
"""

import numpy as np
import torch
from torch import Tensor, nn

from garmentbench.geometry.weld import weld


class Seams(nn.Module):
    """Puts the copies of a point at their mean.

    Args:
        vertices: Number of vertices V.
        pairs: Vertices that are one point of cloth, shape (S, 2).
    """

    copies: Tensor
    group: Tensor
    count: Tensor

    def __init__(self, vertices: int, pairs: np.ndarray) -> None:
        super().__init__()
        point, _ = weld(vertices, pairs)
        copies = np.flatnonzero(np.bincount(point)[point] > 1)
        _, group, count = np.unique(point[copies], return_inverse=True, return_counts=True)
        self.register_buffer("copies", torch.from_numpy(copies.astype(np.int64)), persistent=False)
        self.register_buffer("group", torch.from_numpy(group.astype(np.int64)), persistent=False)
        self.register_buffer("count", torch.from_numpy(count.astype(np.int64))[:, None], persistent=False)

    def forward(self, positions: Tensor) -> Tensor:
        """Vertices, shape (V, 3), seams closed."""
        mean = positions.new_zeros(len(self.count), 3).index_add(0, self.group, positions[self.copies]) / self.count
        return positions.index_copy(0, self.copies, mean[self.group])
