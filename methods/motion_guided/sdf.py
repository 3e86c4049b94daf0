"""SDF_0: the signed distance to the canonical body as a network (section 4.2), trained as IGR (Gropp et al. 2020)."""

import math

import numpy as np
import torch
from torch import Tensor, nn

from garmentbench.geometry.mesh import face_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.method import FitRun
from garmentbench.methods.motion_guided.config import Sdf
from garmentbench.methods.motion_guided.frames import to_tensor
from garmentbench.methods.training import generator, train
from garmentbench.sequence import Template

NORMAL_WEIGHT, EIKONAL_WEIGHT = 1.0, 0.1  # tau and lambda of IGR
NEAR_GARMENT = 0.1  # [m] Half of the samples are as near to the rest garment as this, where it is asked
SURFACE_SAMPLES = 50_000
LOCAL_SPREAD = 0.05  # standard deviation of the points off the surface, in body radii


class SignedDistance(nn.Module):
    """Signed distance [m] to a body, negative inside: an MLP with Softplus and a skip, at first near to a sphere's."""

    centre: Tensor
    radius: Tensor

    def __init__(self, options: Sdf) -> None:
        super().__init__()
        self.skip = options.layers // 2
        inputs = [3] + [options.width] * options.layers
        outputs = [options.width] * options.layers + [1]
        outputs[self.skip - 1] -= 3  # the skip brings the point itself
        pairs = zip(inputs, outputs, strict=True)
        self.layers = nn.ModuleList(_geometric(nn.Linear(i, o)) for i, o in pairs)
        self.register_buffer("centre", torch.zeros(3))
        self.register_buffer("radius", torch.ones(()))

    def forward(self, points: Tensor) -> Tensor:
        """Signed distances [m], shape (...), of points [m], shape (..., 3)."""
        return self.radius * self.unit((points - self.centre) / self.radius)

    def unit(self, points: Tensor) -> Tensor:
        """The same where the body is centred and has radius 1."""
        x = points
        for k, layer in enumerate(self.layers):
            if k == self.skip:
                x = torch.cat([x, points], dim=-1) / math.sqrt(2)
            x = layer(x)
            if k < len(self.layers) - 1:
                x = nn.functional.softplus(x, beta=100)
        return x[..., 0]


def _geometric(layer: nn.Linear) -> nn.Linear:
    """Weights with which the whole network is near to the distance to the unit sphere (Atzmon and Lipman 2020)."""
    if layer.out_features == 1:
        nn.init.normal_(layer.weight, math.sqrt(math.pi / layer.in_features), 1e-5)
        nn.init.constant_(layer.bias, -1.0)
    else:
        nn.init.normal_(layer.weight, 0.0, math.sqrt(2 / layer.out_features))
        nn.init.zeros_(layer.bias)
    return layer


def surface_samples(template: Template, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points on the canonical body [m] and their unit normals, shape (count, 3) each; the first half are spread over
    all of the body, the second over what is near to the rest garment."""
    body = template.required_body
    corners = body.rest[body.faces].astype(np.float64)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    near = nearest_vertices(corners.mean(axis=1), template.garment.rest)[0] < NEAR_GARMENT
    random = np.random.default_rng(0)
    faces = np.concatenate(
        [random.choice(len(area), count // 2, p=a / a.sum()) for a in (area, np.where(near, area, 0.0))]
    )
    weights = random.dirichlet(np.ones(3), len(faces))
    return np.einsum("pk,pkx->px", weights, corners[faces]), face_normals(body.rest, body.faces)[faces]


def igr_loss(network: SignedDistance, points: Tensor, normals: Tensor, off: Tensor) -> dict[str, Tensor]:
    """Terms of the IGR loss, in the network's own units.

    Args:
        network: The network.
        points: On the surface, shape (P, 3), with unit normals, shape (P, 3).
        normals: See `points`.
        off: Points anywhere, where the gradient must have length 1, shape (Q, 3).
    """
    everywhere = torch.cat([points, off]).requires_grad_()
    distance = network.unit(everywhere)
    (gradient,) = torch.autograd.grad(distance.sum(), everywhere, create_graph=True)
    surface = distance[: len(points)].abs().mean()
    normal = (gradient[: len(points)] - normals).norm(dim=-1).mean()
    eikonal = (gradient[len(points) :].norm(dim=-1) - 1).square().mean()
    total = surface + NORMAL_WEIGHT * normal + EIKONAL_WEIGHT * eikonal
    return {"total": total, "surface": surface, "normal": normal, "eikonal": eikonal}


def fit_sdf(template: Template, options: Sdf, run: FitRun, device: torch.device) -> None:
    """Train SDF_0 of the template's body; its weights go into the run's folder."""
    torch.manual_seed(run.seed)
    network = SignedDistance(options)
    rest = template.required_body.rest
    low, high = rest.min(axis=0), rest.max(axis=0)
    network.centre.copy_(torch.from_numpy((low + high) / 2))
    network.radius.copy_(torch.tensor(float((high - low).max() / 2)))
    network.to(device)
    points, normals = (to_tensor(x, device) for x in surface_samples(template, SURFACE_SAMPLES))
    points = (points - network.centre) / network.radius
    batch = options.batch

    def loss(step: int) -> dict[str, Tensor]:
        random = generator(run.seed, step)
        chosen = torch.randint(len(points), (batch,), generator=random).to(device)
        local = points[chosen] + LOCAL_SPREAD * torch.randn(batch, 3, generator=random).to(device)
        anywhere = 2.2 * torch.rand(batch // 8, 3, generator=random).to(device) - 1.1
        return igr_loss(network, points[chosen], normals[chosen], torch.cat([local, anywhere]))

    train(network, loss, options.training, run, "signed distance of the body")
