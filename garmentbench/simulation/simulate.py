"""From a scene to its reference sequence: one run of the simulator, or an ensemble of runs."""

from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from garmentbench.errors import UserError
from garmentbench.metrics.strain import strain_mean, strain_p99_max
from garmentbench.progress import track
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import Sequence, Template
from garmentbench.simulation.drive import OK, Simulated
from garmentbench.simulation.ensemble import Member, members, summary
from garmentbench.simulation.outfit import Layer, Outfit, Worn

_OF_A_RUN = ("substeps", "ms_per_frame", "strain_p99_max", "status", "first_bad_frame")  # noted of every further run


def simulate(scene: Scene, preset: Preset, device: str = "cpu", runs: int = 1) -> Sequence:
    """The reference sequence of a scene. Shows its progress.

    Args:
        scene: What is simulated.
        preset: Sizes of garment and body.
        device: Warp device, "cpu" or "cuda:0".
        runs: How many runs in all, each over the whole length (see `ensemble.members`).

    Returns:
        The sequence, its `info["simulation"]` filled: settings, substeps, strain, status ("ok", or "unstable" with its
        first bad frame); of two layers those of the outer one, and `beneath` the same of the inner. Frames from the
        first that is not finite on are left out. Where a garment is worn beneath, it is the sequence's body. With more
        than one run, the further ones in `runs`, not finite from the frame on in which one broke, and what they are
        and say in `info["runs"]` and `info["ensemble"]`.

    Raises:
        UsageError: An unknown garment, body or motion.
        UserError: A wrong scene beneath, or not one frame is finite.
    """
    outfit = Outfit.of(scene, preset)
    start, first, *others = outfit.animation.warm_up, *members(runs)
    with track(runs * _steps(outfit, outfit.frames), f"simulate {scene.name}") as step:
        worn = outfit.simulate(outfit.frames, device, first, step)
        stop = worn[-1].finite
        if stop <= start:
            margin = max(layer.settings.step_margin for layer in outfit.layers)
            raise UserError(
                f"scene {scene.name}: the cloth's positions are not finite from the first frame on; wanted a stable "
                f"step, lower step_margin (it is {margin:g}, at most 1 is safe)"
            )
        further = [_further(m, outfit, stop - start, device, step) for m in others]
    info = {
        "scene": scene.name,
        "split": scene.split,
        "motion": asdict(scene.motion),
        "preset": preset.mesh.name,
        "simulation": _told(worn, outfit, device),
    }
    body, positions = outfit.animation.body, outfit.animation.positions
    if scene.worn_over is not None:
        info["worn_over"], body, positions = scene.worn_over.name, worn[-2].body, worn[-2].surface
    template, garment = Template(worn[-1].garment, body, scene.fps), worn[-1].run.positions[start:stop]
    sequence = Sequence(template, garment.astype(np.float32), positions[start:stop].astype(np.float32), info)
    if not further:
        return sequence
    info["runs"] = [told for told, _ in further]
    ensemble = replace(sequence, runs=np.stack([moved for _, moved in further]))
    return replace(ensemble, info=info | {"ensemble": summary(ensemble)})


def _further(
    member: Member, outfit: Outfit, frames: int, device: str, step: Callable[[], None]
) -> tuple[dict[str, Any], Float[np.ndarray, "frames vertices 3"]]:
    """What a further run is and how it ended, and its positions after the warm-up [m], shape (T, V, 3), NaN from the
    first frame on that is not finite."""
    worn = outfit.simulate(frames, device, member, step)
    outer, start = worn[-1], outfit.animation.warm_up
    moved = np.full((frames, *outer.garment.rest.shape), np.nan, np.float32)
    finite = outer.run.positions[start : outer.finite]  # of an outer layer no longer than the one beneath is finite
    moved[: len(finite)] = finite
    told = _told(worn, outfit, device)
    return {"name": member.name, "seed": member.seed} | {k: told[k] for k in _OF_A_RUN}, moved


def _steps(outfit: Outfit, frames: int) -> int:
    """Steps of progress that `outfit.simulate(frames)` takes."""
    whole = len(outfit.animation.positions)
    counts = [
        min(outfit.animation.warm_up + frames + (layer is not outfit.layers[-1]), whole) for layer in outfit.layers
    ]
    return sum(count - 1 for count in counts)


def _told(worn: list[Worn], outfit: Outfit, device: str) -> dict[str, Any]:
    """How a run was made and how it ended."""
    start = outfit.animation.warm_up
    told = [_summary(w.run, start, layer, device) for w, layer in zip(worn, outfit.layers, strict=True)]
    return told[-1] if len(told) == 1 else _of_both(*told)


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
