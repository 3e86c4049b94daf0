"""Folds that the reference keeps: pleats to the hem; a sheet that winds round a stick, and not through itself."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.sequence import Sequence
from garmentbench.simulation.simulate import simulate


def simulated(name: str, frames: int) -> Sequence:
    return simulate(replace(load_scene(name), frames=frames), preset("smoke"))


def test_pleats_keep_their_depth_at_the_hem():
    """A pleat's side stands out from the line between its inner folds; flattened pleats would have no depth."""
    sequence = simulated("pleated_skirt-armspace-90", 30)
    rest = sequence.template.garment.rest
    hem = np.flatnonzero(rest[:, 2] < rest[:, 2].min() + 1e-4)  # in order round the hem, folds inside and outside
    inner, outer = hem[:-1:2], hem[1::2]

    def depth(points: np.ndarray) -> np.ndarray:
        middle = (points[..., inner, :] + points[..., np.append(inner[1:], hem[-1]), :]) / 2
        return np.linalg.norm(points[..., outer, :] - middle, axis=-1)

    kept = depth(sequence.garment[-1]) / depth(rest)
    assert kept.mean() > 0.6  # where a leg presses from within, pleats open


@pytest.mark.parametrize("name", ["sheet-stick-a", "laid_sheet-stick-swing-a"])
def test_a_sheet_on_the_stick_never_passes_through_itself(name):
    sequence = simulated(name, 40)
    garment = sequence.template.garment
    assert not crossing_faces(sequence.garment, garment.faces, garment.seams).any()


def test_the_laid_sheet_hangs_on():
    sequence = simulated("laid_sheet-stick-swing-b", 40)
    assert sequence.body is not None
    top = sequence.garment[..., 2].max(axis=1) - sequence.body[..., 2].max(axis=1)
    assert (np.abs(top) < 0.015).all()  # cloth still lies on top of the stick, in every frame
