"""A clip in a scene: the warm-up out of the A-pose, speed, freeze and place, too short clips, the scene file."""

from dataclasses import replace
from pathlib import Path

import bvh_example
import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.importing.motions.load import import_clip
from garmentbench.motion import animate
from garmentbench.motion.clip import save_clip
from garmentbench.motion.clip_animation import WARM_UP, load_clip
from garmentbench.reference import reference_identity
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.scene import Motion, Scene
from garmentbench.scenes.wardrobe import load_scene

LAPTOP = PRESETS["laptop"]
BASE = load_body("base", "small")
TOML = """garment = "tshirt"
body = "base"
split = "test"
frames = {frames}

[motion]
name = "clip"
file = "{file}"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A folder with a walk of three seconds, 30 cm aside and turned, as walk.bvh and walk.npz."""
    folder = tmp_path_factory.mktemp("clips")
    (folder / "walk.bvh").write_text(bvh_example.y_up(bvh_example.own_walk(BASE, 91)).text())
    clip = import_clip(folder / "walk.bvh", BASE, 30.0).clip
    save_clip(clip, BASE.joint_names, "", folder / "walk.npz")
    return folder


def positions(folder: Path, frames: int = 20, body: str = "base", file: str = "walk.npz", **motion) -> np.ndarray:
    scene = Scene("s", "tshirt", body, Motion("clip", file=str(folder / file), **motion), "test", frames)
    animation = animate(scene, LAPTOP)
    assert animation.body.name == body and animation.warm_up == WARM_UP
    return animation.positions


@pytest.mark.parametrize("body", ["base", "heavy"])
def test_warm_up_leads_from_rest_into_the_clip(folder, body):
    moving = positions(folder, body=body)
    assert moving.shape == (WARM_UP + 20, 5414, 3)
    np.testing.assert_allclose(moving[0], BASE.body.rest, atol=1e-7)
    assert np.abs(moving[1] - moving[0]).max() < 2e-3  # at rest, too
    acceleration = np.linalg.norm(np.diff(moving[: WARM_UP + 5], n=2, axis=0), axis=-1) * 30**2
    assert acceleration.max() < 130  # as the walks' own
    lowest = moving[..., 2].min(axis=1)
    assert lowest.min() > -1e-3 and lowest.max() < 0.005
    assert np.abs(moving[: WARM_UP // 2, :, :2].mean(axis=1)).max() < 0.1  # no walking about before it begins


def test_it_walks_ahead_as_the_recording_does(folder):
    moving = positions(folder, frames=60)
    clip = load_clip(folder / "walk.npz", BASE, 30.0).from_origin(0)
    hips = moving[WARM_UP:, BASE.weights[:, :2].sum(axis=1) > 0.6].mean(axis=1)
    path = hips - hips[0]
    np.testing.assert_allclose(path[:, 1], clip.root[15:75, 1] - clip.root[15, 1], atol=0.02)  # half a second in
    assert path[-1, 1] < -1.5


def test_a_recording_is_not_a_clip(folder):
    with pytest.raises(
        UserError, match="not a clip .*make one of the recording: garmentbench import-motion .*walk.bvh"
    ):
        positions(folder, file="walk.bvh")


def test_speed_freeze_and_place(folder):
    plain = positions(folder, frames=40)
    fast = positions(folder, frames=20, speed=2.0)
    assert np.ptp(fast[WARM_UP:].mean(axis=1)[:, 1]) == pytest.approx(
        np.ptp(plain[WARM_UP:].mean(axis=1)[:, 1]), rel=0.05
    )
    frozen = positions(folder, frames=40, freeze_after=10)
    np.testing.assert_array_equal(frozen[: WARM_UP + 11], plain[: WARM_UP + 11])
    assert (frozen[WARM_UP + 20 :] == frozen[WARM_UP + 20]).all()
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        positions(folder, turn=90.0, translate=(0.0, 5.0, 0.0)), plain[:80] @ quarter.T + [0, 5, 0], atol=1e-9
    )


def test_too_short_a_clip_says_how_many_frames_it_has(folder):
    with pytest.raises(UserError, match="77 frames asked for; .*walk.npz has 76 at 30 a second"):
        positions(folder, frames=77)
    assert len(positions(folder, frames=76)) == WARM_UP + 76


def test_a_scene_s_file_is_relative_to_it_and_counts_by_its_content(folder, tmp_path):
    places = []
    for place in (folder, tmp_path):
        (place / "a.toml").write_text(TOML.format(frames=20, file="walk.npz"))
        (place / "walk.npz").write_bytes((folder / "walk.npz").read_bytes())
        places.append(load_scene(str(place / "a.toml")))
    assert places[0].motion.file == str(folder / "walk.npz")
    identities = [reference_identity(scene, LAPTOP) for scene in places]
    assert identities[0] == identities[1]
    faster = replace(places[1], motion=replace(places[1].motion, speed=2.0))
    assert reference_identity(faster, LAPTOP) != identities[1]
    (tmp_path / "walk.npz").write_bytes((folder / "walk.bvh").read_bytes())
    assert reference_identity(places[1], LAPTOP) != identities[1]


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('file = "walk.bvh"', "", 'motion "clip" and its file go together'),
        ('name = "clip"', 'name = "armspace-75"', 'motion "clip" and its file go together'),
        ('file = "walk.bvh"', "file = 3", "file is 3; wanted a text in quotes"),
        ('file = "walk.bvh"', 'file = "walk.bvh"\nstart = "one"', "start is 'one'; wanted a number"),
        ('file = "walk.bvh"', 'file = "walk.bvh"\nstrat = 1.0', "did you mean 'start'"),
    ],
)
def test_what_a_scene_s_motion_says_wrong(folder, old, new, complaint):
    (folder / "wrong.toml").write_text(TOML.format(frames=20, file="walk.bvh").replace(old, new))
    with pytest.raises(UserError) as error:
        load_scene(str(folder / "wrong.toml"))
    assert complaint in str(error.value) and "\n" not in str(error.value)
