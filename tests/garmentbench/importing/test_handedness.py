"""Mirror images and faces that point inwards: mirrored or turned with a word, refused, or said to be assumed."""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import MESHES, beside, dancer, typed

from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.sequences import Wanted, import_meshes

CLOTH, BODY = MESHES["garment"], MESHES["body"]
FLIP = np.float32([-1, 1, 1])
PLAIN = Wanted("x", Given("m", "z", 25.0))


def swapped(mesh: MeshSequence) -> MeshSequence:
    """y and z swapped, which is a mirror image."""
    return replace(mesh, frames=mesh.frames[..., [0, 2, 1]], rest=mesh.still[:, [0, 2, 1]])


def test_meshes_with_y_and_z_swapped_are_mirrored_with_a_word():
    given = replace(PLAIN, given=Given("m", "y", 25.0))
    sequence, notes = import_meshes(*(replace(swapped(m), up=None) for m in (CLOTH, BODY)), given)
    plain, told = import_meshes(CLOTH, BODY, PLAIN)
    assert any("mirrored" in line and "y and z swapped" in line for line in notes)
    assert not any("mirrored" in line or "inwards" in line for line in told)
    np.testing.assert_allclose(sequence.garment, plain.garment, atol=1e-6)
    np.testing.assert_allclose(sequence.body, plain.body, atol=1e-6)
    np.testing.assert_array_equal(sequence.template.body.faces, plain.template.body.faces)
    np.testing.assert_allclose(sequence.template.garment.rest, plain.template.garment.rest, atol=1e-6)


def test_faces_of_the_garment_alone_are_turned():
    turned = replace(CLOTH, faces=CLOTH.faces[:, ::-1], corner_uv=CLOTH.corner_uv[:, ::-1])
    sequence, notes = import_meshes(turned, BODY, PLAIN)
    assert "faces of the garment pointed inwards: turned" in notes
    np.testing.assert_allclose(sequence.garment[0].min(axis=0), CLOTH.frames[0].min(axis=0), atol=1e-6)


def test_where_faces_point_outwards_the_hand_is_said_to_be_assumed():
    """A mirror image whose faces were turned can't be told from a symmetric body; nothing is claimed of it."""
    mirrored = [replace(m, frames=m.frames * FLIP, rest=m.still * FLIP, faces=m.faces[:, ::-1]) for m in (CLOTH, BODY)]
    for meshes in ((CLOTH, BODY), mirrored):
        _, notes = import_meshes(*meshes, PLAIN)
        assert any(line.startswith("handedness: right-handed axes assumed: faces point outwards") for line in notes)


def test_a_body_inside_out_is_turned(home):
    sequence, notes = import_meshes(CLOTH, replace(BODY, faces=BODY.faces[:, ::-1]), PLAIN)
    assert "faces of the body pointed inwards: turned" in notes
    assert not any("inwards" in line for line in import_meshes(CLOTH, BODY, PLAIN)[1])
    assert {frozenset(f) for f in sequence.template.body.faces.tolist()} == {frozenset(f) for f in BODY.faces.tolist()}


def test_without_a_body_the_hand_is_said_to_be_assumed():
    _, notes = import_meshes(CLOTH, None, PLAIN)
    assert "handedness: right-handed axes assumed; there is no body whose faces would tell" in notes


@pytest.mark.parametrize(
    ("matrix", "said"),
    [
        (np.diag([-1.0, 1, 1]), "x turned round"),
        (np.diag([1.0, -1, 1]), "y turned round"),
        (np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]]), "y and z swapped"),
        (np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]]), "x and y swapped"),
    ],
)
def test_a_garment_that_fits_only_as_its_mirror_image_is_refused(home, capsys, matrix, said):
    """Its faces were turned outwards, so that these don't tell; garment and body stand off the origin."""
    away = [replace(beside(m, 0.7), frames=beside(m, 0.7).frames + np.float32([0, 0.4, 0])) for m in (CLOTH, BODY)]
    away = [replace(m, rest=None) for m in away]
    write_npz(home / "body.npz", away[1])
    turned = (away[0].frames @ matrix.T).astype(np.float32)
    write_npz(home / "cloth.npz", replace(away[0], frames=turned, faces=CLOTH.faces[:, ::-1]))
    code, out, err = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 1 and len(err) == 1 and out == "" and not (home / "x.h5").exists()
    assert "garmentbench: cloth on body: " in err[0] and "of the garment's vertices lie inside the body" in err[0]
    assert f"but hardly one of its mirror image ({said})" in err[0]
    assert "export garment and body with the same axes" in err[0]


def test_a_mirror_image_of_a_garment_is_known_by_its_body_s_motion(home, capsys):
    """In frame 0 it fits as well, on a body that is symmetric and stands over the origin."""
    cloth, body = dancer()
    write_npz(home / "body.npz", body)
    for faces in (cloth.faces, cloth.faces[:, ::-1]):
        write_npz(home / "cloth.npz", replace(cloth, frames=cloth.frames * FLIP, faces=faces))
        code, _, err = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
        assert code == 1 and len(err) == 1 and "mirror image (x turned round); export garment and body" in err[0]
    both = [replace(m, frames=m.frames * FLIP) for m in (cloth, body)]  # faces inwards
    sequence, notes = import_meshes(*both, Wanted("x"))
    assert any(line.endswith("mirrored") for line in notes)
    turned = sequence.body - body.frames * np.float32([1, -1, 1]) * FLIP  # by half a turn, which is no matter
    assert np.abs(turned).max() < 1e-5
