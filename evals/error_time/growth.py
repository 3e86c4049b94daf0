"""How time a frame grows with the mesh: the simulator and methods on one garment's meshes, all by the bench's clock."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from garmentbench import sequence_file
from garmentbench.evals.error_time.pareto import SIMULATOR
from garmentbench.evals.error_time.points import SIZES
from garmentbench.evals.error_time.table import GROWTH_MS, VERTICES
from garmentbench.pipeline.bench import XPBD, simulate_into, time_method, time_simulator, train_little
from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import Scene

MESHES = SIZES
MODEL = "laptop"  # the networks' size on all meshes
FRAMES = 40
METHODS = ("linear_memory", "tuned", "motion_guided")
XPBD_LINE = f"xpbd_{XPBD}_substeps"
LINES = ((SIMULATOR, "explicit"), (SIMULATOR, XPBD_LINE), *((method, "full") for method in METHODS))


def grown(scene: Scene, mesh: str) -> list[dict]:
    """Vertices and median time a frame [ms] of each of `LINES` on a mesh: the processor's time, since in the hour that
    this takes the machine may do other work; wall time on a CUDA device."""
    size, scene = preset("laptop", mesh, MODEL), replace(scene, frames=FRAMES)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.h5"
        simulate_into(scene, size, path)
        vertices = len(sequence_file.load(path, 1).template.garment.rest)
        timed = [time_simulator(scene, size, budget) for budget in (None, XPBD)]
        for method in METHODS:
            train_little(method, size, path, Path(folder))
            timed.append(time_method(method, size, path, Path(folder), 1))
    return [
        {"method": method, "variant": variant, VERTICES: vertices, GROWTH_MS: float(np.median(ms))}
        for (method, variant), t in zip(LINES, timed, strict=True)
        for ms in [t.ms if t.processor_ms is None else t.processor_ms]
    ]
