import numpy as np
import pytest
import torch
import trimesh

from garmentbench.methods.motion_guided.config import Sdf, Training
from garmentbench.methods.motion_guided.sdf import SignedDistance, fit_sdf, surface_samples
from garmentbench.methods.training import WEIGHTS, load
from garmentbench.sequence import Body, Garment, Template
from garmentbench.storage.runs import RunStore

RADIUS, CENTRE = 0.3, np.array([0.5, 0.0, 1.0])


@pytest.fixture(scope="module")
def ball() -> Template:
    """A ball as the body, and a small patch of cloth on its top."""
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=RADIUS)
    rest, faces = (mesh.vertices + CENTRE).astype(np.float32), mesh.faces.astype(np.int32)
    top = rest[rest[:, 2] > 1.25]
    patch = Garment("patch", top, faces[:1], np.zeros((len(top), 2), np.float32), np.zeros((0, 2), np.int32))
    return Template(patch, Body("ball", rest, faces), 30.0)


@pytest.mark.parametrize("layers", [4, 8])
def test_it_starts_near_the_distance_to_a_sphere(layers):
    torch.manual_seed(0)
    network = SignedDistance(Sdf(layers=layers, width=256))
    direction = torch.nn.functional.normalize(torch.randn(200, 3), dim=-1)
    distance = network(direction * torch.tensor([0.2, 0.5, 1.0, 1.5, 2.0])[:, None, None])
    assert (distance[0] < 0).all() and (distance[4] > 0).all()
    assert (distance.mean(dim=1).diff() > 0).all()


def test_samples_lie_on_the_surface_and_half_of_them_near_the_garment(ball):
    points, normals = surface_samples(ball, 2000)
    outward = points - CENTRE
    np.testing.assert_allclose(np.linalg.norm(outward, axis=1), RADIUS, atol=0.003)
    assert (np.sum(outward * normals, axis=1) > 0.98 * RADIUS).all()
    high = points[:, 2] > CENTRE[2]
    assert 0.45 < high[:1000].mean() < 0.55 and high[1000:].all()


def test_training_finds_sign_and_distance(ball, tmp_path):
    options = Sdf(4, 32, 128, Training(steps=250, learning_rate=5e-3, schedule="one_cycle"))
    with RunStore(tmp_path).open("sdf", {"seed": 0}) as run:
        fit_sdf(ball, options, run, torch.device("cpu"))
        network = SignedDistance(options)
        network.load_state_dict(load(run.folder / WEIGHTS, torch.device("cpu")))
    up = np.array([0.0, 0.0, 1.0])
    exact = np.array([-0.05, -0.02, 0.0, 0.02, 0.05])
    points = CENTRE + (RADIUS + exact)[:, None] * up
    with torch.no_grad():
        found = network(torch.from_numpy(points.astype(np.float32))).numpy()
    np.testing.assert_allclose(found, exact, atol=0.006)
