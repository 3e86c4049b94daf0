"""Motions: how what a garment is worn by moves, the warm-up before frame 0 included."""

from garmentbench.motion.animation import Animation
from garmentbench.motion.clip_animation import animate_clip
from garmentbench.motion.human import animate_human, human_motions
from garmentbench.motion.stick import STICK, animate_stick, stick_motions
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene

__all__ = ["STICK", "Animation", "animate", "human_motions", "motion_names", "stick_motions"]


def motion_names() -> list[str]:
    """Names of all motions, the human's and the stick's."""
    return sorted([*human_motions(), *stick_motions()])


def animate(scene: Scene, preset: Preset) -> Animation:
    """The body of a scene in its motion: warm-up, then the scene's frames, at most the preset's limit.

    Raises `UsageError` for an unknown body, or a motion that this body does not have.
    """
    frames = preset.mesh.limited(scene.frames)
    if scene.body == STICK:
        return animate_stick(scene, frames)
    if scene.motion.file is not None:
        return animate_clip(scene, preset.mesh.body_size, frames)
    return animate_human(scene, preset.mesh.body_size, frames)
