"""The generative space of garment deformations (section 4): S, E^Sta, D, R and the kernel radii."""

import numpy as np
import torch
from torch import Tensor, nn

from garmentbench.geometry.mesh import laplacian
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import Model
from garmentbench.methods.motion_guided.descriptor import MapToVertex, VertexToMap, uv_encoding
from garmentbench.methods.motion_guided.frames import Pose
from garmentbench.methods.motion_guided.networks import Decoder, DisplacementMLP, Encoder, GeometryFeatures, make_faint
from garmentbench.methods.motion_guided.skinning import (
    blend_weights,
    blended_rotations,
    displace,
    seed_transforms,
    skin,
)
from garmentbench.methods.motion_guided.sparse import SparseMatrix

FIRST_RADIUS = 0.05  # [m]
FIRST_UNIT = 0.03  # [m] of the output, until it is fitted
PATH_UNIT = 0.1  # [m]


class GenerativeModel(nn.Module):
    """A regularised autoencoder of garment geometry relative to the body.

    Positions of a frame, of garment and seeds alike, are in the frame's coordinates (see `frames`).
    """

    rest: Tensor
    frames: Tensor
    canonical_seeds: Tensor
    edge_lengths: Tensor
    uv: Tensor
    edges: Tensor
    part: Tensor
    unit: Tensor
    mean_garment: Tensor
    mean_seeds: Tensor
    space_mean: Tensor
    space_basis: Tensor

    def __init__(self, canonical: Canonical, options: Model) -> None:
        super().__init__()
        self.options = options
        seeds, size = len(canonical.seeds.rest), options.map_size
        self.features_block = GeometryFeatures(seeds, options.width, options.chart_channel)
        self.encoder = Encoder(options.width, size, options.width, options.latent)
        self.decoder = Decoder(size, options.width, options.latent)
        labels = np.zeros(seeds) if canonical.seeds.labels is None else canonical.seeds.labels
        parts, part = np.unique(labels, return_inverse=True)
        # The logarithm, so that a step of the optimiser is a share of the radius and none can become negative.
        self.log_radii = nn.Parameter(torch.full((len(parts),), float(np.log(FIRST_RADIUS))))
        self._constants(canonical, part)
        self.displacement_block = DisplacementMLP(options.width // 2, self.uv.shape[1], options.mlp_width)
        if options.linear_paths:
            self._linear_paths(len(canonical.rest), seeds)

    def _constants(self, canonical: Canonical, part: np.ndarray) -> None:
        size = self.options.map_size
        self.to_map = VertexToMap(canonical.chart(size), len(canonical.rest))
        self.to_vertex = MapToVertex(canonical.sampling(2 * size))
        self.laplacian = SparseMatrix(laplacian(canonical.faces, len(canonical.rest)))
        edges, lengths = canonical.edges
        tables = {
            "rest": canonical.rest,
            "frames": canonical.frames,
            "canonical_seeds": canonical.seeds.rest,
            "edge_lengths": lengths,
        }
        for name, table in tables.items():
            self.register_buffer(name, torch.from_numpy(table.astype(np.float32)), persistent=False)
        self.register_buffer("uv", uv_encoding(torch.from_numpy(canonical.uv.astype(np.float32))), persistent=False)
        self.register_buffer("edges", torch.from_numpy(edges.astype(np.int64)), persistent=False)
        self.register_buffer("part", torch.from_numpy(part.astype(np.int64)), persistent=False)
        # What is taken off the descriptor; part of the weights, since it comes from the training frames.
        self.register_buffer("mean_garment", torch.zeros(len(canonical.rest), 3))
        self.register_buffer("mean_seeds", torch.zeros(len(part), 3))
        scale = self.options.output_scale
        self.register_buffer("unit", torch.tensor(FIRST_UNIT if scale is None else scale))

    def _linear_paths(self, vertices: int, seeds: int) -> None:
        """Places for what is solved in closed form; the networks begin faint beside it."""
        latent = self.options.latent
        self.register_buffer("space_mean", torch.zeros(vertices, 3))
        self.register_buffer("space_basis", torch.zeros(latent, 3 * vertices))
        self.path = nn.Linear(3 * int(self.to_map.mask.sum()) + 3 * seeds, latent)
        make_faint(self.encoder.linear)
        make_faint(self.displacement_block.to_offset)

    def centre_descriptor(self, garments: Tensor, seeds: Tensor) -> None:
        """Set what is taken off the descriptor to its mean over training frames (option `centred_descriptor`)."""
        self.mean_garment.copy_(garments.mean(dim=0))
        self.mean_seeds.copy_(seeds.mean(dim=0))

    @property
    def radii(self) -> Tensor:
        """Kernel radius of each seed [m], shape (N,)."""
        return self.log_radii.exp()[self.part]

    def features(self, garment: Tensor, seeds: Tensor) -> Tensor:
        """S(M^P), shape (batch, width, S, S), of a garment (batch, V, 3) beside seeds (batch, N, 3) [m]."""
        positions = self.to_map(garment - self.mean_garment)
        return self.features_block(positions, self.to_map.mask, seeds - self.mean_seeds)

    def encode(self, garment: Tensor, seeds: Tensor) -> Tensor:
        """Z = E^Sta(S(M^P)), shape (batch, latent)."""
        code = self.encoder(self.features(garment, seeds))
        return code + self.path(self.flat_descriptor(garment, seeds)) if self.options.linear_paths else code

    def flat_descriptor(self, garment: Tensor, seeds: Tensor) -> Tensor:
        """What the linear path is given: the positions in the chart's pixels and the seeds, of which the descriptor's
        values are the differences, in `PATH_UNIT`, shape (batch, 3 P + 3 N)."""
        pixels = self.to_map.pixels(garment - self.mean_garment)
        return torch.cat([pixels.flatten(1), (seeds - self.mean_seeds).flatten(1)], dim=1) / PATH_UNIT

    def displaced(self, code: Tensor) -> Tensor:
        """Canonical displaced vertices g^ [m], shape (batch, V, 3), of latent codes (batch, latent)."""
        features = self.to_vertex(self.decoder(code))
        displacement = self.unit * self.displacement_block(features, self.uv)
        start = self.rest
        if self.options.linear_paths:
            start = self.space_mean + (code @ self.space_basis).unflatten(-1, (-1, 3))
        return displace(start, self.frames, displacement)

    def weights(self, displaced: Tensor) -> Tensor:
        """Blend weights, shape (batch, V, N); of the rest garment, (1, V, N), where they are fixed (figure 7)."""
        where = displaced if self.options.dynamic_weights else self.rest[None]
        return blend_weights(where, self.canonical_seeds, self.radii)

    def transforms(self, pose: Pose) -> Tensor:
        """Rigid motions of the seeds, shape (batch, N, 12)."""
        return seed_transforms(pose.rotations, self.canonical_seeds, pose.anchors)

    def pose(self, displaced: Tensor, pose: Pose) -> Tensor:
        """Posed garment [m], shape (batch, V, 3), in the frame's coordinates (eq. 1)."""
        return skin(displaced, self.weights(displaced), self.transforms(pose))

    def directions(self, displaced: Tensor, pose: Pose) -> Tensor:
        """B, how a posed vertex moves with its displacement where its weights stay, shape (batch, V, 3, 3)."""
        return blended_rotations(self.weights(displaced), self.transforms(pose)) @ self.frames
