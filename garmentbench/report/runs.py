"""The runs behind a report, in a form small enough to go with it: ids, configurations, loss curves, commands.

The run folders themselves (checkpoints, roll-outs, recordings) are hundreds of times larger and stay where they were
made.
"""

import json
import shlex
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.report.lines import Line, Results
from garmentbench.report.page import Picture, Section
from garmentbench.report.plots import STYLE, logarithmic, style, svg
from garmentbench.report.table import Cell, Table
from garmentbench.scenes.training_sets import MARK, title

if TYPE_CHECKING:
    from pathlib import Path

FILE = "runs.json"
POINTS = 50  # of a loss curve
LOSS = ("total", "loss")  # what a method's log calls its loss
CURVES = "Loss of each training, by its steps; several curves of a colour are its seeds. One panel a stage."


def runs_section(name: str, lines: list[Line], results: Results) -> Section | None:
    """The runs of a part's lines: a table, and the loss curves where something was learned.

    None where there is no run.
    """
    rows, full = [], {line.method: _config(line, results) for line in reversed(lines) if line.variant in ("", "full")}
    for line in lines:
        for run in line.run_ids:
            record = results.record(run)
            if not record:
                continue
            identity = record.get("identity", {})
            training = identity.get("trained", "")
            trained = results.training(run)
            seconds = _seconds(trained)
            rows.append(
                [
                    Cell(line.label),
                    Cell(line.scene),
                    Cell(str(record.get("seed", 0))),
                    Cell(run),
                    Cell(training),
                    Cell("" if seconds is None else f"{seconds:.0f}"),
                    Cell(_differences(_flat(_config(line, results)), _flat(full.get(line.method, {})))),
                    Cell(command(record)),
                ]
            )
    if not rows:
        return None
    table = Table(
        f"runs-{name}",
        "Runs",
        "",
        ["method", "scene", "seed", "run", "training", "trained [s]", "configuration, against full", "command"],
        rows,
        frozenset({0, 1, 3, 4, 6, 7}),
    )
    curves = _loss_plot(lines, results)
    return Section(table, [Picture(f"plots/{name}-loss.svg", CURVES, curves)] if curves else [])


def runs_json(lines: list[Line], results: Results) -> bytes:
    """All runs of a report as JSON: `runs` by id, their `trainings`, the `stages` of those with their loss curves."""
    runs: dict[str, dict] = {}
    trainings: dict[str, dict] = {}
    stages: dict[str, dict] = {}
    for line in lines:
        for run in line.run_ids:
            record = results.record(run)
            if not record or run in runs:
                continue
            identity = record.get("identity", {})
            runs[run] = {
                "method": line.method,
                "variant": line.variant,
                "scene": line.scene,
                "seed": record.get("seed", 0),
                "training": identity.get("trained"),
                "command": command(record),
                **_made(record),
            }
            trained = results.training(run)
            if trained:
                named = [s for s in (*trained["stages"], trained["id"]) if _log(s, results).is_file()]
                trainings[trained["id"]] = {"identity": trained["identity"], "stages": named, **_made(trained)}
                stages |= {
                    s: {"seconds": _seconds(results.record(s)), "log": loss_curve(_log(s, results))} for s in named
                }
    whole = {"runs": runs, "trainings": trainings, "stages": stages}
    parts = [
        f'"{part}": {{\n' + ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in sorted(named.items())) + "\n}"
        for part, named in whole.items()
    ]
    return ("{\n" + ",\n".join(parts) + "\n}\n").encode()  # a run a line, so that differences can be read


def command(record: dict[str, Any]) -> str:
    """The command that makes a run, from its run.json."""
    identity = record.get("identity", {})
    if record.get("kind") == ANOTHER_RUN:
        return f"garmentbench simulate {identity['scene']} --preset {identity['preset']}"
    if record.get("kind") != "evaluate":
        return f"garmentbench evals {record.get('kind', '')} --preset {identity.get('preset', '')}" if record else ""
    experiment, own, _ = str(identity.get("variant", "")).partition(":")
    if own:  # a variant that only an experiment has
        return f"garmentbench evals {experiment} --preset {identity['preset']}"
    scenes = identity.get("train_scenes", [])
    options = [("scene", "scene"), ("frames", "train_frames"), ("variant", "variant"), ("seed", "seed")]
    if MARK in title(scenes):
        scenes = [title(scenes)]
        options.remove(("frames", "train_frames"))  # the set says so itself
    words = ["garmentbench", "evaluate", _typed(identity)]
    for scene in scenes:
        words += ["--train-scene", scene]
    for option, key in options:
        if identity.get(key) not in (None, "full", 0):  # those are what the command takes anyhow
            words += [f"--{option}", str(identity[key])]
    return shlex.join([*words, "--preset", str(identity["preset"])])


