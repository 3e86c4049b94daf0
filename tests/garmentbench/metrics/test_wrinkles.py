"""Wrinkles and skin between the vertices: values by hand, and that blur is not rewarded."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import grid

from garmentbench.metrics import METRICS, Motion
from garmentbench.metrics.dihedral_rms import dihedral_rms, face_pairs
from garmentbench.metrics.displacement_spectrum import band_energies, smoother
from garmentbench.metrics.faces_inside import faces_inside, skin_frames
from garmentbench.metrics.normal_angle import normal_angle
from garmentbench.sequence import OBJECT, Body, Template

SHEET = grid(24, 24, 0.48, 0.48)
WRINKLES = [METRICS[name] for name in ("dihedral_rms", "normal_angle", "displacement_spectrum")]


def wavy(length: float, height: float = 0.01, frames: int = 3) -> np.ndarray:
    """The sheet in waves along x that move from frame to frame, positions [m], shape (T, V, 3)."""
    x = np.repeat(SHEET.rest[None].astype(np.float64), frames, axis=0)
    phase = np.arange(frames)[:, None]
    x[..., 2] = height * np.sin(2 * np.pi * x[..., 0] / length + phase)
    return x.astype(np.float32)


def scored(predicted: np.ndarray, reference: np.ndarray) -> dict[str, float]:
    motion = Motion(predicted, reference, None, Template(SHEET, None, 30.0))
    return {metric.name: metric.compute(motion) for metric in WRINKLES}


def blurred(x: np.ndarray, times: int) -> np.ndarray:
    smooth = smoother(SHEET)
    for _ in range(times):
        x = np.stack([smooth @ frame for frame in x])
    return x.astype(np.float32)


def off(metric, value: float) -> float:
    """How far a score is from the best one."""
    return abs(np.log(value)) if metric.best == "one" else value


def test_the_angle_of_one_fold():
    """Two squares of two triangles each, folded by 60 degrees at the line between them; three inner edges."""
    sheet = grid(2, 1, 0.2, 0.1)
    folded = sheet.rest.astype(np.float64)
    right = folded[:, 0] > 0.15
    folded[right, 0], folded[right, 2] = 0.1 + 0.1 * np.cos(np.pi / 3), 0.1 * np.sin(np.pi / 3)
    assert len(face_pairs(sheet)) == 3
    assert dihedral_rms(folded[None], sheet.faces, face_pairs(sheet)) == pytest.approx(np.pi / 3 / np.sqrt(3))


def test_a_seam_is_an_inner_edge():
    left = grid(1, 1, 0.1, 0.1)
    both = replace(
        left,
        rest=np.concatenate([left.rest, left.rest + np.float32([0.1, 0, 0])]),
        faces=np.concatenate([left.faces, left.faces + 4]),
        uv=np.concatenate([left.uv, left.uv]),
        seams=np.array([[1, 4], [3, 6]], np.int32),
    )
    assert len(face_pairs(both)) == 3


def test_a_sheet_turned_by_30_degrees():
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = (SHEET.rest @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]], np.float32))[None]
    areas = np.ones(len(SHEET.faces))
    assert normal_angle(turned, SHEET.rest[None], SHEET.faces, areas) == pytest.approx(30, abs=1e-3)


def test_flat_cloth_has_no_band_and_a_wave_has_its_own():
    middle = np.abs(SHEET.rest[:, :2] - 0.24).max(axis=1) < 0.2
    smoothed = smoother(SHEET) @ SHEET.rest.astype(np.float64)
    assert smoothed[middle] == pytest.approx(SHEET.rest[middle], abs=1e-7)
    narrow, wide = band_energies(wavy(0.06), SHEET), band_energies(wavy(0.24), SHEET)
    assert narrow[0] > 10 * wide[0] and wide[-2] > 1.2 * narrow[-2]  # the sheet's corners shrink, in the widest bands


def test_twice_the_height_is_two_octaves_of_energy():
    """Energy is height squared; the borders, where smoothing shrinks the sheet, weigh in the widest bands only."""
    reference, twice = wavy(0.08, 0.01), wavy(0.08, 0.02)
    assert np.log2(band_energies(twice, SHEET) / band_energies(reference, SHEET))[:2] == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("times", [2, 6, 20])
@pytest.mark.parametrize("length", [0.08, 0.16])
def test_blur_is_never_better_than_the_truth(times, length):
    reference = wavy(length)
    truth, smooth = scored(reference, reference), scored(blurred(reference, times), reference)
    for metric in WRINKLES:
        assert off(metric, truth[metric.name]) == pytest.approx(0, abs=1e-6)
        assert off(metric, smooth[metric.name]) > 0.02
    assert smooth["dihedral_rms"] < 1


def test_more_blur_is_worse():
    reference = wavy(0.12)
    for metric in WRINKLES:
        values = [off(metric, scored(blurred(reference, n), reference)[metric.name]) for n in (1, 4, 16)]
        assert values == sorted(values)


def ball_under(height: float) -> Motion:
    """A sheet of one square, 20 cm wide, over a ball of radius 1 cm below its middle: its corners are far off."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.01)
    sheet = grid(1, 1, 0.2, 0.2)
    body = Body("ball", ball.vertices.astype(np.float32), ball.faces.astype(np.int32))
    middle = sheet.rest - np.float32([0.1, 0.1, 0])
    at = body.rest + np.float32([0, 0, height])
    return Motion(middle[None], middle[None], at[None], Template(sheet, body, 30.0))


def test_skin_between_the_vertices_is_seen():
    """The diagonal's middle is 6 mm over the centre of a ball of 10 mm; the other six points can't be inside."""
    motion = ball_under(-0.006)
    assert (motion.distances > 0.1).all()
    between = motion.distances_between
    assert between[np.isfinite(between)] == pytest.approx([-0.004], abs=1e-4)
    assert faces_inside(between) == pytest.approx(100 / 7) and skin_frames(between) == 100


def test_near_corners_the_middle_is_asked_for():
    motion = ball_under(-0.006)
    near = replace(motion, predicted=motion.predicted * np.float32([0.08, 0.08, 1]))  # 16 mm wide
    assert (near.distances > 0).all()
    # The centres of the faces lie 8 mm / 3 from the middle in x and in y: 7.1 mm from the ball's centre.
    assert np.sort(near.distances_between[0])[:3] == pytest.approx([-0.004, -0.0029, -0.0029], abs=2e-4)


def test_shares_by_hand():
    distances = np.array([[0.001, -0.0002, np.inf, 0.1], [0.001, -0.0006, -0.001, np.inf]], np.float32)
    assert faces_inside(distances) == pytest.approx(100 * 3 / 8)
    assert skin_frames(distances) == 50


def test_an_object_has_no_skin():
    motion = ball_under(-0.006)
    thing = replace(motion.template.required_body, kind=OBJECT)
    stick = replace(motion, template=replace(motion.template, body=thing))
    assert not METRICS["skin_frames"].applies(stick)
