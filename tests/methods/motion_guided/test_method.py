from dataclasses import replace

import numpy as np
import pytest
import torch

from garmentbench.errors import UserError
from garmentbench.method import BodyFrame, History
from garmentbench.methods.motion_guided import MotionGuided
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.samples import Recorded
from garmentbench.methods.motion_guided.stage1 import stage1_loss, training_frames
from garmentbench.methods.motion_guided.stage2 import sample_inputs, stage2_loss


def roll_out(method, sequence, frames=4, start=3):
    state = method.begin(sequence.template, History.before(sequence, start))
    garments = []
    for t in range(start, start + frames):
        garment, state = method.step(state, BodyFrame(sequence.body[t]))
        garments.append(garment)
    return np.array(garments), state


def test_roll_out_gives_garments_that_depend_on_the_body(trained, sequence):
    garments, _ = roll_out(trained, sequence)
    assert garments.shape == (4, *sequence.garment.shape[1:]) and garments.dtype == np.float32
    assert np.isfinite(garments).all()
    other, _ = roll_out(trained, replace(sequence, body=sequence.body[::-1].copy()))
    assert np.abs(garments - other).max() > 1e-3


def test_a_saved_method_predicts_the_same(trained, sequence, tmp_path):
    trained.save(tmp_path)
    again = MotionGuided.load(tmp_path)
    assert again.config == trained.config
    np.testing.assert_array_equal(roll_out(again, sequence)[0], roll_out(trained, sequence)[0])


def test_a_step_leaves_its_state_as_it_was(trained, sequence):
    state = trained.begin(sequence.template, History.before(sequence, 5))
    body = BodyFrame(sequence.body[5])
    np.testing.assert_array_equal(trained.step(state, body)[0], trained.step(state, body)[0])


def test_moving_the_scene_away_moves_the_prediction_alike(trained, sequence):
    shift = np.array([64.0, -128.0, 32.0], np.float32)
    moved = replace(sequence, garment=sequence.garment + shift, body=sequence.body + shift)
    config = replace(trained.config, collision=replace(trained.config.collision, enabled=False))
    without = MotionGuided(trained.canonical, config, trained.generative, trained.dynamics)
    # float32 at 128 m has steps of 8e-6 m, which rotations of 4 cm wide rings turn into 1e-4 m.
    np.testing.assert_allclose(roll_out(without, moved)[0] - shift, roll_out(without, sequence)[0], atol=1e-3)


def test_another_body_shape_is_followed_with_the_training_bodys_canonical_pose(trained, sequence):
    wide = np.array([1.1, 1.1, 1.0], np.float32)
    body = replace(sequence.template.body, rest=sequence.template.body.rest * wide)
    centre = sequence.body.mean(axis=1, keepdims=True)
    stout = replace(
        sequence, template=replace(sequence.template, body=body), body=(sequence.body - centre) * wide + centre
    )
    garments, _ = roll_out(trained, stout)
    assert np.linalg.norm(garments - stout.garment[3:7], axis=-1).mean() < 0.1


def test_another_garment_is_refused_in_one_line(trained, sequence):
    whole = sequence.template.garment
    garment = replace(whole, rest=whole.rest[:-1], uv=whole.uv[:-1])
    with pytest.raises(UserError, match="trained on a garment of 90 vertices"):
        trained.begin(replace(sequence.template, garment=garment), History.before(sequence, 3))


def test_a_scene_without_a_body_is_refused_in_one_line(sequence, config, store):
    bare = replace(sequence, template=replace(sequence.template, body=None), body=None)
    with pytest.raises(UserError, match="has none"), store.open("train", {"seed": 9}) as run:
        MotionGuided.fit((bare,), config, run)


def test_not_a_number_is_returned_as_it_is(trained, sequence):
    past = History.before(sequence, 3)
    history = replace(past, garments=np.full_like(past.garments, np.nan))
    state = trained.begin(sequence.template, history)
    garment, state = trained.step(state, BodyFrame(sequence.body[3]))
    assert np.isnan(garment).any()


@pytest.mark.parametrize("linear_paths", [True, False])
def test_every_parameter_gets_a_gradient(sequence, config, linear_paths):
    torch.manual_seed(0)
    sizes, cpu = replace(config.model, linear_paths=linear_paths), torch.device("cpu")
    canonical = Canonical.of(sequence.template, sizes)
    model = GenerativeModel(canonical, sizes)
    pressed = sequence.garment - 0.4 * (sequence.garment - sequence.body.mean(axis=1, keepdims=True))  # into the body
    frames = training_frames((replace(sequence, garment=pressed),), canonical, sizes, cpu)
    chosen = torch.tensor([4, 9])
    pose = frames.body.pose.at(chosen)
    stage1_loss(model, None, frames.garments[chosen], pose, 0, config.stage1, torch.Generator())["total"].backward()
    _all_moved(model)
    model.requires_grad_(False)
    dynamics = DynamicEncoder(sizes, len(model.canonical_seeds), replace(config.stage2, pose_path=linear_paths))
    sample = Recorded(model, frames).at(chosen)
    inputs = sample_inputs(model, sample, config.stage2)
    assert inputs.strength.max() > 0
    stage2_loss(model, dynamics, sample, inputs, config.stage2)["total"].backward()
    _all_moved(dynamics)


def _all_moved(module):
    idle = [n for n, p in module.named_parameters() if p.grad is None or not p.grad.abs().max() > 0]
    assert idle == []


def test_what_is_pushed_out_is_kept_whether_the_residual_is_carried_on_or_not(trained, sequence):
    """With `carry` a stage without a residual of its own hands on the one it was given: the garment is pushed still."""
    ends = []
    for carry in (False, True):
        options = replace(trained.config.collision, solver="push", carry=carry, threshold=0.0, clearance=0.02)
        method = MotionGuided(
            trained.canonical, replace(trained.config, collision=options), trained.generative, trained.dynamics
        )
        state = method.begin(sequence.template, History.before(sequence, 3))
        thick = sequence.body[3] * np.float32([1.3, 1.3, 1.0])  # the tube is inside
        garment, after = method.step(state, BodyFrame(thick))
        ends.append(np.abs(garment - after.before_collision).max())
    assert ends[0] > 0.01 and ends[1] == pytest.approx(ends[0], abs=1e-6)


def test_denormal_numbers_are_there_again_after_a_step(trained, sequence):
    """They are the whole thread's: without them scipy's KDTree of points of which half have a coordinate of 0 recursed
    until the process died."""
    trained.step(trained.begin(sequence.template, History.before(sequence, 3)), BodyFrame(sequence.body[3]))
    assert np.nextafter(0.0, 1.0) * np.ones(1) > 0
