"""From a scene to its reference sequence, with its own uncertainty."""

from dataclasses import asdict, replace

import numpy as np

from garmentbench.errors import UserError
from garmentbench.garments import load_garment
from garmentbench.motion import Animation, animate
from garmentbench.motion.placing import place
from garmentbench.presets import Preset
from garmentbench.progress import track
from garmentbench.scene import Scene
from garmentbench.sequence import Garment, Sequence, Template
from garmentbench.simulation.drive import Drive, drive
from garmentbench.simulation.material import Material, Settings, override

WINDOW = 150  # frames of the uncertainty's two further runs, after the warm-up: 0.009 cm on armspace-90, as over all 1,150
PERTURBATION = 1e-3  # [m]


def simulate(scene: Scene, preset: Preset, device: str = "cpu") -> Sequence:
    """The reference sequence of a scene, without its uncertainty. Shows its progress.

    Args:
        scene: What is simulated; its `material` and `simulation` override the defaults by name.
        preset: Sizes of garment and body.
        device: Warp device, "cpu" or "cuda:0".

    Returns:
        The sequence, its `info["simulation"]` filled: settings, substeps, strain, status ("ok", or "unstable" with its
        first bad frame). Frames from the first that is not finite on are left out.

    Raises:
        UsageError: An unknown garment, body, motion, material or setting.
        UserError: Not one frame is finite.
    """
    animation, garment, start, material, settings = _prepare(scene, preset)
    with track(len(animation.positions) - 1, f"simulate {scene.name}") as step:
        run = drive(garment, start, animation.body, animation.positions, scene.fps, material, settings, device, step=step)
    positions = run.positions[animation.warm_up :].astype(np.float32)
    body = animation.positions[animation.warm_up :].astype(np.float32)
    finite = np.isfinite(positions).all(axis=(1, 2))
    count = len(finite) if finite.all() else int(np.argmin(finite))
    if count == 0:
        raise UserError(
            f"scene {scene.name}: the cloth's positions are not finite from the first frame on; wanted a stable step, "
            f"lower step_margin (it is {settings.step_margin:g}, at most 1 is safe)"
        )
    info = {
        "scene": scene.name,
        "split": scene.split,
        "motion": asdict(scene.motion),
        "preset": preset.name,
        "simulation": _summary(run, animation.warm_up, material, settings, device),
    }
    return Sequence(Template(garment, animation.body, scene.fps), positions[:count], body[:count], info)


def measure_uncertainty(
    scene: Scene, preset: Preset, sequence: Sequence, frames: int = WINDOW, device: str = "cpu"
) -> dict[str, float]:
    """How far the reference moves [cm, mean over vertices and frames] when nothing that matters is changed.

    Args:
        scene, preset: As given to `simulate`.
        sequence: What it gave.
        frames: The first so many frames are compared, after the whole warm-up.
        device: As given to `simulate`.

    Returns:
        `doubling_cm` (twice the substeps), `perturbed_cm` (each vertex pushed 1 mm further at the start of the warm-up), `cm`
        (the larger) and `frames` (compared).
    """
    animation, garment, start, material, settings = _prepare(scene, preset)
    frames = min(frames, len(sequence))
    window = animation.positions[: animation.warm_up + frames]

    def distance(changed: Settings) -> float:
        run = drive(garment, start, animation.body, window, scene.fps, material, changed, device, step=step)
        return 100 * float(np.linalg.norm(run.positions[animation.warm_up :] - sequence.garment[:frames], axis=-1).mean())

    with track(2 * (len(window) - 1), f"uncertainty of {scene.name}") as step:
        doubling = distance(replace(settings, substep_factor=2 * settings.substep_factor))
        perturbed = distance(replace(settings, start_noise=settings.start_noise + PERTURBATION))
    return {"doubling_cm": doubling, "perturbed_cm": perturbed, "cm": max(doubling, perturbed), "frames": frames}


def _prepare(scene: Scene, preset: Preset) -> tuple[Animation, Garment, np.ndarray, Material, Settings]:
    material = override(Material(), scene.material, "material")
    settings = override(Settings(), scene.simulation, "simulation setting")
    garment = load_garment(scene.garment, preset.name)
    return animate(scene, preset), garment, place(garment.rest, scene.motion), material, settings


def _summary(run: Drive, warm_up: int, material: Material, settings: Settings, device: str) -> dict:
    mean, high = run.strain[warm_up:].T
    return {
        "solver": "explicit",
        "device": device,
        "material": asdict(material),
        "settings": asdict(settings),
        "substeps": run.substeps,
        "mean_strain_percent": 100 * float(np.nanmean(mean)),
        "p99_strain_percent": 100 * float(np.nanmax(high)),
        "ms_per_frame": run.ms_per_frame,
        "status": run.status,
        "first_bad_frame": None if run.first_bad_frame is None else run.first_bad_frame - warm_up,
    }
