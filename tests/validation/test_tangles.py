"""Cloth that starts out crossed with itself comes free, and nothing is pushed from outside."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation
from sheets import FPS, HARD, grid

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.scenes.material import Settings
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.cloth import Solver
from garmentbench.simulation.time_step import substeps

WEIGHTLESS = Settings(gravity=0.0)
SIDE = 0.16  # of a sheet [m]


def test_a_corner_that_is_through_comes_back():
    """A corner of an upright sheet hangs 2 cm through a level one."""
    level, upright = grid(8, 8, SIDE, SIDE), grid(8, 8, SIDE, SIDE)
    count = len(level.rest)
    stood = Rotation.from_euler("zx", [45.0, 90.0], degrees=True).apply(upright.rest)  # on its first corner
    stood += [0.5 * SIDE + 0.003, 0.5 * SIDE + 0.004, -0.02]
    both = replace(
        level,
        rest=np.concatenate([level.rest, stood]).astype(np.float32),
        faces=np.concatenate([level.faces, upright.faces + count]),
        uv=np.tile(level.uv, (2, 1)),
    )
    fabric = assemble(both, HARD, WEIGHTLESS)
    solver = Solver(
        fabric, both.rest.astype(float), None, HARD, WEIGHTLESS, substeps(fabric, HARD, WEIGHTLESS, 1 / FPS), 1 / FPS
    )
    crossing = []
    for _ in range(12):
        crossing.append(crossing_faces(solver.positions[None], both.faces, both.seams).sum())
        solver.advance()
    assert crossing[0] > 4 and crossing[-1] == 0
    momentum = fabric.mass @ solver.velocities
    assert np.abs(momentum).max() < 1e-6 * fabric.mass.sum()
