"""A made-up results.csv with its runs: several methods, seeds, a diverged and a failed roll-out, one that never ran."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from garmentbench.evals.data import card_rows
from garmentbench.evaluation.excerpt import write_excerpt
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.report.card import card_of
from garmentbench.report.lines import COLUMNS

FRAMES = 1150
WALK = {"scene": "tshirt-armspace-90", "split": "test", "garment": "tshirt", "motion": "armspace-90", "body": "base"}
STICK = {"scene": "sheet-stick-b", "split": "test", "garment": "sheet", "motion": "stick-b", "body": "stick"}
SIMULATOR_MS, SPREAD = 60.0, 0.2
SIMULATED = {
    "scene": "tshirt-armspace-90",
    "preset": "laptop",
    "split": "test",
    "motion": "armspace-90",
    "simulation": {"status": "ok", "ms_per_frame": SIMULATOR_MS},
    "ensemble": {"spread_cm": SPREAD},
}


def write_example(root: Path, frames: int = 160) -> None:
    """Write reports/laptop/results.csv and runs/ below `root`. frames: of the sequences behind the pictures."""
    walk, stick = tiny_sequence(frames), tiny_sequence(frames, kind="object")
    runs = root / "runs"
    rows = []
    methods = (("skinning", 3.8), ("hold", 2.9), ("linear_subspace", 0.9))
    for method, error in methods:
        run = write_run(runs, walk, f"evaluate-{method}", error)
        rows += measured("baselines", WALK, method, "full", 0, error, run, before=False)
    run = write_run(runs, walk, "another_run-walk", SPREAD)
    about = {"run": run, "train_frames": None, "spread": SPREAD}
    for name, value, unit in (("rollout_l2", SPREAD, "cm"), ("error", SPREAD, "cm"), ("push_growth", 14.4, "1")):
        rows.append(row("baselines", WALK, "another_run", "full", 0, name, FRAMES, value, unit, **about))
    for seed, error in enumerate((0.60, 0.70, 0.65)):
        run = write_run(runs, walk, f"evaluate-full-{seed}", error)
        for experiment in ("baselines", "ablations"):
            rows += measured(experiment, WALK, "motion_guided", "full", seed, error, run)
    run = write_run(runs, walk, "evaluate-diverged", 1.5, bad=37)
    rows += measured("baselines", WALK, "constant_velocity", "full", 0, 1.5, run, bad=37, before=False)
    rows.append(
        never_ran("ablations", WALK, "motion_guided", "no_collision", "train: raised ValueError: <bad> & (ugly)")
    )
    for train_frames, error in ((50, 1.9), (150, 0.9)):
        run = write_run(runs, walk, f"evaluate-train-{train_frames}", error)
        label = f"train_{train_frames}"
        rows += measured("table4", WALK, "motion_guided", label, 0, error, run, train_frames=train_frames)
    for method, error in methods[:2]:
        run = write_run(runs, stick, f"evaluate-stick-{method}", error)
        rows += measured("stick", STICK, method, "full", 0, error, run, human=False)
    rows += _stability(runs, walk)
    rows += [
        row("left_out", STICK, "motion_guided", "full", 0, "left_out:collision_stage", FRAMES, 21.5, "ms"),
        row("left_out", STICK, "motion_guided", "full", 0, "left_out:collision_stage", FRAMES, 1.25, "MB"),
        row("left_out", STICK, "motion_guided", "full", 0, "left_out:sdf", FRAMES, 1840000, "parameters"),
        row("left_out", STICK, "reference", "full", 0, "left_out:self_contact", FRAMES, 0.25, "cm", spread=0.5),
    ]
    rows += map(vars, card_rows(card_of(replace(walk, info=SIMULATED))))
    write_results(root / "reports" / "laptop" / "results.csv", rows)


def write_results(path: Path, rows: list[dict]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)


def _stability(runs: Path, sequence) -> list[dict]:
    """Two rungs from three starts: the simulator breaks on one of them, twice, and skinning raises on it."""
    rows = []
    for rung in ("no-stress", "stretch-100"):
        for method in ("reference", "skinning"):
            bad = None if rung == "no-stress" else 11 if method == "reference" else 60
            ended = {"first_bad_frame": bad, "rule": "strain", "status": "broken", "survived": bad and bad - 3}
            fine = {"first_bad_frame": None, "rule": "", "status": "ok", "survived": FRAMES - 3}
            starts = [fine if bad is None else ended, fine if bad is None else ended, fine]
            run = write_run(runs, sequence, f"stability-{method}-{rung}", 2.0, bad, {"starts": starts})
            values = {"passed": 3.0 if bad is None else 1.0, "starts": 3.0, "strain_p99_max": 4.5}
            about = {"status": "ok" if bad is None else "broken", "bad": bad, "run": run}
            for name, value in values.items():
                rows.append(
                    row("stability", WALK | {"scene": rung}, method, "full", 0, name, FRAMES, value, "1", **about)
                )
    return rows


def write_run(
    runs: Path, sequence, name: str, error_cm: float, bad: int | None = None, results: dict | None = None
) -> str:
    """A finished evaluation off by `error_cm`, that diverged at frame `bad`."""
    folder = runs / name
    folder.mkdir(parents=True)
    rng = np.random.default_rng(len(name))
    push = rng.standard_normal((len(sequence), sequence.garment.shape[1], 3)).astype(np.float32)
    push *= np.float32(0.01 * error_cm) / np.linalg.norm(push, axis=-1, keepdims=True)
    growth = np.linspace(0.5, 1.5, len(sequence), dtype=np.float32)[:, None, None]
    garment = sequence.garment + push * growth
    garment[:3] = sequence.garment[:3]
    if bad is not None:
        garment[bad:] = np.nan
    status, message = (
        ("ok", "") if bad is None else ("diverged", "3 of 105 vertices are not finite, the first is vertex 7")
    )
    write_excerpt(
        folder, sequence, RollOut(ROLL_OUT, 3, garment, None, np.ones((len(sequence), 3)), status, bad, message)
    )
    learned = "full" in name or "train" in name
    about = {"method": name, "variant": "full", "train_scenes": ["tshirt-armspace-75"], "train_frames": 300, "seed": 0}
    _record(
        folder,
        about | {"trained": f"training-of-{name}", "scene": "a", "preset": "laptop"},
        {"message": message} | (results or {}),
    )
    training = runs / f"training-of-{name}"
    training.mkdir()
    _record(training, about | {"config": {"width": 16, "steps": {"stage1": 3}}}, {"random": learned})
    if learned:
        log = "".join(json.dumps({"step": s, "total": 1 / (1 + s)}) + "\n" for s in range(120))
        (training / "metrics.jsonl").write_text(log)
    return name


def _record(folder: Path, identity: dict, results: dict) -> None:
    machine = {"cpu": "Example CPU", "cuda": None, "threads": 1}
    record = {"id": folder.name, "kind": folder.name.split("-")[0], "identity": identity, "stages": [], "seed": 0}
    (folder / "run.json").write_text(json.dumps(record | {"results": results, "machine": machine}))


def measured(experiment, scene, method, variant, seed, error, run, bad=None, human=True, before=True, train_frames=300):
    """All rows of one roll-out; what needs the whole of it is NaN when it ended early."""
    status = "ok" if bad is None else "diverged"
    about = {"run": run, "status": status, "bad": bad, "train_frames": train_frames}

    def make(metric, value, unit, horizon=FRAMES, needs_end=True, **more):
        value = float("nan") if bad is not None and needs_end else value
        return row(experiment, scene, method, variant, seed, metric, horizon, value, unit, **about, **more)

    rows = [
        row(
            experiment,
            scene,
            method,
            variant,
            seed,
            "one_step_l2",
            1,
            0.8 * error,
            "cm",
            run=run,
            train_frames=train_frames,
        ),
        make("rollout_l2", 0.9 * error, "cm", 50, needs_end=bad is not None and bad < 53, spread=SPREAD),
        make("rollout_l2", error, "cm", spread=SPREAD),
        make("error", 1.1 * error, "cm", spread=SPREAD),
        make("error_over_spread", 1.1 * error / SPREAD, "1"),
        make("liveliness", 0.9, "1", reference=1.0),
        make("jitter", 1.5 * error, "m/s^2", reference=0.0),
        make("skill", 1 - error / 3.8, "1"),
        make("stable_frames", FRAMES - 3 if bad is None else bad - 3, "frames", needs_end=False),
        make("ms_per_frame", 20.0 * len(method) / error**2, "ms", needs_end=False, reference=SIMULATOR_MS),
    ]
    if human:
        rows.append(make("interpenetration", 0.3, "%", reference=0.004))
    if human and before:
        rows.append(make("interpenetration_before", 5.5, "%", reference=0.004))
    return rows


def row(
    experiment,
    scene,
    method,
    variant,
    seed,
    metric,
    horizon,
    value,
    unit,
    reference=None,
    spread=None,
    status="ok",
    bad=None,
    run="",
    train_frames=300,
) -> dict:
    return {
        "preset": "laptop",
        "experiment": experiment,
        **scene,
        "method": method,
        "variant": variant,
        "train_frames": train_frames,
        "seed": seed,
        "metric": metric,
        "horizon": horizon,
        "value": value,
        "unit": unit,
        "reference_value": reference,
        "spread": spread,
        "status": status,
        "first_bad_frame": bad,
        "run_id": run,
        "train_scenes": "tshirt-armspace-75",
    }


def never_ran(experiment, scene, method, variant, message) -> dict:
    return row(
        experiment,
        scene,
        method,
        variant,
        0,
        "rollout_l2",
        None,
        float("nan"),
        "cm",
        status="failed",
        run=f"({message})",
    )
