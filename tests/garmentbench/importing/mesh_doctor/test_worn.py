"""Is the garment on the body? Openings by hand, what would bring it there, and nothing pushed until then (N6, issue
8).
"""

from dataclasses import replace

import numpy as np
import pytest
from faulty_meshes import tube

from garmentbench.cli import main
from garmentbench.importing.mesh_doctor.bringing_on import Change, other_unit, proposal
from garmentbench.importing.mesh_doctor.files import mesh_of, read_mesh, read_wearer, write_mesh
from garmentbench.importing.mesh_doctor.worn import is_worn
from garmentbench.importing.meshes.conventions import UNITS
from garmentbench.scenes.garments import garment_names, load_garment

BODY = read_wearer("base")
SKIRT = tube()
SIZE = np.ptp(SKIRT.vertices, axis=0)
SKIRT = replace(
    SKIRT, vertices=(SKIRT.vertices - SKIRT.vertices.mean(axis=0)) * [0.56 / SIZE[0], 0.5 / SIZE[1], 0.5 / SIZE[2]]
)
WORN = replace(SKIRT, vertices=SKIRT.vertices + [0, 0.0, 0.9])  # round hips and thighs


@pytest.fixture
def typed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def type_(*arguments: str) -> tuple[int, str, str]:
        code = main(["check", *map(str, arguments)])
        out, err = capsys.readouterr()
        return code, out, err

    return type_


@pytest.mark.parametrize("name", garment_names())
def test_all_our_garments_are_worn_by_all_bodies(name):
    mesh = mesh_of(load_garment(name, "smoke"))
    assert all(is_worn(mesh, read_wearer(body)) for body in ("base", "slim", "heavy"))
    assert not is_worn(replace(mesh, vertices=mesh.vertices + [2, 0, 0]), BODY)


@pytest.mark.parametrize("bottom", [1.6, 1.8, 2.0])
@pytest.mark.parametrize("width", [0.3, 0.4])
def test_a_tube_over_the_crown_is_not_worn(bottom, width):
    """The head, which ends at 1.84 m, is in its lower opening only; a scarf's upper one ends at the nose."""
    scaled = SKIRT.vertices / np.ptp(SKIRT.vertices, axis=0) * [width, width, 0.3]
    assert not is_worn(replace(SKIRT, vertices=scaled + [0, 0, bottom + 0.15]), BODY)
    assert is_worn(replace(SKIRT, vertices=scaled * [1, 1, 0.7] + [0, 0, 1.5]), BODY)


@pytest.mark.parametrize("name", ["dress", "tshirt", "bodysuit", "pleated_skirt"])
@pytest.mark.parametrize("factor", [0.39, 0.3937, 0.3])
def test_a_garment_far_too_small_is_not_worn_round_a_leg(name, factor):
    assert not is_worn(mesh_of(load_garment(name, "smoke")).scaled(factor), BODY)


def test_what_would_bring_it_on_is_found():
    assert is_worn(WORN, BODY) and not is_worn(SKIRT, BODY)
    moved = replace(WORN, vertices=WORN.vertices + [-1.5, 0, 0])
    assert proposal(moved, BODY) == Change(shift=(1.5, 0.0, 0.0))
    lying = replace(SKIRT, vertices=SKIRT.vertices[:, [0, 2, 1]] * [1, 1, -1])  # y up, at the pelvis' origin
    change = proposal(lying, BODY)
    assert change.up == "y" and change.shift[2] == pytest.approx(0.9, abs=0.05) and is_worn(change.of(lying), BODY)
    assert change.words().startswith("y up, +0.9 m")
    assert proposal(WORN.scaled(1 / 0.0254), BODY, ("m", "cm", "in")) == Change("in")
    assert proposal(replace(SKIRT, vertices=0.02 * SKIRT.vertices), BODY) is None


def test_nothing_is_pushed_out_of_a_body_that_is_not_in_it(typed, tmp_path):
    lying = replace(SKIRT, vertices=SKIRT.vertices[:, [0, 2, 1]] * [1, 1, -1])
    write_mesh(tmp_path / "lying.obj", lying)
    code, out, _ = typed("lying.obj", "--body", "base", "--fix", "a.npz")
    assert code == 1 and "nothing is pushed" in out and "pushed 1" not in out and "points inside" not in out
    assert (
        "error: body: not worn by 'base'" in out
        and "y up, +0.9 m would bring it on: --fix OUT --up y --shift=0,0,0.9" in out
    )
    np.testing.assert_allclose(
        read_mesh(tmp_path / "a.npz").vertices, read_mesh(tmp_path / "lying.obj").vertices, atol=1e-6
    )
    code, out, _ = typed("lying.obj", "--body", "base", "--fix", "b.npz", "--up", "y", "--shift", "0.9")
    assert "fix: turned from y up to z up and moved by (0, 0, 0.9) m" in out and "not worn" not in out
    assert is_worn(read_mesh(tmp_path / "b.npz"), BODY)


def test_inches_are_asked_for_and_taken(typed, tmp_path):
    write_mesh(tmp_path / "inches.obj", WORN.scaled(1 / 0.0254))
    code, out, _ = typed("inches.obj", "--body", "base", "--fix", "a.npz")
    assert code == 1 and "cm (0.36 m) or in (0.9 m)" in out and "--units in" in out and "scaled" not in out
    assert "turned" not in out
    code, out, _ = typed("inches.obj", "--fix", "b.npz", "--units", "in")
    assert "scaled from in to m, by 0.0254" in out
    np.testing.assert_allclose(read_mesh(tmp_path / "b.npz").size, WORN.size, rtol=1e-3)
    assert typed("inches.obj")[0] == 1


@pytest.mark.parametrize("name", ["tshirt", "dress", "bodysuit"])
@pytest.mark.parametrize("units", ["ft", "cm", "in"])
def test_a_garment_far_too_large_is_not_worn_and_its_unit_is_named(typed, tmp_path, name, units):
    """The body goes through its openings all the same, and none of it is inside: said to be good before."""
    garment = mesh_of(load_garment(name, "smoke"))
    write_mesh(tmp_path / "a.npz", garment.scaled(1 / UNITS[units]))
    code, out, _ = typed("a.npz", "--body", "base")
    assert code == 1 and "good" not in out
    if units == "ft":  # 3.3 times too large in metres, which is a size that garments have
        assert "error: body: not worn by 'base'" in out and "in ft it would be worn: --fix OUT --units ft" in out
        code, out, _ = typed("a.npz", "--body", "base", "--fix", "b.npz", "--units", "ft")
        assert code == 0 and "scaled from ft to m" in out
    large = replace(garment, vertices=2.54 * garment.vertices)
    assert not is_worn(large, BODY) and other_unit(large, BODY) == pytest.approx(1 / 2.54)
    assert other_unit(garment.scaled(100), BODY) == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("option", "value"), [("--shift", "up"), ("--shift", "1,2"), ("--up", "w"), ("--units", "inch")]
)
def test_wrong_options(typed, tmp_path, option, value):
    write_mesh(tmp_path / "a.obj", WORN)
    code, out, err = typed("a.obj", "--fix", "b.npz", option, value)
    assert code == 2 and out == "" and option in err and "wanted" in err
