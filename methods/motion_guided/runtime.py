"""The trained model at run time: the same function as in training, with what stays the same done once.

- Only the vertices that pixels of the encoders' maps are drawn from are looked at: a fifth of a garment.
- Sums of weights over the seeds, the UV branch of R, and all that is multiplied by a constant, are made once.
- The interaction force's convolution is done in the chart's pixels, tap by tap.
- Blend weights serve the garment and, where it is asked for, the collision stage.
"""

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from garmentbench.methods.motion_guided.config import Stage2
from garmentbench.methods.motion_guided.descriptor import FORCE_REACH, VertexToMap
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.first_layers import KERNEL, ForceConv, RelativeConv
from garmentbench.methods.motion_guided.frames import BodyFrames, Link, Pose, link
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.inputs import dynamic_inputs, flat_place, past_of
from garmentbench.methods.motion_guided.networks import MLP_SLOPE, DisplacementMLP, normalise
from garmentbench.methods.motion_guided.skinning import blend_weights
from garmentbench.methods.motion_guided.sparse import SparseMatrix


class Runtime:
    """A trained model, for one frame after another.

    Args:
        model: The generative model; it must not change any more.
        dynamics: The dynamic-aware encoder, likewise.
        options: What it is given.
    """

    def __init__(self, model: GenerativeModel, dynamics: DynamicEncoder, options: Stage2) -> None:
        self.model, self.dynamics, self.options = model, dynamics, options
        self.map = ChartMap(model.to_map)
        self.geometry = SeedGeometry(model.features_block.first, self.map)
        force = dynamics.motion_block.force
        self.force = None if force is None else ChartForce(force, self.map, dynamics.force_unit)
        self.residual = RuntimeMLP(model.displacement_block, model.uv)
        self.frames = model.unit * model.frames
        self.fixed = None if model.options.dynamic_weights else model.weights(model.rest[None])[0]

    def code(self, garments: np.ndarray, before: BodyFrames, now: BodyFrames) -> Tensor:
        """Z_t, shape (1, latent), of the last three garments [m], world, shape (3, V, 3), and two frames' bodies."""
        m, on = self.model, link(before, now)
        if not self.options.garment:
            third, second, last = (before.local(g[None]) for g in garments)
            past = past_of(third, second, last, on)
            return self.dynamics(dynamic_inputs(m, past, before.pose, now.pose, on, self.options))
        third, second, last = before.local(garments[:, self.map.used_array])
        velocity = last - second
        motion = torch.cat([velocity, velocity - (second - third)], dim=1) / self.dynamics.motion_unit[:, 0, 0]
        columns = [last - m.mean_garment[self.map.used], motion if self.options.velocity else torch.zeros_like(motion)]
        if self.force is not None:
            columns.append(self._strength(on(last[None])[0], now.pose, on, before.pose))
        pixels = self.map.pixels(torch.cat(columns, dim=1))
        positions = self.map.drawn(pixels[:, :3])
        features = m.features_block.rest(normalise(self.geometry(positions, before.pose.seeds[0] - m.mean_seeds)))
        change = self._change(pixels, now.pose)
        code = self.dynamics.encoder(torch.cat([features, change], dim=1))
        if self.dynamics.pose_path:
            place = flat_place(m, now.pose.seeds, on(before.pose.seeds))
            code = code + F.linear(place, self.dynamics.path_weight, self.dynamics.path_bias)
        return code

    def _change(self, pixels: Tensor, now: Pose) -> Tensor:
        """E_t, shape (1, width, S, S), of the columns in the chart's pixels."""
        block, motion = self.dynamics.motion_block, self.map.drawn(pixels[:, 3:9])
        if self.force is None or block.force_rest is None:
            return block.both(motion)
        force = block.force_rest(normalise(self.force(pixels[:, 9:], now.normals[0])))
        return block.both(torch.cat([force, motion], dim=1))

    def _strength(self, garment: Tensor, now: Pose, on: Link, before: Pose) -> Tensor:
        """s_ij at the vertices in use, shape (U, N); see `force_strength`."""
        seeds, normals = now.seeds[0], now.normals[0]
        depth = (seeds * normals).sum(-1) - garment @ normals.T
        centres = on(before.seeds)[0] if self.options.force_distance == "previous" else seeds
        exponent = (garment @ centres.T).mul_(2).sub_(garment.square().sum(-1, keepdim=True))
        exponent = exponent.sub_(centres.square().sum(-1)).clamp_(max=0).mul_(1 / (2 * FORCE_REACH**2))
        return exponent.exp_().mul_(depth.relu_())

    def garment(self, code: Tensor, pose: Pose) -> tuple[Tensor, Tensor]:
        """The posed garment [m], shape (V, 3), and each vertex's blended rotation, shape (V, 3, 3), of a code."""
        m = self.model
        displacement = self.residual(m.to_vertex(m.decoder(code))[0])
        start = m.rest if not m.options.linear_paths else m.space_mean + (code @ m.space_basis).reshape(-1, 3)
        displaced = start + torch.einsum("vxk,vk->vx", self.frames, displacement)
        weights = self.fixed
        if weights is None:
            weights = blend_weights(displaced[None], m.canonical_seeds, m.radii)[0]
        blended = (weights @ m.transforms(pose)[0]).unflatten(-1, (3, 4))
        rotations = blended[..., :3]
        return torch.einsum("vxy,vy->vx", rotations, displaced) + blended[..., 3], rotations

    def directions(self, rotations: Tensor) -> Tensor:
        """B, how a posed vertex moves with its displacement, shape (V, 3, 3), of blended rotations."""
        return rotations @ self.model.frames


