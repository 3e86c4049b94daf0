"""A scene's garments from the innermost outwards, and their simulation: one after the other, each driven by what is
beneath it and not the other way round (section 6.5 of Zhang et al. 2022)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from garmentbench.motion import Animation, animate
from garmentbench.motion.placing import place
from garmentbench.scenes.garments import scene_garment
from garmentbench.scenes.inner_garment import as_body, sewn
from garmentbench.scenes.material import Material, Settings
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import Body, Garment
from garmentbench.simulation.drive import Simulated, drive
from garmentbench.simulation.ensemble import FIRST, Member


@dataclass(frozen=True)
class Layer:
    """A garment that is put on. `start`: where [m], world axes, shape (V, 3)."""

    garment: Garment
    start: np.ndarray
    material: Material
    settings: Settings


@dataclass(frozen=True)
class Outfit:
    """A scene resolved.

    Attributes:
        animation: The body in its motion. Where there are two layers, as the inner one's scene has it.
        layers: Its garments from the innermost outwards.
        frames: The scene's length after the warm-up [frames].
        fps: Frames a second.
    """

    animation: Animation
    layers: tuple[Layer, ...]
    frames: int
    fps: float

    @classmethod
    def of(cls, scene: Scene, preset: Preset) -> "Outfit":
        """Resolve a scene into garments and body motion. Raises `UsageError` for an unknown garment, body or motion."""
        animation = animate(scene.worn_over or scene, preset)
        layers = tuple(_layer(s, preset) for s in (scene.worn_over, scene) if s is not None)
        return cls(animation, layers, preset.mesh.limited(scene.frames), scene.fps)

    def simulate(
        self,
        frames: int,
        device: str,
        member: Member = FIRST,
        step: Callable[[], None] = lambda: None,
    ) -> list["Worn"]:
        """Drive every layer through the warm-up and so many `frames` more, fewer where the one beneath becomes not
        finite.

        Args:
            frames: At most the scene's.
            device: Warp device.
            member: Which run of an ensemble; what it changes, it changes of every layer.
            step: Called after each frame of each layer.
        """
        count, worn = self.animation.warm_up + frames, []
        for layer in self.layers:
            beneath = (worn[-1].body, worn[-1].surface[:count]) if worn else None
            # An inner layer sees one frame more, if there is one: the last frame's tangent is then that of its own
            # scene.
            seen = count + (layer is not self.layers[-1])
            run = drive(
                layer.garment,
                layer.start,
                self.animation.body,
                self.animation.positions[:seen],
                self.fps,
                layer.material,
                member.settings(layer.settings),
                device,
                inner=beneath,
                push=member.push_at(self.animation.warm_up),
                step=step,
            )
            worn.append(Worn(layer.garment, run))
            count = min(count, worn[-1].finite)
        return worn


@dataclass(frozen=True)
class Worn:
    """A layer that has been simulated."""

    garment: Garment
    run: Simulated

    @property
    def finite(self) -> int:
        """Frames before the first that is not finite."""
        good = np.asarray(np.isfinite(self.run.positions).all(axis=(1, 2)))
        return len(good) if good.all() else int(np.argmin(good))

    @property
    def body(self) -> Body:
        """The garment as what the next one is worn over."""
        return as_body(self.garment)

    @property
    def surface(self) -> np.ndarray:
        """Positions of that body's vertices [m], world axes, shape (T, B, 3), float64."""
        return sewn(self.garment, self.run.positions)


def _layer(scene: Scene, preset: Preset) -> Layer:
    garment = scene_garment(scene, preset.mesh)
    return Layer(garment, place(garment.rest, scene.motion), scene.material, scene.simulation)
