"""E^Sta's linear path, solved at once on random garments in random poses. Ours, not the paper's."""

import torch
from torch import Tensor

from garmentbench.methods.motion_guided.frames import Pose
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.posing import RandomPoses
from garmentbench.methods.training import generator

BATCHES, BATCH = 200, 16
RIDGE = 1e-3


@torch.no_grad()
def random_garments(
    model: GenerativeModel, poses: RandomPoses, recorded: Pose, count: int, random: torch.Generator
) -> tuple[Tensor, Tensor, Pose]:
    """Random codes, shape (count, latent), their garments [m], shape (count, V, 3), and the poses these are in.

    Args:
        model: Its displacement space is set.
        poses: How poses are varied.
        recorded: Poses of the training frames.
        count: How many.
        random: The generator.
    """
    drawn = torch.randn(count, model.options.latent, generator=random).to(model.rest.device)
    codes = poses.options.code_spread * drawn
    frames = torch.randint(len(recorded.seeds), (count,), generator=random)
    pose = poses.turned(recorded.at(frames), *poses.draw(count, random))
    displaced = model.space_mean + (codes @ model.space_basis).unflatten(-1, (-1, 3))
    return codes, model.pose(displaced, pose), pose


@torch.no_grad()
def solve_encoder_path(model: GenerativeModel, poses: RandomPoses, recorded: Pose, seed: int) -> None:
    """Set E^Sta's linear path to the ridge regression of random garments' codes on their descriptors."""
    inputs, outputs = [], []
    for k in range(BATCHES):
        codes, garments, pose = random_garments(model, poses, recorded, BATCH, generator(seed, k))
        inputs.append(model.flat_descriptor(garments, pose.seeds))
        outputs.append(codes)
    weight, bias = ridge(torch.cat(inputs), torch.cat(outputs), RIDGE)
    model.path.weight.copy_(weight)
    model.path.bias.copy_(bias)


def ridge(x: Tensor, y: Tensor, penalty: float) -> tuple[Tensor, Tensor]:
    """Weight, shape (O, I), and bias, shape (O,), that minimise mean |W x + b - y|^2 + penalty |W|^2, in float64.

    Args:
        x: Shape (samples, I).
        y: Shape (samples, O).
        penalty: Not on the bias.
    """
    x, y = x.double(), y.double()
    x_mean, y_mean = x.mean(dim=0), y.mean(dim=0)
    x, y = x - x_mean, y - y_mean
    gram = x.T @ x / len(x) + penalty * torch.eye(x.shape[1], dtype=x.dtype, device=x.device)
    weight = torch.linalg.solve(gram, x.T @ y / len(x)).T
    return weight.float(), (y_mean - weight @ x_mean).float()