class ChartMap:
    """The chart's pixels, P of them, drawn from U of the garment's vertices."""

    def __init__(self, to_map: VertexToMap) -> None:
        rows, device = to_map.sparse[to_map.covered.cpu().numpy()], to_map.mask.device
        self.used_array = np.unique(rows.indices)
        self.used = torch.from_numpy(self.used_array).long().to(device)
        self.table = SparseMatrix(rows[:, self.used_array]).to(device)
        self.covered, self.mask, self.size = to_map.covered, to_map.mask, to_map.size

    def pixels(self, values: Tensor) -> Tensor:
        """Values at the vertices in use, shape (U, D), in the chart's pixels, shape (P, D)."""
        return self.table(values[None])[0]

    def drawn(self, pixels: Tensor) -> Tensor:
        """Values in the chart's pixels, shape (P, D), as a map, shape (1, D, S, S), 0 outside."""
        flat = pixels.new_zeros(pixels.shape[1], self.size**2)
        return flat.index_copy_(1, self.covered, pixels.T).reshape(1, -1, self.size, self.size)


class SeedGeometry:
    """`RelativeConv` with the sums over its seeds made once."""

    def __init__(self, layer: RelativeConv, chart: ChartMap) -> None:
        weight = layer.weight
        self.constant = layer.of_chart(chart.mask)
        self.of_positions = weight.sum(dim=1)
        self.of_seeds = weight.flatten(1, 2).permute(1, 0, 2, 3).flatten(1).contiguous()
        self.mask = F.unfold(chart.mask[None, None], KERNEL, padding=KERNEL // 2)[0]

    def __call__(self, positions: Tensor, seeds: Tensor) -> Tensor:
        """Features, shape (1, O, S, S), of a position map, shape (1, 3, S, S), and seeds, shape (N, 3)."""
        of_seeds = (seeds.reshape(1, -1) @ self.of_seeds).reshape(-1, KERNEL**2)
        of_positions = F.conv2d(positions, self.of_positions, padding=KERNEL // 2)
        return of_positions - (of_seeds @ self.mask).reshape(of_positions.shape) + self.constant


class ChartForce:
    """`ForceConv` in the chart's pixels alone: each tap is a product whose rows go where the tap points."""

    def __init__(self, layer: ForceConv, chart: ChartMap, unit: Tensor) -> None:
        weight, size = layer.weight, chart.size
        out, seeds = weight.shape[:2]
        taps = weight.permute(2, 1, 3, 4, 0).reshape(3, seeds, -1) / unit
        self.x, self.y, self.z = (tap.contiguous() for tap in taps)
        wide = size + 2  # a ring round the map takes what falls off it
        row, column = chart.covered // size + 1, chart.covered % size + 1
        steps = [1 - k for k in range(KERNEL)]  # tap k of a pixel's sum looks at its neighbour k - 1
        self.targets = [(row + dy) * wide + column + dx for dy in steps for dx in steps]
        self.shape, self.out = (wide, wide), out

    def __call__(self, strength: Tensor, normals: Tensor) -> Tensor:
        """Features, shape (1, O, S, S), of s_ij in the chart's pixels, shape (P, N), and normals, shape (N, 3)."""
        weight = self.x * normals[:, :1]
        weight.addcmul_(self.y, normals[:, 1:2]).addcmul_(self.z, normals[:, 2:])
        features = strength.new_zeros(self.shape[0] * self.shape[1], self.out)
        for target, tap in zip(self.targets, weight.split(self.out, dim=1), strict=True):
            features.index_add_(0, target, strength @ tap)
        return features.T.reshape(1, -1, *self.shape)[..., 1:-1, 1:-1]


class RuntimeMLP:
    """`DisplacementMLP` with its UV branch done once."""

    def __init__(self, block: DisplacementMLP, uv: Tensor) -> None:
        for layer in block.uv:
            uv = F.leaky_relu(layer(uv), MLP_SLOPE)
        width, channels = block.first.out_features, block.first.in_features - uv.shape[1]
        of_features, of_uv = block.first.weight.split([channels, width], dim=1)
        of_hidden, of_features_again, of_uv_again = block.to_hidden.weight.split([width, channels, width], dim=1)
        self.of_features = torch.cat([of_features, of_features_again]).T.contiguous()
        self.constant = torch.cat(
            [F.linear(uv, of_uv, block.first.bias), F.linear(uv, of_uv_again, block.to_hidden.bias)], dim=1
        )
        self.of_hidden = of_hidden.T.contiguous()
        self.residual: list[nn.Linear] = [layer for layer in block.residual if isinstance(layer, nn.Linear)]
        self.last = block.to_offset

    def __call__(self, features: Tensor) -> Tensor:
        """Displacements, shape (V, 3), of features, shape (V, F)."""
        x, hidden = torch.addmm(self.constant, features, self.of_features).chunk(2, dim=1)
        x = F.leaky_relu(x, MLP_SLOPE)
        for layer in self.residual:
            x.add_(F.leaky_relu_(layer(x), MLP_SLOPE))
        return self.last(F.leaky_relu_(torch.addmm(hidden, x, self.of_hidden), MLP_SLOPE))
