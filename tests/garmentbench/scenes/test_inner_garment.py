"""Scenes of two layers: which are refused, what they need, and what their sequences are made from."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import reference_identity, scene_template
from garmentbench.scenes.inner_garment import as_body, sewn
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene

SMOKE = preset("smoke")
INNER = 'garment = "tshirt"\nbody = "base"\nmotion = "catwalk"\nsplit = "test"\nframes = 20\n'
OUTER = INNER + 'worn_over = "inner.toml"\n'


@pytest.fixture
def scenes(tmp_path):
    """Writes the two scenes and reads the outer one."""

    def write(outer: str = OUTER, inner: str = INNER):
        (tmp_path / "inner.toml").write_text(inner)
        (tmp_path / "outer.toml").write_text(outer)
        return load_scene(str(tmp_path / "outer.toml"))

    return write


def test_the_garment_beneath_takes_the_place_of_the_body(scenes):
    scene = scenes()
    assert scene.worn_over.name == "inner" and scene.worn_over.worn_over is None
    template = scene_template(scene, SMOKE)
    assert (template.body.kind, template.body.name, template.body.labels) == ("garment", "tshirt", None)
    needs = template.needs
    assert needs.interaction_force and needs.interpenetration and needs.collision_stage
    assert not needs.body and not needs.part_radii


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('"base"', '"slim"', "body is base, that of inner slim"),
        ('"catwalk"', '"armspace-90"', "motion is Motion"),
        ("frames = 20", "frames = 20\nfps = 60.0", "fps is 30.0, that of inner 60.0"),
        ("frames = 20", "frames = 19", "20 frames over 19"),
        ("frames = 20", 'frames = 20\nworn_over = "inner.toml"', "itself worn over"),
    ],
)
def test_what_does_not_fit_beneath_is_refused(scenes, old, new, complaint):
    with pytest.raises(UserError, match=complaint):
        scenes(inner=INNER.replace(old, new))


def test_worn_over_something_that_is_no_scene(scenes):
    with pytest.raises(UserError, match="worn_over is 3; wanted the name of a scene"):
        scenes(INNER + "worn_over = 3\n")
    with pytest.raises(UserError, match="unknown scene"):
        scenes(INNER + 'worn_over = "tshirt-armspace-91"\n')


def test_identity_depends_on_the_scene_beneath_and_on_the_bodies_that_are_used(scenes, tmp_path, monkeypatch):
    before = reference_identity(scenes(), SMOKE)
    assert reference_identity(scenes(inner=INNER + "[material]\nfriction = 0.5\n"), SMOKE) != before
    assert reference_identity(scenes(), SMOKE) == before
    monkeypatch.setattr("garmentbench.paths.BODIES", tmp_path)
    for name in ("base", "slim"):
        (tmp_path / f"{name}-small.npz").write_bytes(b"1")
    first = reference_identity(scenes(), SMOKE)
    (tmp_path / "slim-small.npz").write_bytes(b"2")
    assert reference_identity(scenes(), SMOKE) == first
    slim = scenes(OUTER.replace("base", "slim"), INNER.replace("base", "slim"))
    assert reference_identity(slim, SMOKE) != reference_identity(replace(slim, body="base"), SMOKE)
    (tmp_path / "base-small.npz").write_bytes(b"2")  # every warm-up begins in it
    assert reference_identity(scenes(), SMOKE) != first


def test_seams_of_the_garment_beneath_are_sewn():
    tube = tiny_sequence().template.garment
    body = as_body(tube)
    assert len(body.rest) == len(tube.rest) - len(tube.seams)
    pairs = np.sort(body.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, counts = np.unique(pairs, axis=0, return_counts=True)
    assert (counts == 1).sum() == 2 * 14  # the tube's two ends
    moved = np.stack([tube.rest, tube.rest + 1])
    assert np.array_equal(sewn(tube, moved)[1], body.rest + 1)
