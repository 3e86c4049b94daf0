"""What each method, and the simulator, can be given more or less of: a point of a curve each."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from garmentbench.pipeline.choice import MethodChoice, choose_method
from garmentbench.scenes.presets import Preset

NAME = "error-time"


@dataclass(frozen=True)
class Setting:
    """One setting of a method.

    Attributes:
        method: Its name.
        label: What the point is called; a variant of the method where there is no `change` and no `model`.
        change: Of the full configuration.
        model: Another size of the network than the preset's.
    """

    method: str
    label: str = "full"
    change: Callable[[Any], Any] | None = None
    model: str | None = None

    def choice(self, preset: Preset) -> MethodChoice:
        """The method with that configuration at a preset; a variant that only this experiment has is called
        "error-time:<label>" in its runs."""
        if self.change is None and self.model is None:
            return choose_method(self.method, self.label, preset)
        found = choose_method(self.method, "full", replace(preset, model=self.model or preset.model))
        config = self.change(found.config) if self.change else found.config
        return replace(found, variant=f"{NAME}:{self.label}", config=config)


@dataclass(frozen=True)
class Budget:
    """What the simulator is given.

    Attributes:
        label: What the point is called.
        queries: Of the nearest point, a frame; None: as the scene says.
        substeps: Of XPBD, a frame; None: the reference's explicit solver with as many as it needs.
        coarser: By how many sizes the garment's mesh is coarser than the preset's.
    """

    label: str
    queries: int | None = None
    substeps: int | None = None
    coarser: int = 0


SIZES = ("smoke", "laptop", "desktop", "paper")  # of meshes, coarse to fine
XPBD = (8, 16, 24, 32, 48)  # below 16 a laptop T-shirt is strained by half
BUDGETS = (
    Budget("explicit"),
    *(Budget(f"explicit_{n}_queries", queries=n) for n in (4, 2)),
    Budget("explicit_1_query", queries=1),
    *(Budget(f"xpbd_{n}_substeps", substeps=n) for n in XPBD),
    Budget("explicit_coarser", coarser=1),
    Budget("explicit_1_query_coarser", queries=1, coarser=1),
    Budget("xpbd_16_substeps_coarser", substeps=16, coarser=1),
    Budget("xpbd_8_substeps_coarser", substeps=8, coarser=1),
    Budget("explicit_much_coarser", coarser=2),
    Budget("xpbd_8_substeps_much_coarser", substeps=8, coarser=2),
)


def budgets(preset: Preset) -> tuple[Budget, ...]:
    """Those for which the garment has a mesh."""
    return tuple(b for b in BUDGETS if b.coarser <= SIZES.index(preset.mesh.name))


def _collision_steps(count: int) -> Callable[[Any], Any]:
    return lambda full: replace(full, collision=replace(full.collision, steps=count))


def _codes(count: int) -> Callable[[Any], Any]:
    return lambda full: replace(full, codes=count)


def _count(count: int) -> Callable[[Any], Any]:
    return lambda full: replace(full, count=count)


SETTINGS = (
    Setting("skinning"),
    Setting("nearest", "1_frame", _count(1)),
    *(Setting("nearest", f"{n}_frames", _count(n)) for n in (4, 16, 64)),
    Setting("static_ridge"),
    *(Setting("linear_subspace", f"{n}_codes", _codes(n)) for n in (4, 16)),
    Setting("linear_subspace"),
    Setting("linear_subspace", "256_codes", _codes(256)),
    Setting("linear_memory"),
    Setting("subspace_network"),
    Setting("pose_gru"),
    Setting("tuned", "no_push_out"),
    Setting("tuned", "narrow"),
    Setting("tuned"),
    Setting("motion_guided", "smoke_network", model="smoke"),
    Setting("motion_guided", "no_collision"),
    Setting("motion_guided", "5_collision_steps", _collision_steps(5)),
    Setting("motion_guided", "15_collision_steps", _collision_steps(15)),
    Setting("motion_guided"),
    Setting("motion_guided", "push_out"),
)


def settings(preset: Preset) -> tuple[Setting, ...]:
    """Those that differ from one another at a preset."""
    return tuple(s for s in SETTINGS if s.model != preset.model)
