"""From a scene to its sequence."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.progress import listening
from garmentbench.scenes.material import Material, Settings
from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import Motion, Scene
from garmentbench.simulation.simulate import simulate

SMOKE = preset("smoke")
SCENE = Scene("short", "tshirt", "base", Motion("armspace-90"), "test", frames=6)


@pytest.fixture(scope="module")
def sequence():
    return simulate(SCENE, SMOKE)


def test_sequence_holds_its_frames_and_how_it_was_made(sequence):
    assert len(sequence) == 6 and sequence.garment.dtype == sequence.body.dtype == np.float32
    made = sequence.info["simulation"]
    assert made["status"] == "ok" and made["first_bad_frame"] is None
    assert made["substeps"] % made["settings"]["queries"] == 0
    assert 0 < made["strain_mean"] < 2
    assert made["material"]["density"] == 0.2


def test_same_scene_gives_the_same_bytes(sequence):
    assert simulate(SCENE, SMOKE).garment.tobytes() == sequence.garment.tobytes()


def test_seam_copies_stay_together(sequence):
    a, b = sequence.template.garment.seams.T
    assert np.array_equal(sequence.garment[:, a], sequence.garment[:, b])


def test_progress_is_told():
    told = []
    with listening(lambda label, done, total: told.append((label, done, total))):
        simulate(SCENE, SMOKE)
    label, done, total = told[-1]
    assert label == "simulate short" and done == total >= SCENE.frames


def test_moved_and_turned_scene_moves_alike():
    """Slowed down, so that rounding doesn't grow."""
    slow = replace(SCENE, simulation=Settings(settling=60.0))
    far = replace(slow, motion=replace(SCENE.motion, translate=(1000.0, 0.0, 0.0), turn=90.0))
    back = simulate(far, SMOKE).garment.astype(np.float64) - [1000, 0, 0]
    back = np.stack([back[..., 1], -back[..., 0], back[..., 2]], axis=-1)
    assert np.linalg.norm(back - simulate(slow, SMOKE).garment, axis=-1).mean() < 5e-4


def test_pushed_start_ends_elsewhere(sequence):
    pushed = simulate(replace(SCENE, simulation=Settings(start_noise=0.01)), SMOKE)
    assert 1e-6 < np.linalg.norm(pushed.garment - sequence.garment, axis=-1).mean() < 0.05


def test_step_beyond_its_bound_is_refused_once_nothing_finite_is_left():
    with pytest.raises(UserError, match="lower step_margin .it is 1000"):
        simulate(
            replace(
                SCENE, material=Material(stretch=1e8, drag=0.0, drag_along=0.0), simulation=Settings(step_margin=1e3)
            ),
            SMOKE,
        )
