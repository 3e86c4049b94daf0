"""The body between two frames, and what it holds."""

import numpy as np

from garmentbench.evals.crosscheck.hold import fasten, hermite
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.cloth import Solver
from garmentbench.simulation.obstacle import Obstacle


def swaying() -> Obstacle:
    sequence = tiny_sequence(6)
    return Obstacle.of(sequence.template.body, sequence.body.astype(np.float64), None)


def test_a_surface_goes_through_its_frames():
    obstacle = swaying()
    for t in range(5):
        *ends, _ = obstacle.between(t, np.zeros(3), 30.0)
        np.testing.assert_allclose(hermite(*ends, 0.0), obstacle.positions[t])
        np.testing.assert_allclose(hermite(*ends, 1.0), obstacle.positions[t + 1])


def test_a_steady_speed_stays_steady_and_a_parabola_is_met():
    p0, p1 = np.zeros((1, 3)), np.ones((1, 3))
    np.testing.assert_allclose(hermite(p0, p1, p1, p1, 0.3), [[0.3, 0.3, 0.3]])
    np.testing.assert_allclose(hermite(p0, p1, 0 * p1, 2 * p1, 0.3), [[0.09, 0.09, 0.09]])


def test_it_is_the_reference_s_own_motion():
    obstacle, template = swaying(), tiny_sequence(1).template
    fabric = assemble(template.garment, Material(), Settings())
    touched = obstacle.surfaces, obstacle.positions[0]
    solver = Solver(fabric, fabric.rest, touched, Material(), Settings(), 8, 1 / 30)
    *ends, wind = obstacle.between(2, np.zeros(3), 30.0)
    solver.collider.set_frame(*ends, wind)
    solver.collider.move_to(0.625, 0.75, 1 / 240)
    solver.collider.refit()
    np.testing.assert_allclose(solver.collider.surface.points.numpy(), hermite(*ends, 0.625), atol=1e-6)


def test_held_points_go_with_a_rigid_motion_exactly():
    body = tiny_sequence(1).template.body
    points = body.rest[[3, 40, 77]].astype(np.float64) * 1.2
    held = fasten(points, body.faces, body.rest.astype(np.float64))
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    np.testing.assert_allclose(held.at(body.rest @ turn.T + [1, 2, 3]), points @ turn.T + [1, 2, 3], atol=1e-6)


def test_nothing_to_hold():
    body = tiny_sequence(1).template.body
    assert fasten(np.zeros((0, 3)), body.faces, body.rest).at(body.rest).shape == (0, 3)
