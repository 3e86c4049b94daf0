"""This machine's clock: what a frame takes, of the simulator and of methods, measured beside one another.

Each is timed in a process of its own, whose peak of memory is then its own: batch 1, after a warm-up, synchronised,
nothing of recording or metrics inside. What was timed while the machine did other work is timed again. Methods are
trained for a tenth of their steps, on the frames that they are then timed on: times don't depend on what was learnt,
but for a collision stage that has more to do behind a worse prediction.
"""

import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, is_dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from garmentbench import sequence_file
from garmentbench.device import device_name, quiet_warp
from garmentbench.errors import UsageError, UserError
from garmentbench.method import HISTORY, BodyFrame, Clock, History, Method
from garmentbench.metrics.ms_per_frame import LOAD, SLACK_MS
from garmentbench.pipeline.choice import MethodChoice, choose_method
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.storage.runs import RunStore

SHARE = 0.1  # of its training steps that a method is given
AGAIN = 2  # times that what was timed under load is timed again
XPBD = 10  # substeps a frame of the budgeted simulator
BLOCK = 5  # neighbouring frames, whose times are alike, are drawn together for the interval
WARM_UP = 3  # frames
METHODS = (
    "skinning",
    "linear_subspace",
    "linear_memory",
    "pose_gru",
    "motion_guided@no_collision",
    "motion_guided@push_out",
    "motion_guided",
)


@dataclass(frozen=True)
class Timed:
    """What was timed.

    Attributes:
        name: Of the method and its variant, or of the simulator.
        ms: Wall time of each frame [ms], shape (T,).
        processor_ms: Processor time of each frame [ms], shape (T,); None where a CUDA device is waited for.
        memory_mb: The largest resident memory of its process [MB], Python and libraries included.
        threads: That it may use.
        ending: How its roll-out ended; empty where all is well.
    """

    name: str
    ms: Float[np.ndarray, " frames"]
    processor_ms: Float[np.ndarray, " frames"] | None
    memory_mb: float
    threads: int = 1
    ending: str = ""

    @property
    def under_load(self) -> bool:
        """Did the machine do other work meanwhile? As for results (`metrics.ms_per_frame`)."""
        if self.processor_ms is None:
            return False
        wall, own = np.median(self.ms), np.median(self.processor_ms)
        return bool(wall > LOAD * own and wall > own + SLACK_MS)


@dataclass(frozen=True)
class Bench:
    """A scene on which this machine is timed.

    Attributes:
        preset: Sizes of mesh and network.
        folder: Where the sequence and the trained methods lie.
        path: The sequence.
        simulated: The simulator's line, and the budgeted one's.
    """

    preset: Preset
    folder: Path
    path: Path
    simulated: tuple[Timed, ...]

    def method(self, name: str, threads: int = 1) -> Timed:
        """Time a method, "name" or "name@variant", on the scene. Raises `UserError` where it can't be trained."""
        job = (name, self.preset, self.path, self.folder, threads)
        return _quietest(lambda: _in_a_process(_time_method, *job))

    def pair(self, one: str, other: str) -> tuple[float, float, float]:
        """How much longer one method takes than another, frame by frame in turn: the ratio of their times and its 95 %
        interval. On a machine that does other work this is what counts."""
        return ratio(*_in_a_process(_time_pair, one, other, self.preset, self.path, self.folder))


def make_bench(scene: Scene, preset: Preset, frames: int, folder: Path) -> Bench:
    """Simulate so many frames of a scene, timed, into a folder."""
    if frames <= HISTORY + WARM_UP:
        raise UsageError(f"bench: {frames} frames asked for; wanted more than {HISTORY + WARM_UP}")
    scene = replace(scene, frames=frames)
    path = folder / "bench.h5"
    made = _quietest(lambda: _in_a_process(_time_simulator, scene, preset, path, None))
    budgeted = () if scene.worn_over is not None else (XPBD,)
    others = [_quietest(lambda n=n: _in_a_process(_time_simulator, scene, preset, path, n)) for n in budgeted]
    return Bench(preset, folder, path, (made, *others))