def loss_curve(path: "Path") -> dict[str, list[float | None]]:
    """What a training logged, thinned to `POINTS` steps: a list a quantity; NaN where it was not logged."""
    if not path.is_file():
        return {}
    lines = [json.loads(line) for line in path.read_text().splitlines(keepends=True) if line.endswith("\n")]
    chosen = sorted(set(np.linspace(0, len(lines) - 1, min(POINTS, len(lines))).round().astype(int)))
    names = dict.fromkeys(name for line in lines for name in line)
    return {name: [_short(lines[i].get(name)) for i in chosen] for name in names}


def _short(value: float | None) -> float | None:
    return value if value is None or isinstance(value, int) else float(f"{value:.4g}")


def _log(run: str, results: Results) -> "Path":
    return results.runs_root / run / "metrics.jsonl"


def _typed(identity: dict[str, Any]) -> str:
    """The method as it is typed: its name, or where it is nobody's that comes along "module:Class"."""
    address = identity.get("class", "")
    return identity["method"] if address.startswith("garmentbench.") or not address else address


def _made(record: dict[str, Any]) -> dict[str, Any]:
    """When, by what and on what a run was made."""
    keys = ("code_version", "peak_memory_mb")
    machine = record.get("machine", {})
    return {
        **{key: record.get(key) for key in keys},
        "started": record.get("times", {}).get("started"),
        "seconds": _seconds(record),
        "machine": machine.get("cuda") or machine.get("cpu"),
        "packages": record.get("packages"),
    }


def _seconds(record: dict[str, Any]) -> float | None:
    return record.get("times", {}).get("seconds")


def _config(line: Line, results: Results) -> dict[str, Any]:
    """The configuration that a line's method was trained with."""
    config = results.training(line.run_ids[0]).get("identity", {}).get("config") if line.run_ids else None
    return config if isinstance(config, dict) else {}


def _flat(config: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat = {}
    for key, value in config.items():
        flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {f"{prefix}{key}": value}
    return flat


def _differences(config: dict[str, Any], full: dict[str, Any]) -> str:
    """What a configuration has otherwise than the full one."""
    return ", ".join(
        f"{key} = {json.dumps(value)}" for key, value in config.items() if key in full and full[key] != value
    )


def _loss_plot(lines: list[Line], results: Results) -> bytes:
    """Loss over steps, a panel a kind of stage; nothing where nothing was logged."""
    found: dict[str, list[tuple[str, dict]]] = {}  # kind of stage -> label and curve of each training
    for line in lines:
        for run in line.run_ids:
            trained = results.training(run)
            for stage in (*trained.get("stages", ()), *([trained["id"]] if trained else ())):
                curve = loss_curve(_log(stage, results))
                if any(name in curve for name in LOSS):
                    found.setdefault(stage.rsplit("-", 1)[0], []).append((line.label, curve))
    if not found:
        return b""
    looks = style(lines)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(min(3.6 * len(found) + 2, 11), 2.8), layout="constrained")
        for axes, (kind, curves) in zip(figure.subplots(1, len(found), squeeze=False)[0], found.items(), strict=True):
            for name, curve in curves:
                loss = next(curve[key] for key in LOSS if key in curve)
                seen = name in axes.get_legend_handles_labels()[1]
                axes.plot(
                    curve["step"],
                    np.array(loss, float),
                    color=looks[name][0],
                    linewidth=1.4,
                    label=None if seen else name,
                )
            logarithmic(axes.yaxis)
            axes.set(title=kind, xlabel="step")
        names = {
            name: handle for axes in figure.axes for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(names.values(), names.keys(), loc="outside right center")
        return svg(figure)
