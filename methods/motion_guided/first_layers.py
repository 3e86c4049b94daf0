"""The first convolutions of S and C, without the 3N-channel maps that they are defined on.

Both maps are structured and a convolution is linear, so their structure can be moved into the weights: exact, and
21 times (S) and 2.9 times (C) cheaper at the paper's size. Channels of the plain maps count seed by seed: (seed, xyz).
"""

import math

import torch
import torch.nn.functional as F
from torch import Tensor, nn

KERNEL = 3
CHART_UNIT = 0.03  # [m]


def _weights(out_channels: int, seeds: int) -> nn.Parameter:
    """Convolution weights, shape (O, N, 3, K, K), drawn as torch draws those of a plain convolution."""
    bound = 1 / math.sqrt(3 * seeds * KERNEL**2)
    return nn.Parameter(torch.empty(out_channels, seeds, 3, KERNEL, KERNEL).uniform_(-bound, bound))


class RelativeConv(nn.Module):
    """3x3 convolution of the body-relative descriptor map M^P (section 4.2): g - b_j inside the chart, 0 outside.

    conv(M^P; W) = conv(masked positions; sum_j W_j) - conv(mask; sum_jk W_jk b_jk): 3 + 1 channels instead of 3N.

    Args:
        seeds: N.
        out_channels: O.
        chart: One more channel, `CHART_UNIT` inside the chart (option `Model.chart_channel`).
    """

    def __init__(self, seeds: int, out_channels: int, chart: bool = False) -> None:
        super().__init__()
        self.weight = _weights(out_channels, seeds)
        self.chart = None
        if chart:
            bound = 1 / math.sqrt(3 * KERNEL**2)
            self.chart = nn.Parameter(torch.empty(out_channels, 1, KERNEL, KERNEL).uniform_(-bound, bound))

    def forward(self, positions: Tensor, mask: Tensor, seeds: Tensor) -> Tensor:
        """Features, shape (batch, O, H, W).

        Args:
            positions: Position map, 0 outside the chart [m], shape (batch, 3, H, W).
            mask: 1 inside the chart, 0 outside, shape (H, W).
            seeds: Seed points [m], shape (batch, N, 3). Centre both on the seeds' mean: float32 is then at its best.
        """
        batch, (height, width) = len(positions), mask.shape
        of_positions = F.conv2d(positions, self.weight.sum(dim=1), padding=KERNEL // 2)
        of_seeds = seeds.flatten(1) @ self.weight.flatten(1, 2).permute(1, 0, 2, 3).flatten(1)
        shifted_mask = F.unfold(mask[None, None], KERNEL, padding=KERNEL // 2)[0]
        of_mask = of_seeds.reshape(batch, -1, KERNEL**2) @ shifted_mask
        result = of_positions - of_mask.reshape(batch, -1, height, width)
        return result + self.of_chart(mask)

    def of_chart(self, mask: Tensor) -> Tensor | float:
        """What the chart's channel adds, shape (1, O, H, W); 0 where there is none."""
        if self.chart is None:
            return 0.0
        return F.conv2d(CHART_UNIT * mask[None, None], self.chart, padding=KERNEL // 2)


class ForceConv(nn.Module):
    """3x3 convolution of the interaction-force map C_t (section 5), whose channels are s_ij n_j with a scalar s_ij.

    conv(s n; W) = conv(s; sum_k W_jk n_jk): N channels instead of 3N, with weights made anew for each frame.
    """

    def __init__(self, seeds: int, out_channels: int) -> None:
        super().__init__()
        self.weight = _weights(out_channels, seeds)

    def forward(self, strength: Tensor, normals: Tensor) -> Tensor:
        """Features, shape (batch, O, H, W).

        Args:
            strength: Map of the forces' signed sizes s_ij, shape (batch, N, H, W).
            normals: The seeds' unit normals, shape (batch, N, 3).
        """
        batch, _, height, width = strength.shape
        weight = torch.einsum("onkyx,bnk->bonyx", self.weight, normals).flatten(0, 1)
        together = strength.reshape(1, -1, height, width)  # one group of channels a sample
        return F.conv2d(together, weight, padding=KERNEL // 2, groups=batch).reshape(batch, -1, height, width)
