import numpy as np
import pytest
import torch

from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import nearest_vertices, plane_distances
from garmentbench.methods.motion_guided.body_surface import Planes
from garmentbench.methods.motion_guided.collision import CollisionStage, Residual
from garmentbench.methods.motion_guided.config import Collision
from garmentbench.methods.motion_guided.frames import Pose
from garmentbench.methods.motion_guided.push_out import neighbour_means


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
    return displaced[0].numpy(), directions[0].numpy(), body.rest


def _stage(trained, sequence, **options) -> CollisionStage:
    return CollisionStage(trained.canonical, sequence.template.body, Collision(map_size=16, **options))


def _share_inside(garment, body, sequence) -> float:
    normals = vertex_normals(body, sequence.template.body.faces)
    return float((plane_distances(garment, body, normals) < 0).mean())


def test_a_pressed_garment_comes_out_and_the_rest_hardly_moves(trained, sequence, pressed):
    garment, directions, body = pressed
    assert _share_inside(garment, body, sequence) > 0.1
    stage = _stage(trained, sequence, steps=200)
    out, residual = stage.resolve(garment, lambda: directions, body, Residual.none(16))
    assert _share_inside(out, body, sequence) < 0.01
    moved = np.linalg.norm(out - garment, axis=-1)
    assert moved[garment[:, 0] > 0.05].max() > 0.01
    assert moved[garment[:, 0] < -0.05].max() < 0.003


def test_it_ends_as_soon_as_nothing_penetrates(trained, sequence, pressed):
    garment, directions, body = pressed
    outside = garment.copy()
    outside[:, :2] *= 1.5
    same, residual = _stage(trained, sequence).resolve(outside, lambda: directions, body, Residual.none(16))
    assert same is outside and residual.steps == 0
    _, residual = _stage(trained, sequence, steps=200).resolve(garment, lambda: directions, body, Residual.none(16))
    assert 0 < residual.steps < 200


@pytest.mark.parametrize(
    ("trigger", "threshold", "runs"), [("sum", 0.9, True), ("sum", 1.1, False), ("mean", 0.9, False)]
)
def test_trigger(trained, sequence, pressed, trigger, threshold, runs):
    garment, directions, body = pressed
    depths = _stage(trained, sequence).surface.planes(garment, body).depths(garment)
    amount = float(np.maximum(depths, 0).sum())
    stage = _stage(trained, sequence, trigger=trigger, threshold=threshold * amount)
    assert (stage.resolve(garment, lambda: directions, body, Residual.none(16))[1].steps > 0) == runs


def test_the_map_goes_on_from_the_frame_before_only_where_it_is_carried(trained, sequence, pressed):
    garment, directions, body = pressed
    _, solved = _stage(trained, sequence, steps=200).resolve(garment, lambda: directions, body, Residual.none(16))
    _, carried = _stage(trained, sequence, carry=True).resolve(garment, lambda: directions, body, solved)
    assert carried.steps == solved.steps  # it is a solution already
    _, anew = _stage(trained, sequence, carry=False, steps=3).resolve(garment, lambda: directions, body, solved)
    assert anew.steps == 3


def test_depths_by_hand():
    planes = Planes(np.zeros((2, 3)), np.array([[0.0, 0, 1], [0, 0, 1]]))
    assert planes.depths(np.array([[0.3, 0.2, -0.5], [0, 0, 0.5]])).tolist() == [0.5, -0.5]


def test_planes_are_those_of_the_nearest_vertices_of_the_whole_body(trained, sequence):
    body, garment = sequence.body[7], sequence.garment[5]
    planes = _stage(trained, sequence).surface.planes(garment, body)
    _, nearest = nearest_vertices(garment, body)
    np.testing.assert_array_equal(planes.points, body[nearest])
    np.testing.assert_allclose(planes.normals, vertex_normals(body, sequence.template.body.faces)[nearest], atol=1e-6)


