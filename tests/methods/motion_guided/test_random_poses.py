"""Random poses, the displacement space and the closed-form linear path."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from garmentbench.geometry.seeds import select_seeds
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.closed_form import random_garments, ridge, solve_encoder_path
from garmentbench.methods.motion_guided.config import Posing
from garmentbench.methods.motion_guided.displacement_space import set_displacement_space, smooth_modes, undo_pose
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.limbs import find_limbs
from garmentbench.methods.motion_guided.posing import RandomPoses
from garmentbench.methods.motion_guided.samples import Recorded, Reposed
from garmentbench.methods.motion_guided.stage1 import training_frames
from garmentbench.methods.training import generator

CPU = torch.device("cpu")


@pytest.fixture(scope="module")
def prepared(sequence, linear_config):
    """Canonical pose, untrained model with its displacement space, training frames, and limbs."""
    torch.manual_seed(0)
    canonical = Canonical.of(sequence.template, linear_config.model)
    model = GenerativeModel(canonical, replace(linear_config.model, latent=64)).requires_grad_(False)
    frames = training_frames((sequence,), canonical, linear_config.model, CPU)
    set_displacement_space(model, canonical, frames.garments, frames.body.pose)
    return canonical, model, frames, find_limbs(sequence.template.body, canonical.seeds)


def test_the_cylinders_lower_half_is_its_only_limb(sequence, prepared):
    canonical, _, _, limbs = prepared
    assert limbs.joints.shape == (1, 3)
    np.testing.assert_allclose(limbs.joints[0], [0, 0, 0.05], atol=0.051)
    height = canonical.seeds.rest[:, 2]
    assert (limbs.shares[0, height > 0.01] == 0).all() and (limbs.shares[0, height < -0.1] == 1).all()
    assert canonical.seeds.rest[limbs.carriers[0], 2] > 0


def test_an_object_has_no_limbs(object_sequence):
    seeds = select_seeds(object_sequence.template, 12)
    assert find_limbs(object_sequence.template.body, seeds).shares.shape == (0, 12)


def test_no_turn_changes_nothing_and_a_whole_turn_is_rigid(prepared):
    _, model, frames, limbs = prepared
    pose = frames.body.pose.at(torch.tensor([2, 5]))
    poses = RandomPoses(limbs, model.canonical_seeds, Posing(0.0, 0.0))
    same = poses.turned(pose, *poses.draw(2, generator(0)))
    for a, b in zip(vars(same).values(), vars(pose).values(), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-6)
    whole, limb_turns = RandomPoses(limbs, model.canonical_seeds, Posing(0.0, 0.5)).draw(2, generator(0))
    turned = poses.turned(pose, whole, limb_turns)
    np.testing.assert_allclose(turned.seeds, pose.seeds @ whole.transpose(1, 2), atol=1e-6)
    np.testing.assert_allclose(turned.rotations, whole[:, None] @ pose.rotations, atol=1e-6)


def test_a_limb_turns_about_its_joint_and_leaves_the_trunk(prepared):
    canonical, model, frames, limbs = prepared
    poses, pose = RandomPoses(limbs, model.canonical_seeds, Posing()), frames.body.pose.at(torch.tensor([3]))
    turned = poses.turned(pose, torch.eye(3)[None], torch.tensor([[[0.4, 0.0, 0.0]]]))
    trunk, far = limbs.shares[0] == 0, limbs.shares[0] == 1
    np.testing.assert_allclose(turned.seeds[0, trunk], pose.seeds[0, trunk], atol=1e-6)
    turn = torch.from_numpy(Rotation.from_rotvec([0.4, 0.0, 0.0]).as_matrix()).float()
    apart = pose.seeds[0, far] - pose.seeds[0, far][0]
    np.testing.assert_allclose(turned.seeds[0, far] - turned.seeds[0, far][0], apart @ turn.T, atol=1e-6)
    np.testing.assert_allclose(turned.normals[0, far], pose.normals[0, far] @ turn.T, atol=1e-6)


def test_undoing_a_pose_gives_what_is_posed_as_the_garment(prepared):
    _, model, frames, _ = prepared
    pose = frames.body.pose
    displaced = undo_pose(model, frames.garments, pose, iterations=12)
    np.testing.assert_allclose(model.pose(displaced, pose), frames.garments, atol=1e-5)


def test_the_displacement_space_holds_the_training_frames(prepared):
    _, model, frames, _ = prepared
    displaced = (undo_pose(model, frames.garments, frames.body.pose) - model.space_mean).flatten(1)
    directions = torch.nn.functional.normalize(model.space_basis, dim=1)
    np.testing.assert_allclose(directions @ directions.T, np.eye(64), atol=1e-4)
    left = displaced - displaced @ directions.T @ directions
    assert left.norm() < 0.1 * displaced.norm()


def test_smooth_modes_leave_seams_closed(prepared):
    canonical, _, _, _ = prepared
    modes = smooth_modes(canonical)
    gap = np.abs(modes[canonical.seams[:, 0], :8] - modes[canonical.seams[:, 1], :8])
    assert gap.max() < 0.2 * np.abs(modes[:, :8]).max()


def test_ridge_by_hand():
    x, y = torch.tensor([[0.0], [1.0], [2.0]]), torch.tensor([[1.0], [3.0], [5.0]])
    weight, bias = ridge(x, y, 0.0)
    assert weight.item() == pytest.approx(2) and bias.item() == pytest.approx(1)
    weight, bias = ridge(x, y, 2 / 3)  # the variance of x is 2/3, so the slope halves
    assert weight.item() == pytest.approx(1) and bias.item() == pytest.approx(2)


def test_the_linear_path_reads_random_codes_off_their_garments(prepared):
    _, model, frames, limbs = prepared
    poses = RandomPoses(limbs, model.canonical_seeds, Posing(0.05, 0.05, 1.0))
    solve_encoder_path(model, poses, frames.body.pose, seed=0)
    codes, garments, pose = random_garments(model, poses, frames.body.pose, 64, generator(99))
    found = model.path(model.flat_descriptor(garments, pose.seeds))
    strong = slice(0, 4)
    assert (found - codes)[:, strong].square().mean() < 0.3 * codes[:, strong].square().mean()


def test_reposed_samples_without_any_turn_are_the_recorded_ones(prepared):
    _, model, frames, limbs = prepared
    recorded = Recorded(model, frames)
    reposed = Reposed(model, frames, recorded, RandomPoses(limbs, model.canonical_seeds, Posing()))
    t = torch.tensor([3, 8])
    plain, same = recorded.at(t), reposed.at(t, generator(0))
    for a, b in ((plain.past.motion, same.past.motion), (plain.past.carried, same.past.carried)):
        np.testing.assert_allclose(a, b, atol=2e-4)  # the blend weights' fixed point is found to 0.1 mm
    np.testing.assert_allclose(plain.code_before, same.code_before)
    whole = RandomPoses(limbs, model.canonical_seeds, Posing(0.0, 0.7))
    turned = Reposed(model, frames, recorded, whole).at(t, generator(0))
    speed, turned_speed = (s.past.motion.unflatten(-1, (2, 3)).norm(dim=-1) for s in (same, turned))
    np.testing.assert_allclose(turned_speed, speed, atol=1e-5)
