"""The encoders' maps: a border of background round every chart, and nothing on it."""

import numpy as np
import pytest
import torch

from garmentbench.method import BodyFrame, History
from garmentbench.methods.motion_guided.canonical import Canonical, bordered
from garmentbench.methods.motion_guided.config import SIZES
from garmentbench.methods.motion_guided.descriptor import VertexToMap
from garmentbench.methods.motion_guided.seams import Seams
from garmentbench.paths import GARMENTS

PIXELS = 1.5


def _files() -> list[str]:
    return sorted(path.name for path in GARMENTS.glob("*.npz"))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("file", _files())
def test_every_garment_leaves_a_border_on_the_smallest_map(file, size):
    model = SIZES[size].model
    with np.load(GARMENTS / file) as z:
        uv = bordered(z["uv"], model.map_border / model.map_size) * model.map_size
    assert uv.min() >= PIXELS - 1e-4 and uv.max() <= model.map_size - PIXELS + 1e-4


def test_a_chart_that_keeps_away_from_the_edge_stays_as_it_is():
    uv = np.array([[0.2, 0.3], [0.8, 0.5]], np.float32)
    np.testing.assert_allclose(bordered(uv, 0.1), uv, atol=1e-7)
    np.testing.assert_allclose(bordered(np.array([[0.0, 0.5], [1.0, 0.5]]), 0.1), [[0.1, 0.5], [0.9, 0.5]])


def test_the_background_is_nothing_and_the_chart_is_what_its_vertices_are(sequence, config):
    canonical = Canonical.of(sequence.template, config.model)
    to_map = VertexToMap(canonical.chart(8), len(canonical.rest))
    inside = to_map.mask.bool()
    assert inside.any() and not inside[[0, -1]].any() and not inside[:, [0, -1]].any()
    drawn = to_map(torch.ones(1, len(canonical.rest), 1))[0, 0]
    np.testing.assert_allclose(drawn, to_map.mask, atol=1e-6)
    uv = to_map(torch.from_numpy(canonical.uv)[None])[0].permute(1, 2, 0)  # what is drawn lies where it is drawn
    y, x = torch.meshgrid(torch.arange(8), torch.arange(8), indexing="ij")
    centres = (torch.stack([x, y], dim=-1) + 0.5) / 8
    np.testing.assert_allclose(uv[inside], centres[inside], atol=1e-5)


def test_copies_of_a_point_come_to_their_mean():
    seams = Seams(5, np.array([[0, 3], [3, 4]]))
    positions = torch.arange(15.0).reshape(5, 3)
    closed = seams(positions)
    assert torch.equal(closed[[1, 2]], positions[[1, 2]])
    np.testing.assert_allclose(closed[[0, 3, 4]], positions[[0, 3, 4]].mean(dim=0).expand(3, -1))
    assert torch.equal(Seams(5, np.zeros((0, 2), int))(positions), positions)


def test_a_prediction_has_no_cracks_and_goes_on_from_what_was_decoded(trained, sequence):
    state = trained.begin(sequence.template, History.before(sequence, 3))
    garment, state = trained.step(state, BodyFrame(sequence.body[3]))
    one, other = sequence.template.garment.seams.T
    np.testing.assert_array_equal(garment[one], garment[other])
    decoded = state.garments[-1]
    assert np.abs(decoded[one] - decoded[other]).max() > 1e-5
    np.testing.assert_allclose(garment[one], (decoded[one] + decoded[other]) / 2, atol=1e-6)