@pytest.mark.parametrize("trigger", ["sum", "mean"])
def test_the_gradient_is_that_of_the_loss(trained, sequence, pressed, trigger):
    garment, directions, body = pressed
    stage = _stage(trained, sequence, trigger=trigger, laplacian_weight=3.0)
    planes = stage.surface.planes(garment, body)
    offset = np.random.default_rng(0).normal(0, 1e-3, garment.shape)
    moved = torch.from_numpy(offset).requires_grad_()
    depths = torch.relu(
        ((torch.from_numpy(planes.points - garment) - moved) * torch.from_numpy(planes.normals)).sum(-1)
    )
    curved = torch.from_numpy(stage.laplacian.toarray()).double() @ moved
    collision = depths.sum() if trigger == "sum" else depths.mean()
    (moved.abs().mean() + 3.0 * curved.abs().mean() + 100.0 * collision).backward()
    behind = (depths > 0).numpy()
    np.testing.assert_allclose(stage.gradient(offset, behind, planes.normals), moved.grad, atol=1e-6)


def test_the_loss_by_hand(trained, sequence):
    """Two vertices are moved by 1 and 2 cm along x, one is behind its plane: |offset| and depth pull as they should."""
    stage = _stage(trained, sequence, laplacian_weight=0.0)
    offset, count = np.zeros((90, 3)), 90
    offset[3, 0], offset[5, 0] = 0.01, -0.02
    normals = np.tile([0.0, 0, 1], (90, 1))
    gradient = stage.gradient(offset, np.arange(90) == 5, normals)
    assert gradient[3] == pytest.approx([1 / (3 * count), 0, 0]) and gradient[5] == pytest.approx(
        [-1 / (3 * count), 0, -100]
    )
    assert not gradient[[0, 1, 2, 4]].any()


@pytest.mark.parametrize("betas", [(0.9, 0.999), (0.0, 0.9)])
def test_adam_is_torchs(betas):
    torch.manual_seed(0)
    gradients = torch.randn(5, 16, 3)
    parameter = torch.nn.Parameter(torch.zeros(16, 3))
    adam, residual = torch.optim.Adam([parameter], lr=1e-3, betas=betas), Residual.none(4)
    for gradient in gradients:
        parameter.grad = gradient
        adam.step()
        residual = residual.stepped(gradient.numpy(), 1e-3, betas)
    np.testing.assert_allclose(residual.map, parameter.detach(), atol=1e-8)


def test_pushing_leaves_nothing_behind_and_changes_the_garment_less(trained, sequence, pressed):
    garment, directions, body = pressed
    pushing = _stage(trained, sequence, solver="push", rounds=4)  # the tube is 14 vertices round
    out, _ = pushing.resolve(garment, lambda: directions, body, Residual.none(16))
    assert _share_inside(out, body, sequence) == 0
    adam, _ = _stage(trained, sequence, steps=200).resolve(garment, lambda: directions, body, Residual.none(16))
    moved, moved_by_adam = (np.linalg.norm(x - garment, axis=1) for x in (out, adam))
    assert moved.max() < 0.9 * moved_by_adam.max()
    assert moved[garment[:, 0] < -0.05].max() < 0.003
    outside = garment * np.float32([1.5, 1.5, 1])
    assert pushing.resolve(outside, lambda: directions, body, Residual.none(16))[0] is outside


def test_copies_of_a_point_follow_alike_where_the_cloth_is_smoothed(trained, sequence):
    c = trained.canonical
    means = neighbour_means(len(c.rest), c.faces, c.seams)
    one, other = sequence.template.garment.seams.T
    assert abs(means[one] - means[other]).max() == 0
    np.testing.assert_allclose(means @ np.ones(90), np.ones(90), atol=1e-6)
    row = means[20].toarray()[0]  # an inner vertex of the grid has six neighbours and itself
    assert np.flatnonzero(row).tolist() == [4, 5, 19, 20, 21, 35, 36] and np.allclose(row[row > 0], 1 / 7)
