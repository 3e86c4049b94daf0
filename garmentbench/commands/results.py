"""Commands about experiments and their results: evals, runs, report, view."""

from dataclasses import dataclass
from pathlib import Path

from tyro.conf import Positional

from garmentbench.commands.table import print_table
from garmentbench.errors import UsageError, unknown_name

# What runs are filtered by most, whether or not one has it
_USUAL = {"kind", "state", "method", "variant", "scene", "train_scenes", "preset", "frames", "seed"}


@dataclass(frozen=True)
class Evals:
    """Compute experiments (all, if none is named) and write reports/<preset>. What is finished is reused.

    Example: garmentbench evals baselines --preset smoke --seeds 3
    Example: garmentbench evals convergence
    Example: garmentbench evals my_comparison.toml --preset smoke

    A file of your own (TOML, or Python with EXPERIMENTS) puts any methods through any scenes; its report is
    reports/<file's name>-<preset>:

        train = ["tshirt-armspace-75"]
        test = ["tshirt-armspace-90"]
        entries = ["skinning", "my_module:MyMethod"]

    Attributes:
        experiments: Names of experiments (validation, fabrics, difficulty, convergence and crosscheck run only when
            named), or one file.
        preset: Size: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
        model: Another size of the methods' networks than the preset's.
        seeds: How often each method whose training is random is trained, by default once or as a file says.
        data_only: Only simulate the scenes.
        device: auto, cpu or cuda.
    """

    experiments: Positional[tuple[str, ...]] = ()
    preset: str = "laptop"
    mesh: str | None = None
    model: str | None = None
    seeds: int | None = None
    data_only: bool = False
    device: str = "auto"

    def run(self) -> None:
        from garmentbench.device import choose_device
        from garmentbench.evals.own import is_file
        from garmentbench.evals.run import run, run_file
        from garmentbench.scenes.presets import preset

        size = preset(self.preset, self.mesh, self.model)
        if self.seeds is not None and self.seeds < 1:
            raise UsageError(f"evals: --seeds is {self.seeds}; wanted at least 1")
        choose_device(self.device)
        files = [name for name in self.experiments if is_file(name)]
        if len(files) == len(self.experiments) == 1:
            run_file(Path(files[0]), size, self.seeds, self.data_only)
        elif files:
            raise UsageError(f"evals: {files[0]} and others; wanted names of experiments, or one file alone")
        else:
            run(list(self.experiments), size, self.seeds, self.data_only)


@dataclass(frozen=True)
class Runs:
    """List runs, those that match key=value filters, or compare some by their ids.

    Example: garmentbench runs kind=train method=motion_guided state=finished
    Example: garmentbench runs --compare train-1f00c0ffee12 train-2f00

    Attributes:
        filters: key=value; a key is a name in run.json, such as method, scene, state or preset, with dots where
            it is nested ("identity.config.width"), or the last part of it ("width").
        compare: Ids, or beginnings of ids, of runs to lay side by side.
    """

    filters: Positional[tuple[str, ...]] = ()
    compare: tuple[str, ...] = ()

    def run(self) -> None:
        from garmentbench.storage.compare import compare, list_rows
        from garmentbench.storage.runs import RunStore

        wrong = [f for f in self.filters if "=" not in f]
        if wrong:
            raise UsageError(f"runs: '{wrong[0]}' is no filter; wanted key=value, e.g. method=skinning")
        store = RunStore()
        if self.compare:
            runs = [store.get(name) for name in self.compare]
            print_table(
                [{"": key} | dict(zip((r.id for r in runs), values, strict=True)) for key, values in compare(runs)]
            )
            return
        filters = dict(f.split("=", 1) for f in self.filters)
        known = store.keys()
        for key in filters:
            if known and key not in known | _USUAL:  # one that these runs lack is no mistake, where others have it
                raise unknown_name("filter", key, known | _USUAL)
        runs = store.list(filters)
        print_table(list_rows(runs))
        if not runs:
            print(f"no runs in {store.root}" + (" match" if self.filters else " yet"))


@dataclass(frozen=True)
class Report:
    """Make reports/<preset> again from its results.csv and the runs.

    Example: garmentbench report --preset smoke
    Example: garmentbench report my_comparison.toml --preset smoke

    Attributes:
        file: The report of your own experiments is made again; of the suite's if none is given.
        preset: Size: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
        model: Another size of the methods' networks than the preset's.
    """

    file: Positional[Path | None] = None
    preset: str = "laptop"
    mesh: str | None = None
    model: str | None = None

    def run(self) -> None:
        from garmentbench import paths
        from garmentbench.evals.own import read_experiments
        from garmentbench.evals.report import make_report
        from garmentbench.evals.run import own_report
        from garmentbench.scenes.presets import preset

        size = preset(self.preset, self.mesh, self.model)
        own = [] if self.file is None else read_experiments(self.file)
        name = size.name if self.file is None else own_report(self.file, size)
        print(make_report(name, paths.reports(), paths.runs(), own))


@dataclass(frozen=True)
class View:
    """Open a roll-out's recording in the Rerun viewer, with the reference beside it.

    Example: garmentbench view evaluate-1f00c0ffee12
    Example: garmentbench view tshirt-armspace-90
    Example: garmentbench view evaluate-1f00 --web

    Attributes:
        name: Id of an evaluation's run, or its beginning (`garmentbench runs kind=evaluate`); or a scene, for the last
            evaluation on it.
        web: Serve it to a browser, as on a machine without a display.
    """

    name: Positional[str]
    web: bool = False

    def run(self) -> None:
        from garmentbench.scenes.wardrobe import scene_names
        from garmentbench.storage.runs import RunStore
        from garmentbench.viewing.viewer import open_viewer, serve_recording

        store, scene = RunStore(), self.name.removesuffix(".h5").rpartition("/")[2]
        on_scene = store.list({"kind": "evaluate", "state": "finished", "identity.scene": scene})
        if not on_scene and (scene in scene_names() or self.name.endswith(".h5")):
            raise UsageError(
                f"view: nothing was evaluated on {scene}; garmentbench evaluate METHOD --scene {self.name}"
            )
        run = on_scene[-1] if on_scene else store.get(self.name)
        if run.kind != "evaluate":
            raise UsageError(f"view: {run.id} is no evaluation; `garmentbench runs kind=evaluate` lists those")
        (serve_recording if self.web else open_viewer)(run.folder / "recording.rrd")
