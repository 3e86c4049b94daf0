"""A scene of two layers from its files to its sequence: the over-skirt on the dress."""

import numpy as np
import pytest

from garmentbench import sequence_file
from garmentbench.geometry.signed_distance import signed_distances
from garmentbench.scenes.inner_garment import sewn
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.simulation.simulate import simulate

SMOKE = preset("smoke")
INNER = 'garment = "dress"\nbody = "slim"\nmotion = "armspace-90"\nsplit = "test"\n'
MATERIAL = "[material]\nbending = 1e-4\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The outer scene's sequence and the inner scene's own."""
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "inner.toml").write_text(INNER + "frames = 12\n" + MATERIAL + "friction = 0.2\n")
    outer = INNER.replace("dress", "over_skirt") + 'frames = 8\nworn_over = "inner.toml"\n' + MATERIAL
    (folder / "outer.toml").write_text(outer)
    scene = load_scene(str(folder / "outer.toml"))
    sequence = simulate(scene, SMOKE)
    return sequence, simulate(scene.worn_over, SMOKE)


def test_the_layer_beneath_moves_as_in_its_own_scene(made):
    sequence, inner = made
    assert len(sequence) == 8
    assert np.array_equal(sequence.body, sewn(inner.template.garment, inner.garment[:8]))


def test_the_garment_beneath_is_the_body_of_the_sequence(made, tmp_path):
    sequence, inner = made
    assert (sequence.template.garment.name, sequence.template.body.name) == ("over_skirt", "dress")
    assert sequence.template.body.kind == "garment" and sequence.info["worn_over"] == "inner"
    beneath = sequence.info["simulation"]["beneath"]
    assert beneath["material"]["friction"] == 0.2 and sequence.info["simulation"]["material"]["friction"] == 0.4
    assert beneath["substeps"] == inner.info["simulation"]["substeps"]
    sequence_file.save(sequence, tmp_path / "outer.h5")
    assert sequence_file.load(tmp_path / "outer.h5").template.needs == sequence.template.needs


def test_the_outer_garment_stays_outside_of_the_inner_one(made):
    sequence, _ = made
    distance = signed_distances(sequence.garment, sequence.body, sequence.template.body.faces)
    assert not (distance < 0).any() and sequence.info["simulation"]["status"] == "ok"
