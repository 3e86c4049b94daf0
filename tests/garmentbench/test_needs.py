"""What a scene needs follows from its body, garment, motion and material."""

import numpy as np
import pytest

from garmentbench.needs import least_queries, of_template, scene_parts, turned
from garmentbench.reference import scene_template
from garmentbench.scenes.presets import MESH_SIZES, preset
from garmentbench.scenes.wardrobe import load_scene


def parts_of(scene: str) -> dict:
    return {part.name: part for part in of_template(scene_template(load_scene(scene), MESH_SIZES["smoke"]))}


def test_a_skirt_needs_nothing_far_above_it():
    parts = parts_of("pleated_skirt-armspace-90")
    assert parts["collision_stage"].needed and parts["sdf"].needed and parts["part_radii"].needed
    assert not parts["far_seeds"].needed and parts["far_seeds"].amount > 0.5
    assert "above it" in parts["far_seeds"].because


def test_a_stick_has_no_inside_no_parts_and_nothing_far():
    parts = parts_of("sheet-stick-b")
    assert parts["interaction_force"].needed and parts["pins"].needed
    assert not any(parts[name].needed for name in ("sdf", "part_radii", "collision_stage", "interpenetration"))
    assert "far_seeds" not in parts and "far_body" not in parts


def test_what_only_the_scene_can_say():
    parts = {part.name: part for part in scene_parts(load_scene("sheet-stick-b"), preset("smoke"))}
    assert not parts["layers"].needed and not parts["rest_angles"].needed and parts["self_contact"].needed
    assert parts["all_queries"].amount == 6 and not parts["all_queries"].needed  # 29 mm a frame in steps of 5 mm


def test_queries_keep_the_body_within_the_cloth_s_thickness():
    assert [least_queries(step, 0.005) for step in (0.0, 0.005, 0.0051, 0.04)] == [1, 1, 2, 8]


def test_how_far_a_body_turns():
    """A square that turns by 0, 30 and -60 degrees, and walks and bobs meanwhile."""
    rest = np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 1]], float)
    angles = np.radians([0, 30, -60])
    frames = []
    for k, a in enumerate(angles):
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        frames.append(rest @ turn.T + [k, 2 * k, 0.1 * k])
    assert turned(rest, np.array(frames)) == pytest.approx(90)
