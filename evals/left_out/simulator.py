"""What parts of the simulator cost and change: the first frames of a scene with and without each."""

import time
from dataclasses import replace
from typing import Any

import numpy as np

from garmentbench.device import has_cuda, quiet_warp
from garmentbench.evals.left_out.costs import row
from garmentbench.evaluation.results import Row
from garmentbench.needs import Part
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.simulation.drive import Simulated
from garmentbench.simulation.ensemble import FIRST, RUNS, Member, members
from garmentbench.simulation.outfit import Outfit

FRAMES = 60
PUSHED = "pushed_frame_0"


def simulator_rows(scene: Scene, parts: tuple[Part, ...], preset: Preset) -> list[Row]:
    """Time a frame that leaving out saves, and how far the cloth then is from where it was [cm], on average over the
    frames; as `spread` how far a push of 1 mm moves it."""
    quiet_warp()
    outfit = Outfit.of(scene, preset)
    push = next(m for m in members(RUNS) if m.name == PUSHED)
    pushed, _ = _run(outfit, push)  # the first run, in which compilers do their work, is not timed
    built, whole = _run(outfit)
    spread = _apart(built, pushed, outfit)
    rows = []
    for part, settings in _left_out(scene, {p.name: p for p in parts}).items():
        left, ms = _run(replace(outfit, layers=tuple(_with(layer, settings) for layer in outfit.layers)))
        rows += [
            row(part, whole - ms, "ms"),
            row(part, _apart(built, left, outfit), "cm", spread=spread),
        ]
    return rows


def _left_out(scene: Scene, parts: dict[str, Part]) -> dict[str, dict[str, Any]]:
    """Settings without each part. Queries: as many as would do, or half of them where all are needed."""
    queries, have = parts["all_queries"], scene.simulation.queries
    fewer = max(1, have // 2) if queries.needed or queries.amount is None else int(queries.amount)
    return {"self_contact": {"self_contact": False}, "all_queries": {"queries": fewer}}


def _with(layer: Any, settings: dict[str, Any]) -> Any:
    return replace(layer, settings=replace(layer.settings, **settings))


def _run(outfit: Outfit, member: Member = FIRST) -> tuple[Simulated, float]:
    """A simulation of a few frames, and its processor time a frame [ms]."""
    ticks: list[float] = []
    device = "cuda:0" if has_cuda() else "cpu"
    worn = outfit.simulate(min(FRAMES, outfit.frames), device, member, lambda: ticks.append(time.process_time()))
    return worn[-1].run, 1e3 * float(np.median(np.diff(ticks)))


def _apart(a: Simulated, b: Simulated, outfit: Outfit) -> float:
    """Mean distance of the vertices after the warm-up [cm]."""
    first = outfit.animation.warm_up
    return 100 * float(np.linalg.norm(a.positions[first:] - b.positions[first:], axis=-1).mean())
