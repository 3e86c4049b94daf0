"""The size of which the issue speaks, a thirtieth of its frames: 10 frames of 20k vertices."""

import time
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.obj import read_series, series, write_series
from garmentbench.importing.sequences import Wanted, import_meshes

SIDE, FRAMES = 142, 10


@pytest.fixture(scope="module")
def sheet():
    """A sheet of 20,164 vertices, cut in two in UV."""
    u, v = np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij")
    rest = np.stack([u, v, 0 * u], axis=-1).reshape(-1, 3).astype(np.float32) / SIDE
    corner = (u * SIDE + v)[:-1, :-1].ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + SIDE, corner + 1], 1), np.stack([corner + 1, corner + SIDE, corner + SIDE + 1], 1)]
    )
    frames = rest + np.random.default_rng(0).normal(0, 1e-3, (FRAMES, *rest.shape)).astype(np.float32)
    uv = 0.5 * rest[faces][..., :2]
    uv[(faces % SIDE).max(axis=1) >= SIDE // 2] += 0.4
    return MeshSequence("sheet", frames, faces.astype(np.int32), uv, rest)


def test_obj_text_is_read_at_the_speed_of_arrays(tmp_path, sheet):
    write_series(tmp_path, sheet)
    files = series(str(tmp_path))
    start = time.process_time()
    read = read_series(files)
    assert time.process_time() - start < 0.08 * FRAMES  # 300 frames take 24 s at most; 3 s measured
    np.testing.assert_allclose(read.frames, sheet.frames, atol=6e-7)


def test_import_holds_little_more_than_the_result(sheet):
    many = replace(sheet, frames=np.repeat(sheet.frames, 5, axis=0))
    start = time.process_time()
    tracemalloc.start()
    sequence, _ = import_meshes(many, None, Wanted("x", Given("m", "y", 30.0)))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(sequence.template.garment.seams) == SIDE
    assert peak < 2.5 * sequence.garment.nbytes
    assert time.process_time() - start < 5.0
