"""A scene of two layers from its files to its sequence: a T-shirt over a T-shirt."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench import sequence_file
from garmentbench.garments import load_garment
from garmentbench.geometry.mesh import vertex_normals
from garmentbench.layers import sewn
from garmentbench.metrics.interpenetration_strict import signed_distances
from garmentbench.presets import preset
from garmentbench.scene import inner_scene, load_scene
from garmentbench.simulation.simulate import measure_uncertainty, simulate

SMOKE = preset("smoke")
INNER = 'garment = "tshirt"\nbody = "slim"\nmotion = "armspace-90"\nsplit = "test"\n'
MATERIAL = "[material]\nfriction = 0.2\n"


def wide_or_not(name: str, size: str):
    """The baked garments, and "wide", a T-shirt 15 mm farther out."""
    garment = load_garment("tshirt" if name == "wide" else name, size)
    if name == "wide":
        garment = replace(garment, name=name, rest=garment.rest + 0.015 * vertex_normals(garment.rest, garment.faces))
        a, b = garment.seams.T
        garment.rest[b] = garment.rest[a]
    return garment


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The outer scene, its sequence and the inner scene's own."""
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "inner.toml").write_text(INNER + "frames = 12\n" + MATERIAL)
    outer = INNER.replace("tshirt", "wide") + 'frames = 8\nworn_over = "inner.toml"\n'
    (folder / "outer.toml").write_text(outer)
    scene = load_scene(str(folder / "outer.toml"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("garmentbench.simulation.outfit.load_garment", wide_or_not)
        sequence = simulate(scene, SMOKE)
        uncertainty = measure_uncertainty(scene, SMOKE, sequence, frames=4)
        return scene, sequence, simulate(inner_scene(scene), SMOKE), uncertainty


def test_the_layer_beneath_moves_as_in_its_own_scene(made):
    _, sequence, inner, _ = made
    assert len(sequence) == 8
    assert np.array_equal(sequence.body, sewn(inner.template.garment, inner.garment[:8]))


def test_the_garment_beneath_is_the_body_of_the_sequence(made, tmp_path):
    _, sequence, inner, _ = made
    assert (sequence.template.garment.name, sequence.template.body.name) == ("wide", "tshirt")
    assert sequence.template.body.kind == "garment" and sequence.info["worn_over"].endswith("inner.toml")
    beneath = sequence.info["simulation"]["beneath"]
    assert beneath["material"]["friction"] == 0.2 and sequence.info["simulation"]["material"]["friction"] == 0.4
    assert beneath["substeps"] == inner.info["simulation"]["substeps"]
    sequence_file.save(sequence, tmp_path / "outer.h5")
    assert sequence_file.load(tmp_path / "outer.h5").template.needs == sequence.template.needs


def test_the_outer_garment_stays_outside_of_the_inner_one(made):
    _, sequence, _, _ = made
    distance = signed_distances(sequence.garment, sequence.body, sequence.template.body.faces)
    assert (distance < 0).mean() < 0.002 and sequence.info["simulation"]["status"] == "ok"


def test_uncertainty_is_that_of_both_layers(made):
    _, _, _, found = made
    assert 0 < found["cm"] < 0.5 and found["frames"] == 4
