"""Bodies of any shape. Where Anny is installed, its base and slim bodies are those that are baked.

The rest needs no Anny.
"""

import importlib.util

import numpy as np
import pytest

from garmentbench.errors import UsageError, UserError
from garmentbench.paths import BODIES
from garmentbench.scenes import anny_bodies
from garmentbench.scenes.anny_bodies import Phenotype, bake_body
from garmentbench.scenes.bodies import body_names, load_body

needs_anny = pytest.mark.skipif(
    importlib.util.find_spec("anny") is None, reason="Anny is not installed (pip install anny)"
)


@pytest.fixture
def without_anny(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "anny", None)


def test_points_on_a_surface_go_with_it():
    """Stretched to twice the height and moved, every point keeps its place on its triangle."""
    base, full = load_body("base", "small").body, load_body("base", "full").body
    onto = full.rest.astype(np.float64) * [1, 1, 2] + [0.3, 0.0, 0.0]
    carried = anny_bodies._carried(base.rest, full.rest, full.faces, onto)
    np.testing.assert_allclose(carried, base.rest.astype(np.float64) * [1, 1, 2] + [0.3, 0.0, 0.0], atol=1e-4)


def test_the_slim_body_is_the_base_body_carried():
    """The small slim body, made from the full one as a user's body would be."""
    full = [load_body(name, "full").body for name in ("base", "slim")]
    carried = anny_bodies._carried(load_body("base", "small").body.rest, full[0].rest, full[0].faces, full[1].rest)
    np.testing.assert_allclose(carried, load_body("slim", "small").body.rest, atol=1e-4)


def test_a_mesh_that_turns_inside_out_is_refused():
    with np.load(BODIES / "base-small.npz") as data:
        base = dict(data)
    anny_bodies._check("mine", base["rest"] * [1.1, 1.0, 0.9], base)
    with pytest.raises(UserError, match="'mine' turns inside out"):
        anny_bodies._check("mine", base["rest"] * [-1.0, 1.0, 1.0], base)


@pytest.mark.parametrize(
    ("name", "shape", "complaint"),
    [
        ("mine", Phenotype(weight=1.2), "--weight is 1.2; wanted from 0 to 1"),
        ("base", Phenotype(), "there is a body 'base' already"),
        ("../mine", Phenotype(), "wanted letters, digits and _"),
        ("", Phenotype(), "wanted letters, digits and _"),
    ],
)
def test_wrong_calls(home, without_anny, name, shape, complaint):
    with pytest.raises(UsageError, match=complaint):
        bake_body(name, shape)


def test_without_anny_there_is_advice(home, without_anny):
    with pytest.raises(UserError, match="Anny is not installed.*pip install anny"):
        bake_body("mine", Phenotype())
    assert "mine" not in body_names()


@needs_anny
def test_a_baked_body_is_whole_and_of_its_shape(home):
    paths = bake_body("mine", Phenotype(muscle=0.4, weight=0.15))
    assert paths == [home / "bodies" / "mine-full.npz", home / "bodies" / "mine-small.npz"] and "mine" in body_names()
    for size in ("full", "small"):
        mine, slim = load_body("mine", size), load_body("slim", size)
        np.testing.assert_allclose(mine.body.rest, slim.body.rest, atol=1e-4)
        np.testing.assert_allclose(mine.joints, slim.joints, atol=1e-6)
        np.testing.assert_array_equal(mine.weights, slim.weights)
