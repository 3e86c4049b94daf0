"""Fabrics: from measurements to a material by hand, and by name in a wardrobe and in a scene."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.cli import main
from garmentbench.errors import UserError
from garmentbench.scenes.fabrics import Fabric, fabric, fabrics
from garmentbench.scenes.material import Material
from garmentbench.scenes.wardrobe import load_scene, read_wardrobe

SCENE = 'garment = "tshirt"\nbody = "base"\nmotion = "catwalk"\nsplit = "test"\nframes = 20\n'
CLOTH = Fabric(
    about="",
    density=0.2,
    tension=(400.0, 900.0),
    shear=36.0,
    bending=(1e-5, 4e-5, 3e-5),
    friction=0.4,
    basis="typical",
    source="",
)


def test_a_material_by_hand():
    """8 / (3/400 + 3/900 + 1/36) = 207.194; bending 9/8 (1 + 2 4 + 3) / 4."""
    assert CLOTH.young == pytest.approx(207.194, rel=1e-5)
    assert CLOTH.rigidity == pytest.approx(3e-5)
    wanted = {"density": 0.2, "stretch": 621.583, "bending": 3.375e-5, "friction": 0.4}
    assert CLOTH.material == pytest.approx(wanted, rel=1e-5)


def test_the_modulus_is_that_of_the_mean_compliance():
    angle = np.linspace(0, np.pi, 1_000, endpoint=False)
    c, s = np.cos(angle) ** 2, np.sin(angle) ** 2
    assert CLOTH.young == pytest.approx(1 / np.mean(c**2 / 400 + s**2 / 900 + c * s / 36))


def test_what_friction_between_fibres_adds():
    """HB / k = 0.5e-3 / 50."""
    assert replace(CLOTH, bending=(2e-5,), hysteresis=1e-3).rigidity == pytest.approx(3e-5)


def test_a_sheet_without_threads_is_alike_in_all_directions():
    plain = replace(CLOTH, tension=(500.0, 500.0), shear=None)
    assert plain.young == pytest.approx(500.0)


def test_every_fabric_says_where_it_comes_from_and_lies_within_what_cloth_is():
    for name, cloth in fabrics().items():
        assert cloth.source and cloth.about, name
        assert cloth.drape is None or (cloth.drape[0] < cloth.drape[1] and cloth.drape_source), name
        assert 0.03 < cloth.density < 1 and 1e-6 < cloth.rigidity < 1e-3, name
        assert cloth.shear is None or cloth.shear < cloth.young < max(cloth.tension), name


def test_a_garment_is_made_of_one_and_other_keys_override_it(tmp_path):
    (tmp_path / "wardrobe.toml").write_text(
        '[garments.coat]\nmesh = "coat.obj"\nmaterial = {fabric = "denim", thickness = 0.007, friction = 0.2}\n'
    )
    wanted = replace(Material(**fabric("denim").material), thickness=0.007, friction=0.2)
    assert read_wardrobe(tmp_path / "wardrobe.toml").garments["coat"].material == wanted


def test_a_scene_changes_the_fabric_and_keeps_what_the_fabric_does_not_decide(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE + 'material = {fabric = "silk", bend_damping = 0.5}\n')
    plain = load_scene("tshirt-catwalk").material
    wanted = replace(plain, **fabric("silk").material, bend_damping=0.5)
    assert load_scene(str(tmp_path / "scene.toml")).material == wanted


@pytest.mark.parametrize(
    "value, said",
    [
        ('"denym"', "unknown fabric 'denym': did you mean 'denim'?"),
        ("3", "material.fabric is 3; wanted the name of a fabric, see `garmentbench fabrics`"),
    ],
)
def test_a_wrong_name_is_one_line_with_the_file(tmp_path, value, said):
    for file, text in (
        ("scene.toml", f"{SCENE}material = {{fabric = {value}}}\n"),
        ("wardrobe.toml", f"[garments.coat]\nmaterial = {{fabric = {value}}}\n"),
    ):
        (tmp_path / file).write_text(text)
        with pytest.raises(UserError) as raised:
            load_scene(str(tmp_path / file)) if file == "scene.toml" else read_wardrobe(tmp_path / file)
        assert said in str(raised.value) and str(tmp_path / file) in str(raised.value)


def test_they_are_listed(capsys):
    assert main(["fabrics"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in fabrics())
