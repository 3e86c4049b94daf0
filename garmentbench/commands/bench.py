"""The command that times this machine."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyro.conf import Positional

if TYPE_CHECKING:
    from garmentbench.pipeline.bench import Timed


@dataclass(frozen=True)
class Bench:
    """Time a frame of the simulator and of methods on this machine: batch 1, one thread, each in a process of its own.

    Nothing is kept. Numbers of two machines don't belong in one table.

    Example: garmentbench bench

    Example: garmentbench bench motion_guided@push_out motion_guided --pair --scene dress-dance-spin

    Attributes:
        methods: Names, each with a variant after "@" if need be; a usual choice if none is given.
        scene: What they are timed on.
        frames: How many of it.
        pair: Two methods frame by frame in turn, and the ratio of their times with its 95 % interval: for a machine
            that does other work.
        preset: Size: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
        model: Another size of the methods' networks than the preset's.
        device: auto, cpu or cuda.
    """

    methods: Positional[tuple[str, ...]] = ()
    scene: str = "tshirt-armspace-90"
    frames: int = 60
    pair: bool = False
    preset: str = "laptop"
    mesh: str | None = None
    model: str | None = None
    device: str = "auto"

    def run(self) -> None:
        import tempfile

        from garmentbench.commands.table import print_table
        from garmentbench.device import choose_device, one_thread, require_device
        from garmentbench.errors import UsageError

        choose_device(self.device)
        one_thread()
        from garmentbench.pipeline.bench import METHODS, make_bench, timed_all, told
        from garmentbench.pipeline.choice import choose_method
        from garmentbench.scenes.presets import preset
        from garmentbench.scenes.wardrobe import load_scene

        if self.pair and len(self.methods) != 2:
            raise UsageError(f"bench --pair: {len(self.methods)} methods are given; wanted two")
        size, scene, names = preset(self.preset, self.mesh, self.model), load_scene(self.scene), self.methods or METHODS
        require_device(size)
        for name in names:  # before minutes are spent
            method, _, variant = name.partition("@")
            choose_method(method, variant or "full", size)
        print(f"{told()}; {scene.name}, {size.name}")
        with tempfile.TemporaryDirectory(prefix="garmentbench-bench-") as folder:
            bench = make_bench(scene, size, self.frames, Path(folder))
            if self.pair:
                times, low, high = bench.pair(*names)
                print(f"{names[0]} takes {times:.2f} times as long as {names[1]} ({low:.2f} to {high:.2f})")
                return
            print_table([_row(timed) for timed in timed_all(bench, tuple(names))])


def _row(timed: "Timed") -> dict[str, Any]:
    import numpy as np

    own = timed.processor_ms
    return {
        "": timed.name,
        "threads": timed.threads,
        "ms a frame": float(np.median(timed.ms)),
        "95th percentile": float(np.percentile(timed.ms, 95)),
        "processor ms": None if own is None else float(np.median(own)),
        "peak memory [MB]": round(timed.memory_mb),
        "note": "; ".join(filter(None, (timed.ending, "timed under load" * timed.under_load))) or None,
    }