def ratio(one: Float[np.ndarray, " frames"], other: Float[np.ndarray, " frames"]) -> tuple[float, float, float]:
    """The median over frames of the ratio of two times, taken in turn, and its 95 % interval (bootstrap over blocks of
    neighbouring frames).

    Args:
        one, other: Of the same frames, shape (T,).
    """
    each, count = one / other, len(one)
    starts = np.random.default_rng(0).integers(count, size=(2000, -(-count // BLOCK), 1))
    drawn = each[(starts + np.arange(BLOCK)).reshape(2000, -1) % count]
    low, high = np.percentile(np.median(drawn, axis=1), [2.5, 97.5])
    return float(np.median(each)), float(low), float(high)


def shortened(config: Any, share: float = SHARE) -> Any:
    """A configuration with so many of the steps of each training in it, one at least."""
    if not is_dataclass(config) or isinstance(config, type):
        return config
    changed = {f.name: shortened(getattr(config, f.name), share) for f in fields(config)}
    if {"steps", "learning_rate"} <= changed.keys() and "schedule" in changed:
        changed["steps"] = max(1, round(share * changed["steps"]))
    return replace(config, **changed)


def _quietest(time_it: Callable[[], Timed]) -> Timed:
    """Time it until it is not under load, and no more than a few times; the one with the least load."""
    best = time_it()
    for _ in range(AGAIN):
        if not best.under_load:
            break
        again = time_it()
        best = again if np.median(again.ms) < np.median(best.ms) else best
    return best


def _in_a_process(call: Callable[..., Any], *arguments: Any) -> Any:
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(call, *arguments).result()


def _memory_mb() -> float:
    """The largest resident memory of this process so far [MB]; Linux counts in KiB, macOS in bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 2**20 if sys.platform == "darwin" else peak / 2**10


def _time_simulator(scene: Scene, preset: Preset, path: Path, budget: int | None) -> Timed:
    """Simulate a scene's outer garment, into a file where there is no budget."""
    from garmentbench.simulation.drive import drive
    from garmentbench.simulation.outfit import Outfit
    from garmentbench.simulation.simulate import simulate

    quiet_warp()
    ticks: list[tuple[float, float]] = []

    def tick() -> None:
        ticks.append((time.perf_counter(), time.process_time()))

    device = "cuda:0" if device_name() == "cuda" else "cpu"
    outfit = Outfit.of(scene, preset)
    if budget is None:
        sequence_file.save(simulate(scene, preset, device), path)
        outfit.simulate(outfit.frames, device, step=tick)
        name = "simulator"
    else:
        layer, animation = outfit.layers[-1], outfit.animation
        inputs = (layer.garment, layer.start, animation.body, animation.positions, outfit.fps)
        drive(*inputs, layer.material, layer.settings, device, budget=budget, step=tick)
        name = f"simulator, XPBD, {budget} substeps"
    wall, own = 1e3 * np.diff(np.array(ticks), axis=0)[-scene.frames + 1 :].T
    return Timed(name, wall, None if device_name() == "cuda" else own, _memory_mb())


def _trained(name: str, preset: Preset, path: Path, folder: Path) -> tuple[Method, Any]:
    """A method trained for a little, once, and the sequence."""
    method, _, variant = name.partition("@")
    choice: MethodChoice = choose_method(method, variant or "full", preset)
    sequence = sequence_file.load(path)
    config = shortened(choice.config)
    with RunStore(folder / "runs").open("bench", {"method": name, "config": config}) as run:
        kept = run.folder / "method"
        if not run.finished:
            kept.mkdir(exist_ok=True)
            choice.method.fit((sequence,), config, run).save(kept)
            run.finish()
    return choice.method.load(kept), sequence


def _time_method(name: str, preset: Preset, path: Path, folder: Path, threads: int) -> Timed:
    from garmentbench.evaluation.rollout import OK, roll_out

    quiet_warp()
    learnt, sequence = _trained(name, preset, path, folder)
    _use(threads)
    roll = roll_out(learnt, sequence)
    frames = slice(HISTORY + WARM_UP, roll.first_bad_frame)
    if not len(roll.ms[frames]):
        raise UserError(f"bench: {name} {roll.status} in its first frames: {roll.message}")
    own = None if roll.processor_ms is None else roll.processor_ms[frames]
    ending = "" if roll.status == OK else f"{roll.status} at frame {roll.first_bad_frame}"
    return Timed(name, roll.ms[frames].sum(axis=1), own, _memory_mb(), threads, ending)


def _time_pair(one: str, other: str, preset: Preset, path: Path, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Wall times [ms] of both, shape (T,) each, one frame of the one after one of the other and then the other way."""
    quiet_warp()
    pairs = [_trained(name, preset, path, folder) for name in (one, other)]
    _use(1)
    sequence = pairs[0][1]
    states = [learnt.begin(sequence.template, History.before(sequence, HISTORY)) for learnt, _ in pairs]
    ms = np.full((len(sequence), 2), np.nan)
    for frame in range(HISTORY, len(sequence)):
        body = None if sequence.body is None else sequence.body[frame]
        for k in (0, 1) if frame % 2 else (1, 0):
            clock = Clock()
            with clock.running():
                _, states[k] = pairs[k][0].step(states[k], BodyFrame(body))
            ms[frame, k] = sum(clock.ms.values())
    one_ms, other_ms = ms[HISTORY + WARM_UP :].T
    return one_ms, other_ms


def _use(threads: int) -> None:
    torch = sys.modules.get("torch")
    if torch is not None:
        torch.set_num_threads(threads)


def cores() -> int:
    """How many processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def machine() -> str:
    """The processor, the device and what counts as its precision, in words."""
    import platform

    names = [platform.processor()]
    info = Path("/proc/cpuinfo")
    if info.is_file():
        names = [
            line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")
        ]
    return f"{(names or [''])[0] or platform.machine()}, {cores()} cores; device {device_name()}; float32"


def temporary() -> "tempfile.TemporaryDirectory[str]":
    """Where a bench lies while it runs."""
    return tempfile.TemporaryDirectory(prefix="garmentbench-bench-")


def timed_all(bench: Bench, names: tuple[str, ...]) -> Iterator[Timed]:
    """The simulator, each method on one thread, and the last one on all cores, too."""
    yield from bench.simulated
    for name in names:
        yield bench.method(name)
    if names and cores() > 1:
        yield bench.method(names[-1], cores())
