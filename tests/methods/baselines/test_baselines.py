"""The baselines, on scenes where the right answer is known, and through the whole road on a tiny one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.evaluation.rollout import one_step, roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.blend_skinning import Skin, lift, place
from garmentbench.method import BodyFrame, History
from garmentbench.methods import load_method
from garmentbench.methods.baselines.rollouts import TrainedDynamics, config_for
from garmentbench.metrics.l2 import l2
from garmentbench.pipeline.train import training_run

CLOSED_FORM = ("skinning", "hold", "constant_velocity", "linear_subspace", "static_ridge")
BASELINES = (*CLOSED_FORM, "subspace_network", "linear_memory", "pose_gru")
KINDS = ("human", "object", None)


def fitted(name, train):
    method = load_method(name)
    few = config_for("smoke") if issubclass(method, TrainedDynamics) else method.Config()
    return method.fit((train,), few, training_run())


def error_cm(method, test, run=roll_out):
    roll = run(method, test)
    assert roll.status == "ok", roll.message
    return l2(roll.garment[3:], test.garment[3:])


def rigid(sequence, offset=0.0):
    """The same body and garment carried about rigidly: garment and body turn, walk and lean together."""
    template = sequence.template
    t = np.arange(len(sequence)) / 30
    turns = Rotation.from_euler("zyx", np.stack([1.5 * t, 0.4 * np.sin(3 * t), 0.2 * t], axis=1)).as_matrix()
    walk = np.stack([t, 0.3 * t, 0.1 * np.sin(5 * t)], axis=1)[:, None]

    def carried(rest):
        return (rest @ np.swapaxes(turns, 1, 2) + walk).astype(np.float32)

    return replace(
        sequence, garment=carried(template.garment.rest + np.float32(offset)), body=carried(template.body.rest)
    )


@pytest.mark.parametrize("name", CLOSED_FORM)
def test_what_moves_with_the_body_is_predicted_exactly(name):
    sequence = rigid(tiny_sequence(60))
    assert error_cm(fitted(name, sequence), sequence) < 1e-3


@pytest.mark.parametrize("name", ["hold", "constant_velocity"])
def test_hold_keeps_an_offset_in_the_body_own_frame(name):
    sequence = rigid(tiny_sequence(40), offset=[0.02, 0.01, 0.03])
    assert error_cm(fitted(name, sequence), sequence) < 1e-3
    assert error_cm(fitted("skinning", sequence), sequence) == pytest.approx(100 * 0.0014**0.5, rel=1e-3)


def test_constant_velocity_continues_a_motion_in_the_body_own_frame():
    """A garment that slides up a turning body by 2 mm a frame."""
    still = rigid(tiny_sequence(30))
    skin, slide = Skin.of(still.template, 300), np.float32([0, 0, 0.002])
    slid = [place(skin.blend(b), still.template.garment.rest + t * slide) for t, b in enumerate(still.body)]
    sequence = replace(still, garment=np.array(slid, np.float32))
    assert error_cm(fitted("constant_velocity", sequence), sequence) < 1e-3
    assert error_cm(fitted("hold", sequence), sequence, one_step) == pytest.approx(0.2, rel=1e-2)
    assert error_cm(fitted("hold", sequence), sequence) == pytest.approx(0.2 * np.mean(np.arange(1, 28)), rel=1e-2)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", BASELINES)
def test_what_is_saved_is_what_was_fitted(name, kind, tmp_path):
    train, test = tiny_sequence(40, kind), tiny_sequence(20, kind, phase=1.0)
    method = fitted(name, train)
    method.save(tmp_path)
    read = load_method(name).load(tmp_path)
    np.testing.assert_array_equal(roll_out(read, test).garment, roll_out(method, test).garment)
    assert not any(p.suffix in (".pkl", ".pt") for p in tmp_path.iterdir())


@pytest.mark.parametrize("name", BASELINES)
def test_turning_and_moving_the_scene_moves_the_prediction(name):
    train, test = tiny_sequence(60), tiny_sequence(15, phase=1.0)
    turn = Rotation.from_euler("z", 1.1).as_matrix().T.astype(np.float32)
    shift = np.float32([3, -2, 0.5])
    moved = replace(test, garment=test.garment @ turn + shift, body=test.body @ turn + shift)
    method = fitted(name, train)
    prediction = roll_out(method, test).garment @ turn + shift
    np.testing.assert_allclose(roll_out(method, moved).garment, prediction, atol=2e-5)


def test_a_skin_carries_the_rest_garment_to_the_rest_body():
    template = tiny_sequence(4).template
    maps = Skin.of(template, 300).blend(template.body.rest)
    np.testing.assert_allclose(place(maps, template.garment.rest), template.garment.rest, atol=1e-6)


def test_an_object_may_be_taken_for_its_upright_root():
    """A stick that has rolled over, turned by 40 degrees and moved: cloth still hangs down."""
    sequence = tiny_sequence(4, "object")
    rest, garment = sequence.template.body.rest, sequence.template.garment.rest
    roll = Rotation.from_euler("z", 40, degrees=True) * Rotation.from_euler("x", 10, degrees=True)
    moved = (roll.apply(rest) + [1, 2, 3]).astype(np.float32)
    maps = Skin.of(sequence.template, 300, upright_objects=True).blend(moved)
    upright = Rotation.from_euler("z", 40, degrees=True).apply(garment - rest.mean(axis=0)) + moved.mean(axis=0)
    np.testing.assert_allclose(place(maps, garment), upright, atol=2e-2)
    np.testing.assert_allclose(maps[:, 2, :3], np.broadcast_to([0, 0, 1], (len(garment), 3)), atol=1e-6)
    human = tiny_sequence(4)
    skins = [Skin.of(human.template, 50, upright_objects=u).blend(human.body[3]) for u in (False, True)]
    np.testing.assert_array_equal(*skins)


def test_lift_undoes_place():
    sequence = tiny_sequence(10)
    maps = Skin.of(sequence.template, 50).blend(sequence.body[7])
    np.testing.assert_allclose(place(maps, lift(maps, sequence.garment[7])), sequence.garment[7], atol=1e-5)


def test_weights_are_a_gaussian_softmax():
    template = tiny_sequence(4).template
    skin = Skin.of(template, 20)
    distance = np.linalg.norm(template.garment.rest[0] - skin.seeds.rest, axis=1)
    plain = np.exp(-(distance**2) / (2 * 0.05**2))
    np.testing.assert_allclose(skin.weights[0], plain / plain.sum(), atol=1e-6)


def test_a_vertex_far_from_all_seeds_follows_the_nearest():
    template = tiny_sequence(4, "object").template
    far = replace(template, garment=replace(template.garment, rest=template.garment.rest * 6))
    skin = Skin.of(far, 20)
    np.testing.assert_allclose(skin.weights.sum(axis=1), 1, atol=1e-5)
    distance = np.linalg.norm(far.garment.rest[0] - skin.seeds.rest, axis=1)
    assert skin.weights[0].argmax() == distance.argmin()


def test_a_step_leaves_its_state_as_it_was():
    sequence = tiny_sequence(40)
    for name in BASELINES:
        method = fitted(name, sequence)
        state = method.begin(sequence.template, History.before(sequence, 3))
        first, _ = method.step(state, BodyFrame(sequence.body[3]))
        second, _ = method.step(state, BodyFrame(sequence.body[3]))
        np.testing.assert_array_equal(first, second)
