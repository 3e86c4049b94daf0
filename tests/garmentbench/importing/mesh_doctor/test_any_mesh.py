"""Whatever a mesh is like, the doctor says something about it and does not fall over.

A second repair finds nothing to do.
"""

import warnings

import numpy as np
import pytest
from faulty_meshes import ball

from garmentbench.errors import UserError
from garmentbench.importing.mesh_doctor.body import of_body
from garmentbench.importing.mesh_doctor.examine import examine, summary
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.repairs import mend

BALL = of_body(ball())


def any_mesh(random: np.random.Generator) -> Mesh:
    """A few random triangles: fins, piles, slivers, scraps, seams across all of them, in any unit."""
    count = int(random.integers(1, 14))
    vertices = random.normal(size=(count, 3)) * random.choice([1e-30, 1e-3, 0.3, 1, 30, 300, 1e4, 1e18])
    if random.random() < 0.4:
        vertices = np.round(3 * vertices) / 3
    if random.random() < 0.3:
        vertices[:, random.integers(3)] = 0
    uv = random.random((count, 2)) * random.choice([1e-9, 1, 5, 1e12]) if random.random() < 0.8 else None
    if uv is not None and random.random() < 0.3:
        uv[random.integers(count)] = random.choice([0, np.nan])
    faces, seams = (random.integers(0, count, (int(random.integers(1, 25)), k)) for k in (3, 2))
    mesh = Mesh(
        "any",
        vertices,
        faces,
        uv,
        np.arange(count),
        seams[:3],
        random.integers(0, count, 2),
        bool(random.random() < 0.5),
    )
    return Mesh("any", mesh.points[mesh.point], faces, uv, mesh.numbers, mesh.seams, mesh.pins, mesh.says_seams)


@pytest.mark.parametrize("seed", range(60))
def test_any_mesh_can_be_examined_and_mended(seed):
    mesh, wearer = any_mesh(np.random.default_rng(seed)), BALL if seed % 3 == 0 else None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert all("\n" not in str(f.problem) for f in examine(mesh, wearer)) and summary(mesh)
        try:
            mended, _ = mend(mesh, wearer)
        except UserError:
            return
        again, lines = mend(mended, wearer)
    assert not [line for line in lines if not line.startswith("left ")]
    assert np.array_equal(again.faces, mended.faces) and np.array_equal(again.vertices, mended.vertices)
