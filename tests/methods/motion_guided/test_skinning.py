import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from garmentbench.geometry.seeds import select_seeds
from garmentbench.methods.motion_guided.frames import body_frames, heading, link
from garmentbench.methods.motion_guided.skinning import (
    blend_weights,
    blended_rotations,
    displace,
    seed_transforms,
    skin,
)


@pytest.fixture
def points() -> tuple[torch.Tensor, ...]:
    torch.manual_seed(0)
    return torch.randn(1, 9, 3).double(), torch.randn(4, 3).double(), torch.rand(4).double() + 0.5


@pytest.mark.parametrize("axes", ["world", "heading"])
def test_a_rigid_motion_of_the_whole_body_moves_the_garment_rigidly(sequence, axes):
    seeds = select_seeds(sequence.template, 12)
    turn, shift = Rotation.from_rotvec([0.3, -0.5, 1.2]).as_matrix(), np.array([3.0, -2.0, 0.5])
    moved = (sequence.template.body.rest.astype(float) @ turn.T + shift)[None]
    frames = body_frames(moved, seeds, "frame", axes, torch.device("cpu"))
    garment = torch.from_numpy(sequence.template.garment.rest)[None]
    canonical = torch.from_numpy(seeds.rest)
    weights = blend_weights(garment, canonical, torch.full((12,), 0.05))
    posed = skin(garment, weights, seed_transforms(frames.pose.rotations, canonical, frames.pose.seeds))
    np.testing.assert_allclose(frames.world(posed)[0], garment[0].numpy() @ turn.T + shift, atol=2e-6)


def test_the_heading_is_the_turn_about_the_vertical(sequence):
    seeds = select_seeds(sequence.template, 12)
    upright, lean = Rotation.from_euler("z", 0.8).as_matrix(), Rotation.from_euler("x", 0.3).as_matrix()
    canonical = seeds.rest - seeds.rest.mean(axis=0)
    np.testing.assert_allclose(heading(canonical @ upright.T[None], seeds.rest)[0], upright, atol=1e-6)
    leaning = heading(canonical @ (upright @ lean).T[None], seeds.rest)[0]
    np.testing.assert_allclose(leaning[2], [0, 0, 1])
    assert abs(Rotation.from_matrix(leaning).as_rotvec()[2] - 0.8) < 0.1


def test_coordinates_go_to_a_frame_and_back_and_from_one_to_the_next(sequence):
    frames = body_frames(
        sequence.body[:4], select_seeds(sequence.template, 12), "frame", "heading", torch.device("cpu")
    )
    points = sequence.garment[:4]
    np.testing.assert_allclose(frames.world(frames.local(points)), points, atol=1e-6)
    before, now = frames.at(torch.arange(3)), frames.at(torch.arange(1, 4))
    np.testing.assert_allclose(link(before, now)(before.local(points[:3])), now.local(points[:3]), atol=1e-6)


def test_seeds_at_rest_leave_the_garment_where_it_is(points):
    garment, seeds, radii = points
    still = seed_transforms(torch.eye(3).double().expand(1, 4, 3, 3), seeds, seeds[None])
    assert (skin(garment, blend_weights(garment, seeds, radii), still) - garment).abs().max() < 1e-12


def test_a_vertex_follows_the_seed_whose_kernel_reaches_it():
    seeds = torch.tensor([[0.0, 0, 0], [1, 0, 0]])
    halfway = torch.tensor([[[0.5, 0, 0]]])
    assert blend_weights(halfway, seeds, torch.tensor([0.1, 0.1]))[0, 0].tolist() == pytest.approx([0.5, 0.5])
    assert blend_weights(halfway, seeds, torch.tensor([0.1, 0.05]))[0, 0, 0] > 0.99


def test_blended_rotations_are_the_derivative_at_fixed_weights(points):
    garment, seeds, radii = points
    torch.manual_seed(1)
    transforms, weights = torch.randn(1, 4, 12).double(), blend_weights(garment, seeds, radii)
    push = torch.randn_like(garment)
    change = skin(garment + push, weights, transforms) - skin(garment, weights, transforms)
    expected = (blended_rotations(weights, transforms) @ push[..., None])[..., 0]
    assert (change - expected).abs().max() < 1e-12


def test_shapes_that_would_broadcast_unnoticed_are_refused_in_tests():
    with pytest.raises(Exception, match="frames"):
        displace(torch.zeros(5, 3), torch.eye(3)[None], torch.zeros(2, 5, 3))
