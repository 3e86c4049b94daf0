"""A scene simulated again for comparison.

With changed settings, or on a finer mesh, and timed by the processor's clock.
"""

import time
from dataclasses import replace
from typing import Any

import numpy as np

from garmentbench.evaluation.rollout import DIVERGED, OK
from garmentbench.geometry.subdivide import subdivided
from garmentbench.motion.placing import place
from garmentbench.progress import track
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.simulation.drive import STRAIN_LIMIT
from garmentbench.simulation.outfit import Outfit


def rerun_scene(scene: Scene, preset: Preset, refined: bool, device: str = "cpu") -> tuple[np.ndarray, dict[str, Any]]:
    """Simulate a scene, of two layers both.

    Args:
        scene: With whatever settings are to be tried.
        preset: Sizes of garment and body.
        refined: The (outer) garment is put on with every triangle cut in four.
        device: Warp device.

    Returns:
        Positions after the warm-up of the vertices that the garment's own mesh has [m], shape (T, V, 3), float32, as
        long as they are finite; and the outcome: substeps, ms_per_frame, status ("ok" or "diverged"),
        first_bad_frame. A run is judged after the warm-up: a push at the start may strain the cloth for a moment more
        than it may be.

    Raises as `Outfit.of`.
    """
    outfit = Outfit.of(scene, preset)
    vertices, warm_up = len(outfit.layers[-1].garment.rest), outfit.animation.warm_up
    outfit = _with_finer_mesh(outfit, scene) if refined else outfit
    clock = time.process_time if device == "cpu" else time.perf_counter  # on a shared processor wall time says little
    marks: list[float] = []
    count = warm_up + outfit.frames
    ahead = len(outfit.animation.positions) > count  # a layer beneath is then simulated for one frame more
    steps = len(outfit.layers) * (count - 1) + ahead * (len(outfit.layers) - 1)
    with track(steps, f"simulate {scene.name}{' on a finer mesh' if refined else ''}") as step:

        def mark() -> None:
            marks.append(clock())
            step()

        worn = outfit.simulate(outfit.frames, device, step=mark)
    outer = worn[-1].run
    good = outer.strain[warm_up:, 1] <= STRAIN_LIMIT
    outcome = {
        "substeps": outer.substeps,
        "ms_per_frame": 1e3 * len(worn) * (marks[-1] - marks[0]) / (len(marks) - 1),  # the first frame may compile
        "status": OK if good.all() else DIVERGED,
        "first_bad_frame": None if good.all() else int(np.argmin(good)),
    }
    return outer.positions[warm_up : worn[-1].finite, :vertices].astype(np.float32), outcome


def _with_finer_mesh(outfit: Outfit, scene: Scene) -> Outfit:
    """The outfit, its outer garment with every triangle cut in four."""
    *beneath, outer = outfit.layers
    fine = subdivided(outer.garment)
    return replace(outfit, layers=(*beneath, replace(outer, garment=fine, start=place(fine.rest, scene.motion))))
