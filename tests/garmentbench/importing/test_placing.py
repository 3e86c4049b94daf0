"""Units, axes, frames and spare vertices of what is imported."""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import MESHES, as_film, typed

from garmentbench.errors import UsageError, UserError
from garmentbench.importing.meshes.arrays import read_npz, write_npz
from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.sequences import Wanted, import_meshes

CLOTH, BODY = MESHES["garment"], MESHES["body"]
PLAIN = Wanted("x", Given("m", "z", 25.0))


def test_a_garment_of_no_garment_s_size_is_asked_about(home, capsys):
    cloth = replace(CLOTH, frames=CLOTH.frames / np.float32(0.0254), rest=None, unit=None, up=None)
    write_npz(home / "cloth.npz", replace(cloth, unit=1.0, up="z"))
    write_npz(home / "body.npz", BODY)
    code, _, err = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert (
        code == 1 and len(err) == 1 and "cloth.npz: the garment measures" in err[0] and "wanted 0.05 to 8 m" in err[0]
    )
    assert "give --units, for " in err[0] and "in (0." in err[0] and "--body-units" in err[0]


@pytest.mark.parametrize("which", ["garment", "body"])
def test_spare_vertices_are_left_out_by_number_and_decide_nothing(which):
    """One a kilometre away, one that isn't finite: neither says anything of unit, axes and rest shape."""
    spoilt = {}
    for name, mesh in (("garment", CLOTH), ("body", BODY)):
        frames, rest, faces, pins = mesh.frames, mesh.still, mesh.faces, mesh.pins
        if name == which:
            spare = np.float32([[1e3, 0, 0], [np.nan, 0, 0]])
            frames = np.concatenate([np.tile(spare[None], (len(frames), 1, 1)), frames], axis=1)
            rest, faces, pins = np.concatenate([spare, rest]), faces + 2, np.array([0, 7])
        spoilt[name] = replace(mesh, frames=frames, rest=rest, faces=faces, pins=pins, unit=None, up=None)
    sequence, notes = import_meshes(spoilt["garment"], spoilt["body"], Wanted("x", Given(fps=25.0)))
    plain, _ = import_meshes(CLOTH, BODY, PLAIN)
    assert sum("2 vertices without a face left out" in line for line in notes) == 1
    np.testing.assert_allclose(sequence.garment, plain.garment, atol=1e-6)
    np.testing.assert_allclose(sequence.body, plain.body, atol=1e-6)
    if which == "garment":
        assert sequence.template.garment.pins.tolist() == [5]
    bad = spoilt[which].frames.copy()
    bad[3, 40, 1] = np.nan
    with pytest.raises(UserError, match="frame 3, vertex 40 is at"):
        import_meshes(**{**spoilt, which: replace(spoilt[which], frames=bad)}, wanted=PLAIN)


def test_a_body_of_another_unit_and_axis_than_its_garment(home):
    body = replace(
        as_film(BODY), frames=as_film(BODY).frames / np.float32(2.54), rest=as_film(BODY).rest / np.float32(2.54)
    )
    cloth = replace(CLOTH, unit=None, up=None)
    sequence, notes = import_meshes(cloth, body, replace(PLAIN, given=Given("m", "z", 25.0, "in", "y")))
    assert notes[:2] == ["units: m, of the body in (given)", "up: z, of the body y (given)"]
    np.testing.assert_allclose(sequence.body, BODY.frames, atol=1e-5)
    np.testing.assert_allclose(sequence.garment[:, 0], CLOTH.frames[:, 0], atol=1e-6)
    sequence, notes = import_meshes(cloth, body, replace(PLAIN, given=Given(None, "z", 25.0, "in", "y")))
    assert notes[0].startswith("units: m (inferred: the garment's diagonal") and notes[0].endswith(
        "of the body in (given)"
    )
    with pytest.raises(UsageError, match="--body-units is 'inch'; wanted m, cm, mm, in, ft"):
        Given(body_units="inch")


def test_a_frame_that_stands_still(home):
    still = replace(BODY, frames=BODY.frames[:1])
    sequence, notes = import_meshes(CLOTH, still, PLAIN)
    assert "the body has one frame: it stands still" in notes
    np.testing.assert_array_equal(sequence.body, np.repeat(BODY.frames[:1], 6, axis=0))


def test_frames_that_do_not_fit(home):
    short = replace(BODY, frames=BODY.frames[:5])
    with pytest.raises(
        UserError, match="the garment has 6 frames, the body 5; export the same frames of both, or give --frames 5"
    ):
        import_meshes(CLOTH, short, PLAIN)
    assert len(import_meshes(CLOTH, short, replace(PLAIN, frames=5))[0]) == 5
    with pytest.raises(UsageError, match="--frames is 7; the garment has 6"):
        import_meshes(CLOTH, None, replace(PLAIN, frames=7))


@pytest.mark.parametrize("value", [np.nan, np.inf, 3e30])
def test_no_number_is_named_by_file_frame_and_vertex(home, value):
    frames = CLOTH.frames.copy()
    frames[3, 40, 1] = value
    write_npz(home / "bad.npz", replace(CLOTH, frames=frames))

    with pytest.raises(UserError, match=r"bad.npz: frame 3, vertex 40 is at \(.*\), wanted finite positions"):
        import_meshes(read_npz(home / "bad.npz"), None, PLAIN)


def test_a_template_with_other_axes_is_turned_and_told(home):
    lying = replace(CLOTH, rest=as_film(CLOTH).rest / 100)
    sequence, notes = import_meshes(lying, BODY, PLAIN)
    np.testing.assert_allclose(sequence.template.garment.rest, CLOTH.rest, atol=1e-6)
    assert "rest shape of garment: turned from y up to z up, as the recording lies" in notes


def test_a_recording_that_walks_and_turns_keeps_its_rest_shape(home):
    c, s = np.cos(2.0), np.sin(2.0)
    turned = replace(
        CLOTH, frames=(CLOTH.frames @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [3, 4, 0]).astype(np.float32)
    )
    sequence, notes = import_meshes(turned, None, PLAIN)
    np.testing.assert_array_equal(sequence.template.garment.rest, CLOTH.rest)
    assert not any("turned" in line for line in notes)


def test_a_wrong_unit_in_a_file_is_noticed(home):
    with pytest.raises(
        UserError, match="the body measures 0.016 m when its unit is cm, wanted 0.5 to 3 m; give --units"
    ):
        import_meshes(replace(CLOTH, unit=0.01), replace(BODY, unit=0.01), Wanted("x", Given(None, "z", 25.0)))
