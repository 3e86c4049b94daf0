"""From a scene to its reference sequence, with its own uncertainty."""

from collections.abc import Callable
from dataclasses import asdict, replace

import numpy as np

from garmentbench.errors import UserError
from garmentbench.metrics.strain import strain_mean, strain_p99_max
from garmentbench.progress import track
from garmentbench.scenes.material import Settings
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import Sequence, Template
from garmentbench.simulation.drive import OK, Simulated
from garmentbench.simulation.outfit import Layer, Outfit

WINDOW = 40, 150  # frames, least and most, of the uncertainty's two further runs; in between a fifth of the sequence
PERTURBATION = 1e-3  # [m]


def simulate(scene: Scene, preset: Preset, device: str = "cpu") -> Sequence:
    """The reference sequence of a scene, without its uncertainty. Shows its progress.

    Args:
        scene: What is simulated.
        preset: Sizes of garment and body.
        device: Warp device, "cpu" or "cuda:0".

    Returns:
        The sequence, its `info["simulation"]` filled: settings, substeps, strain, status ("ok", or "unstable" with its
        first bad frame); of two layers those of the outer one, and `beneath` the same of the inner. Frames from the
        first that is not finite on are left out. Where a garment is worn beneath, it is the sequence's body.

    Raises:
        UsageError: An unknown garment, body or motion.
        UserError: A wrong scene beneath, or not one frame is finite.
    """
    outfit = Outfit.of(scene, preset)
    with track(_steps(outfit, outfit.frames), f"simulate {scene.name}") as step:
        worn = outfit.simulate(outfit.frames, device, step=step)
    start, stop = outfit.animation.warm_up, worn[-1].finite
    if stop <= start:
        margin = max(layer.settings.step_margin for layer in outfit.layers)
        raise UserError(
            f"scene {scene.name}: the cloth's positions are not finite from the first frame on; wanted a stable step, "
            f"lower step_margin (it is {margin:g}, at most 1 is safe)"
        )
    told = [_summary(w.run, start, layer, device) for w, layer in zip(worn, outfit.layers, strict=True)]
    info = {
        "scene": scene.name,
        "split": scene.split,
        "motion": asdict(scene.motion),
        "preset": preset.mesh.name,
        "simulation": told[-1] if len(told) == 1 else _of_both(*told),
    }
    body, positions = outfit.animation.body, outfit.animation.positions
    if scene.worn_over is not None:
        info["worn_over"], body, positions = scene.worn_over.name, worn[-2].body, worn[-2].surface
    garment = worn[-1].run.positions[start:stop].astype(np.float32)
    return Sequence(
        Template(worn[-1].garment, body, scene.fps), garment, positions[start:stop].astype(np.float32), info
    )


def measure_uncertainty(
    scene: Scene, preset: Preset, sequence: Sequence, frames: int | None = None, device: str = "cpu"
) -> dict[str, float]:
    """How far the reference moves [cm, mean over vertices and frames] when nothing that matters is changed.

    Args:
        scene, preset: As given to `simulate`.
        sequence: What it gave.
        frames: How many frames after the warm-up are compared; None for a fifth of them within `WINDOW`.
        device: As given to `simulate`.

    Returns:
        `doubling_cm` (twice the substeps), `perturbed_cm` (each vertex pushed 1 mm further at the start of the
        warm-up), `cm` (the larger) and `frames` (compared). Of two layers both are changed. NaN where a changed
        run is not finite.
    """
    outfit = Outfit.of(scene, preset)
    frames = min(frames or int(np.clip(len(sequence) // 5, *WINDOW)), len(sequence))

    def distance(change: Callable[[Settings], Settings]) -> float:
        moved = outfit.simulate(frames, device, change, step)[-1].run.positions[outfit.animation.warm_up :]
        if len(moved) < frames:  # the layer beneath has blown up
            return float("nan")
        return 100 * float(np.linalg.norm(moved - sequence.garment[:frames], axis=-1).mean())

    with track(2 * _steps(outfit, frames), f"uncertainty of {scene.name}") as step:
        doubling = distance(lambda s: replace(s, substep_factor=2 * s.substep_factor))
        perturbed = distance(lambda s: replace(s, start_noise=s.start_noise + PERTURBATION))
    return {"doubling_cm": doubling, "perturbed_cm": perturbed, "cm": max(doubling, perturbed), "frames": frames}


def _steps(outfit: Outfit, frames: int) -> int:
    """Steps of progress that `outfit.simulate(frames)` takes."""
    whole = len(outfit.animation.positions)
    counts = [
        min(outfit.animation.warm_up + frames + (layer is not outfit.layers[-1]), whole) for layer in outfit.layers
    ]
    return sum(count - 1 for count in counts)


def _summary(run: Simulated, warm_up: int, layer: Layer, device: str) -> dict:
    mean, high = run.strain[warm_up:].T
    return {
        "solver": "explicit",
        "device": device,
        "material": asdict(layer.material),
        "settings": asdict(layer.settings),
        "substeps": run.substeps,
        "strain_mean": strain_mean(mean),
        "strain_p99_max": strain_p99_max(high),
        "ms_per_frame": run.ms_per_frame,
        "status": run.status,
        "first_bad_frame": None if run.first_bad_frame is None else run.first_bad_frame - warm_up,
    }


def _of_both(inner: dict, outer: dict) -> dict:
    """The outer layer's summary and the inner's beneath; what has gone wrong beneath has gone wrong for both."""
    told = outer | {"beneath": inner}
    if inner["status"] != OK:
        bad = [f for f in (inner["first_bad_frame"], outer["first_bad_frame"]) if f is not None]
        told |= {"status": inner["status"], "first_bad_frame": min(bad)}
    return told
