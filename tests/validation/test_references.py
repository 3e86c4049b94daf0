"""The reference of every garment, as its training scene has it: whole, outside of what it is worn on, and of itself."""

from dataclasses import replace

import pytest

from garmentbench.reference import reference_scores
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.simulation.simulate import simulate

GARMENTS = ("tshirt", "bodysuit", "pleated_skirt", "dress", "over_skirt")
PERCENT = 0.1  # of the vertices inside: what is asked of every reference


@pytest.fixture(scope="module", params=GARMENTS)
def reference(request):
    return simulate(load_scene(f"{request.param}-armspace-75"), preset("smoke"))


def test_it_is_stable_and_not_inside(reference):
    assert reference.info["simulation"]["status"] == "ok"
    assert reference_scores(reference)["interpenetration_strict"] <= PERCENT


def test_it_does_not_pass_through_itself(reference):
    assert reference_scores(reference)["self_intersection"] <= 0.5


def test_a_bodysuit_needs_self_contact():
    """Without it, armpits and the crotch pass through themselves."""
    scene = replace(load_scene("bodysuit-catwalk"), frames=15)
    alone = replace(scene, simulation=replace(scene.simulation, self_contact=False))
    touching, passing = (reference_scores(simulate(s, preset("laptop")))["self_intersection"] for s in (scene, alone))
    assert touching < 0.1 < 0.3 < passing
