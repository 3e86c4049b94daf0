"""Metrics do not depend on where the scene stands, which way it faces, or how vertices are numbered."""

from importlib import import_module
from pkgutil import iter_modules

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench import metrics
from garmentbench.errors import UsageError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.geometry.signed_distance import signed_distances
from garmentbench.metrics import METRICS, STUDY_METRICS
from garmentbench.metrics.interpenetration import inside_vertices, interpenetration
from garmentbench.metrics.interpenetration_strict import depth_p95, interpenetration_strict
from garmentbench.metrics.jitter import jitter
from garmentbench.metrics.l2 import l2
from garmentbench.metrics.liveliness import liveliness, near_displacements, vertex_areas
from garmentbench.metrics.strain import strain_p95


def scene():
    """Predicted and reference garment, body, rest, faces, body faces.

    A tube that is pressed into the body in places.
    """
    sequence = tiny_sequence(12)
    rng = np.random.default_rng(0)
    predicted = sequence.garment + rng.normal(scale=0.02, size=sequence.garment.shape)
    garment, body = sequence.template.garment, sequence.template.body
    reference = sequence.garment.astype(np.float64)
    return [
        predicted,
        reference,
        sequence.body.astype(np.float64),
        garment.rest.astype(np.float64),
        garment.faces,
        body.faces,
    ]


def all_metrics(predicted, reference, body, rest, faces, body_faces):
    distances, edges = signed_distances(predicted, body, body_faces), unique_edges(faces)
    return {
        "l2": l2(predicted, reference),
        "interpenetration": interpenetration(inside_vertices(predicted, body, body_faces)),
        "interpenetration_strict": interpenetration_strict(distances),
        "depth_p95": depth_p95(distances),
        "strain_p95": strain_p95(predicted, edges, edge_lengths(rest, edges)),
        "jitter": jitter(predicted, reference, 30.0),
        "liveliness": liveliness(predicted, reference, near_displacements(reference, body), vertex_areas(rest, faces)),
    }


@pytest.fixture(scope="module")
def plain():
    values = all_metrics(*scene())
    assert all(v > 0 for v in values.values())  # so that equality says something
    return values


def test_rigid_motion(plain):
    turn = Rotation.from_euler("xyz", [0.3, -0.8, 2.0]).as_matrix()
    predicted, reference, body, rest, faces, body_faces = scene()
    moved = [x @ turn.T + [3.0, -2.0, 1.0] for x in (predicted, reference, body)]
    assert all_metrics(*moved, rest, faces, body_faces) == pytest.approx(plain, rel=1e-4)


def test_vertex_order(plain):
    predicted, reference, body, rest, faces, body_faces = scene()
    rng = np.random.default_rng(1)
    g, b = rng.permutation(len(rest)), rng.permutation(body.shape[1])
    old_g, old_b = np.argsort(g), np.argsort(b)
    values = all_metrics(predicted[:, g], reference[:, g], body[:, b], rest[g], old_g[faces], old_b[body_faces])
    assert values == pytest.approx(plain, rel=1e-6)


def test_frames_are_independent(plain):
    """Per-frame metrics of all frames at once are the mean of those of each."""
    predicted, reference, body, rest, faces, body_faces = scene()
    for name in ("l2", "interpenetration", "interpenetration_strict", "strain_p95"):
        alone = [
            all_metrics(predicted[t : t + 1], reference[t : t + 1], body[t : t + 1], rest, faces, body_faces)[name]
            for t in range(len(predicted))
        ]
        assert np.mean(alone) == pytest.approx(plain[name], rel=1e-6)


NOTES = [import_module(m.name).__doc__ for m in iter_modules(metrics.__path__, "garmentbench.metrics.")]
NOTES = [note for note in NOTES if "When it lies." in note]


@pytest.mark.parametrize("metric", (METRICS | STUDY_METRICS).values(), ids=lambda m: m.name)
def test_every_metric_has_a_note_that_says_when_it_lies(metric):
    assert sum(metric.name in note and metric.unit in note for note in NOTES) >= 1


def test_a_metric_is_found_by_its_name_and_a_wrong_one_refused():
    assert metrics.metric("change").unit == "cm" and metrics.metric("jitter") is METRICS["jitter"]
    with pytest.raises(UsageError, match="did you mean 'jitter'"):
        metrics.metric("jiter")


def test_names_and_titles_are_stated_once():
    known = [*METRICS.values(), *STUDY_METRICS.values()]
    assert len({m.name for m in known}) == len({m.title for m in known}) == len(known)
