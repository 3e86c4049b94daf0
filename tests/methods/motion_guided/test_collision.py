import numpy as np
import pytest
import torch

from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import plane_distances
from garmentbench.methods.motion_guided.collision import CollisionStage, Planes, Residual
from garmentbench.methods.motion_guided.config import Collision
from garmentbench.methods.motion_guided.frames import Pose

CPU = torch.device("cpu")


@pytest.fixture
def pressed(trained, sequence):
    """A posed garment, a part of which is inside the body, and what moves it."""
    body = sequence.template.body
    displaced = trained.generative.rest[None].clone()
    front = displaced[0, :, 0] > 0.05
    displaced[0, front] *= torch.tensor([0.75, 0.75, 1.0])
    seeds = torch.from_numpy(trained.canonical.seeds.rest)[None]
    turns = torch.eye(3).expand(1, len(seeds[0]), 3, 3)
    directions = trained.generative.directions(displaced, Pose(seeds, turns, seeds, seeds))
    return displaced[0], directions[0], body.rest


def _stage(trained, sequence, **options) -> CollisionStage:
    return CollisionStage(trained.canonical, sequence.template.body, Collision(map_size=16, **options), CPU)


def _share_inside(garment, body, sequence) -> float:
    normals = vertex_normals(body, sequence.template.body.faces)
    return float((plane_distances(garment.numpy(), body, normals) < 0).mean())


def test_a_pressed_garment_comes_out_and_the_rest_hardly_moves(trained, sequence, pressed):
    garment, directions, body = pressed
    assert _share_inside(garment, body, sequence) > 0.1
    stage = _stage(trained, sequence, steps=200)
    out, residual = stage.resolve(garment, directions, body, Residual.none(16, CPU))
    assert _share_inside(out, body, sequence) < 0.01
    moved = (out - garment).norm(dim=-1)
    assert moved[garment[:, 0] > 0.05].max() > 0.01
    assert moved[garment[:, 0] < -0.05].max() < 0.003


def test_it_ends_as_soon_as_nothing_penetrates(trained, sequence, pressed):
    garment, directions, body = pressed
    outside = garment.clone()
    outside[:, :2] *= 1.5
    same, residual = _stage(trained, sequence).resolve(outside, directions, body, Residual.none(16, CPU))
    assert torch.equal(same, outside) and residual.steps == 0
    _, residual = _stage(trained, sequence, steps=200).resolve(garment, directions, body, Residual.none(16, CPU))
    assert 0 < residual.steps < 200


@pytest.mark.parametrize(
    ("trigger", "threshold", "runs"), [("sum", 0.9, True), ("sum", 1.1, False), ("mean", 0.9, False)]
)
def test_trigger(trained, sequence, pressed, trigger, threshold, runs):
    garment, directions, body = pressed
    depth = _stage(trained, sequence).planes(garment, body).depths(garment)
    amount = float(depth.sum())
    stage = _stage(trained, sequence, trigger=trigger, threshold=threshold * amount)
    assert (stage.resolve(garment, directions, body, Residual.none(16, CPU))[1].steps > 0) == runs


def test_the_map_goes_on_from_the_frame_before_only_where_it_is_carried(trained, sequence, pressed):
    garment, directions, body = pressed
    _, solved = _stage(trained, sequence, steps=200).resolve(garment, directions, body, Residual.none(16, CPU))
    _, carried = _stage(trained, sequence, carry=True).resolve(garment, directions, body, solved)
    assert carried.steps == solved.steps  # it is a solution already
    _, anew = _stage(trained, sequence, carry=False, steps=3).resolve(garment, directions, body, solved)
    assert anew.steps == 3


def test_depths_by_hand():
    planes = Planes(torch.zeros(2, 3), torch.tensor([[0.0, 0, 1], [0, 0, 1]]))
    assert planes.depths(torch.tensor([[0.3, 0.2, -0.5], [0, 0, 0.5]])).tolist() == [0.5, 0.0]


@pytest.mark.parametrize("betas", [(0.9, 0.999), (0.0, 0.9)])
def test_adam_is_torchs(betas):
    torch.manual_seed(0)
    gradients = torch.randn(5, 1, 3, 4, 4)
    parameter = torch.nn.Parameter(torch.zeros(1, 3, 4, 4))
    adam, residual = torch.optim.Adam([parameter], lr=1e-3, betas=betas), Residual.none(4, CPU)
    for gradient in gradients:
        parameter.grad = gradient
        adam.step()
        residual = residual.stepped(gradient, 1e-3, betas)
    np.testing.assert_allclose(residual.map, parameter.detach(), atol=1e-8)
