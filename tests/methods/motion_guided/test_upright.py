"""An object that rolls: eq. 1 takes it for its upright root, as the baselines do."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from garmentbench.geometry.blend_skinning import Skin, place
from garmentbench.methods import load_method
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import SIZES, Model
from garmentbench.methods.motion_guided.frames import body_frames
from garmentbench.methods.motion_guided.generative import GenerativeModel

CPU = torch.device("cpu")


@pytest.fixture(scope="module")
def rolled(object_sequence) -> np.ndarray:
    """The object turned by 40 degrees about the vertical, half rolled over, and moved, shape (1, B, 3)."""
    rest = object_sequence.template.body.rest
    turn = Rotation.from_euler("z", 40, degrees=True) * Rotation.from_euler("x", 70, degrees=True)
    return (turn.apply(rest) + [1, 2, 3]).astype(np.float32)[None]


def _posed(sequence, body, options: Model) -> np.ndarray:
    """The rest garment as eq. 1 carries it, world [m], shape (V, 3)."""
    canonical = Canonical.of(sequence.template, options)
    model = GenerativeModel(canonical, options)
    frames = body_frames(body, canonical.seeds, options.seed_rotation, options.axes, CPU, canonical.upright)
    with torch.no_grad():
        return frames.world(model.pose(model.rest[None], frames.pose))[0]


@pytest.mark.parametrize("axes", ["world", "heading"])
def test_every_method_sees_an_object_through_the_same_frame(object_sequence, rolled, axes):
    options = Model(map_size=8, width=4, seeds=40, axes=axes)
    theirs = Skin.of(object_sequence.template, 40, upright_objects=True)
    garment = object_sequence.template.garment.rest
    expected = place(theirs.blend(rolled[0]), garment)
    np.testing.assert_allclose(_posed(object_sequence, rolled, options), expected, atol=1e-5)
    turned = replace(options, upright_objects=False)
    assert np.linalg.norm(_posed(object_sequence, rolled, turned) - expected, axis=1).mean() > 0.05
    for name in ("skinning", "hold", "constant_velocity"):
        kind = load_method(name)
        maps = kind(kind.Config()).skin_of(object_sequence.template).blend(rolled[0])
        np.testing.assert_allclose(maps[:, 2, :3], np.broadcast_to([0, 0, 1], (len(garment), 3)), atol=1e-6)


def test_descriptor_and_force_keep_to_the_points_on_the_surface(object_sequence, rolled):
    canonical = Canonical.of(object_sequence.template, Model(map_size=8, seeds=12))
    pose = body_frames(rolled, canonical.seeds, "frame", "world", CPU, upright=True).pose
    there = rolled[0, canonical.seeds.vertices]
    np.testing.assert_allclose(pose.seeds[0], there - there.mean(axis=0), atol=1e-5)
    assert (pose.anchors - pose.seeds).norm(dim=-1).max() > 0.05


def test_a_human_body_is_no_object(sequence):
    canonical = Canonical.of(sequence.template, Model(map_size=8, seeds=12))
    assert not canonical.upright
    pose = body_frames(sequence.body[:2], canonical.seeds, "frame", "world", CPU).pose
    assert torch.equal(pose.anchors, pose.seeds)


@pytest.mark.parametrize("size", SIZES)
def test_all_sizes_see_objects_upright(size):
    assert SIZES[size].model.upright_objects
