"""This machine's clock: what a frame takes, of the simulator and of methods, measured beside one another.

Each is timed in a process of its own, whose peak of memory is then its own: batch 1, after a warm-up, synchronised,
with neither recording nor metrics inside, but for the strain that the simulator itself watches. What was timed while
the machine did other work is timed again. Methods are trained for a tenth of their steps, on the frames that they are
then timed on: times don't depend on what was learnt, but for a collision stage that has more to do behind a worse
prediction.
"""

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from pebble import ProcessExpired, ProcessPool

from garmentbench import sequence_file
from garmentbench.device import device_name, quiet_warp
from garmentbench.errors import FOREIGN, UsageError, UserError, described
from garmentbench.method import HISTORY, BodyFrame, Clock, History, Method
from garmentbench.metrics.ms_per_frame import LOAD, SLACK_MS
from garmentbench.pipeline.choice import MethodChoice, choose_method
from garmentbench.pipeline.shell import foreign_code
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.storage.machine import core_count, forget_peak_memory, machine, peak_memory_mb
from garmentbench.storage.runs import RunStore

SHARE = 0.1  # of its training steps that a method is given
AGAIN = 2  # times that what was timed under load is timed again
XPBD = 16  # substeps a frame of the budgeted simulator; with 10 a laptop T-shirt is strained by half
BLOCK = 5  # neighbouring frames, whose times are alike, are drawn together for the interval
WARM_UP = 3  # frames
METHODS = (
    "skinning",
    "linear_subspace",
    "linear_memory",
    "pose_gru",
    "tuned",
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
        memory_mb: The most memory that its process held meanwhile [MB], Python and libraries included.
        threads: That it may use.
        ending: How its roll-out or simulation ended; empty where all is well.
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
        """Time a method, "name" or "name@variant", on the scene. Raises `UserError` where it fails."""
        of = (name, self.preset, self.path, self.folder)
        _in_a_process(train_little, *of)
        return _quietest(lambda: _in_a_process(time_method, *of, threads))

    def pair(self, one: str, other: str) -> tuple[float, float, float]:
        """How much longer one method takes than another, frame by frame in turn: the ratio of their times and its 95 %
        interval. On a machine that does other work this is what counts."""
        for name in (one, other):
            _in_a_process(train_little, name, self.preset, self.path, self.folder)
        return ratio(*_in_a_process(_time_pair, one, other, self.preset, self.path, self.folder))


def make_bench(scene: Scene, preset: Preset, frames: int, folder: Path) -> Bench:
    """Simulate that many frames of a scene, at most those that the preset allows, into a folder, and time it."""
    frames = preset.mesh.limited(frames)
    if frames <= HISTORY + WARM_UP:
        raise UsageError(f"bench: {frames} frames; wanted more than {HISTORY + WARM_UP}")
    scene, path = replace(scene, frames=frames), folder / "bench.h5"
    _in_a_process(simulate_into, scene, preset, path)
    budgets = (None,) if scene.worn_over is not None else (None, XPBD)
    simulated = [_quietest(lambda n=n: _in_a_process(time_simulator, scene, preset, n)) for n in budgets]
    return Bench(preset, folder, path, tuple(simulated))


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
    """A configuration with this share of the steps of each training in it, one step at least."""
    if not is_dataclass(config) or isinstance(config, type):
        return config
    changed = {f.name: shortened(getattr(config, f.name), share) for f in fields(config)}
    if {"steps", "learning_rate", "schedule"} <= changed.keys():
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
    """What a call gives in a process of its own, which ends with it, or with Ctrl-C."""
    context: Any = get_context("spawn")
    pool = ProcessPool(1, context=context)
    try:
        result = pool.schedule(call, arguments).result()
        pool.close()
    except ProcessExpired as e:
        raise UserError(
            "bench: its process died, perhaps for want of memory; try fewer frames or a smaller preset"
        ) from e
    finally:
        pool.stop()
        pool.join()
    return result


def simulate_into(scene: Scene, preset: Preset, path: Path) -> None:
    """Simulate a scene into a sequence file."""
    from garmentbench.simulation.simulate import simulate

    quiet_warp()
    sequence_file.save(simulate(scene, preset, _warp_device()), path)


def _warp_device() -> str:
    return "cuda:0" if device_name() == "cuda" else "cpu"


def time_simulator(scene: Scene, preset: Preset, budget: int | None) -> Timed:
    """Time the simulator, here: of a scene's garments, or of the one that there is with a budget of XPBD's substeps."""
    from garmentbench.simulation.drive import drive
    from garmentbench.simulation.outfit import Outfit

    quiet_warp()
    ticks: list[tuple[float, float]] = []

    def tick() -> None:
        ticks.append((time.perf_counter(), time.process_time()))

    outfit, device = Outfit.of(scene, preset), _warp_device()
    if budget is None:
        run = outfit.simulate(outfit.frames, device, step=tick)[-1].run
        name = "simulator"
    else:
        layer, animation = outfit.layers[-1], outfit.animation
        inputs = (layer.garment, layer.start, animation.body, animation.positions, outfit.fps)
        run = drive(*inputs, layer.material, layer.settings, device, budget=budget, step=tick)
        name = f"simulator, XPBD, {budget} substeps"
    wall, own = 1e3 * np.diff(np.array(ticks), axis=0)[-outfit.frames + 1 :].T
    own = None if device_name() == "cuda" else own
    ending = "" if run.first_bad_frame is None else f"{run.status} at frame {run.first_bad_frame} of warm-up and scene"
    return Timed(name, wall, own, peak_memory_mb()["process"], ending=ending)


def _chosen(name: str, preset: Preset) -> tuple[MethodChoice, Any]:
    """A method, by "name" or "name@variant", and its configuration for little training."""
    method, _, variant = name.partition("@")
    choice = choose_method(method, variant or "full", preset)
    return choice, shortened(choice.config)


def train_little(name: str, preset: Preset, path: Path, folder: Path) -> None:
    """Train a method for a little on a sequence, once, into a folder. Raises `UserError`."""
    quiet_warp()
    choice, config = _chosen(name, preset)
    with RunStore(folder / "runs").open("bench", {"method": name, "config": config}) as run:
        if not run.finished:
            kept = run.folder / "method"
            kept.mkdir(exist_ok=True)
            with foreign_code(run, "fit", choice.method):
                choice.method.fit((sequence_file.load(path),), config, run).save(kept)
            run.finish()


def _trained(name: str, preset: Preset, folder: Path) -> Method:
    choice, config = _chosen(name, preset)
    with RunStore(folder / "runs").open("bench", {"method": name, "config": config}) as run:
        return choice.method.load(run.folder / "method")


def time_method(name: str, preset: Preset, path: Path, folder: Path, threads: int) -> Timed:
    """Time a method, here, that `train_little` has trained into a folder. Raises `UserError` where it fails."""
    from garmentbench.evaluation.broken import judged
    from garmentbench.evaluation.rollout import OK, roll_out
    from garmentbench.evaluation.score import predicted

    quiet_warp()
    learnt, sequence = _trained(name, preset, folder), sequence_file.load(path)
    _use(threads)
    forget_peak_memory()
    roll = roll_out(learnt, sequence)
    memory, frames = peak_memory_mb()["process"], slice(HISTORY + WARM_UP, roll.first_bad_frame)
    if not len(roll.ms[frames]):
        raise UserError(f"bench: {name} {roll.status} in its first frames: {roll.message}")
    own = None if roll.processor_ms is None else roll.processor_ms[frames]
    roll = judged(roll, predicted(roll, sequence))
    ending = "" if roll.status == OK else f"{roll.status} at frame {roll.first_bad_frame}"
    return Timed(name, roll.ms[frames].sum(axis=1), own, memory, threads, ending)


def _time_pair(one: str, other: str, preset: Preset, path: Path, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Wall times [ms] of both, shape (T,) each, one frame of the one after one of the other and then the other way."""
    quiet_warp()
    sequence, methods = sequence_file.load(path), [_trained(name, preset, folder) for name in (one, other)]
    _use(1)
    ms = np.full((len(sequence), 2), np.nan)
    try:
        states = [method.begin(sequence.template, History.before(sequence, HISTORY)) for method in methods]
        for frame in range(HISTORY, len(sequence)):
            body = None if sequence.body is None else sequence.body[frame]
            for k in (0, 1) if frame % 2 else (1, 0):
                clock = Clock()
                with clock.running():
                    _, states[k] = methods[k].step(states[k], BodyFrame(body))
                ms[frame, k] = sum(clock.ms.values())
    except FOREIGN as e:  # a method may be anybody's, and raise anything
        raise UserError(
            f"bench --pair: a step raised {described(e, type(methods[0]))}; time it alone to see which"
        ) from e
    one_ms, other_ms = ms[HISTORY + WARM_UP :].T
    return one_ms, other_ms


def _use(threads: int) -> None:
    torch = sys.modules.get("torch")
    if torch is not None:
        torch.set_num_threads(threads)


def told() -> str:
    """The machine that is timed, in words."""
    m = machine()
    return f"{m['cpu']}, {m['cores']} cores, {m['memory_gb']} GB; device {device_name()}; float32"


def timed_all(bench: Bench, names: tuple[str, ...]) -> Iterator[Timed]:
    """The simulator, each method on one thread, and the last one with torch on all cores, too."""
    yield from bench.simulated
    for name in names:
        yield bench.method(name)
    if names and core_count() > 1:
        yield bench.method(names[-1], core_count())
