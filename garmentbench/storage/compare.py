"""Runs side by side: what differs between their configurations, and what came out."""

from typing import Any

from garmentbench.storage.runs import Run, flat


def list_rows(runs: list[Run]) -> list[dict[str, str]]:
    """One row a run: id, state, when started, wall time, and what it was about in a few words.

    At last why it failed.
    """
    return [
        {
            "run": run.id,
            "state": run.state,
            "started": run.times["started"][:16].replace("T", " "),
            "seconds": f"{run.times['seconds']:.0f}",
            "about": _about(run.identity) + _complaint(run),
        }
        for run in runs
    ]


def _about(identity: dict) -> str:
    """The names in an identity, outermost first: method, variant, scenes, preset, seed."""
    words = []
    for key in ("method", "variant", "train_scenes", "scene", "preset", "frames", "seed"):
        if key in identity:
            value = identity[key]
            words.append(
                f"{key} {value}"
                if key in ("frames", "seed")
                else "+".join(value)
                if isinstance(value, list)
                else str(value)
            )
    return " ".join(words)


def _complaint(run: Run) -> str:
    """Why a run failed, or a method in it; empty where neither did."""
    if run.failure is not None:
        return f": {run.failure}"
    results = (run.record or {}).get("results", {})
    message = results.get("message")
    return f": {results['status']}: {message}" if message else ""


def compare(runs: list[Run]) -> list[tuple[str, list[Any]]]:
    """What differs in the identities of runs, then all of their results.

    Each row is a dotted key and its value in every run; None where a run has no such value.
    """
    configs = [{k: v for k, v in flat(run).items() if k.startswith("identity.")} for run in runs]
    configs = [{"state": run.state} | config for run, config in zip(runs, configs, strict=True)]
    differing = [row for row in _table(configs) if any(v != row[1][0] for v in row[1])]
    return differing + _table([_results(run) for run in runs])


def _results(run: Run) -> dict[str, Any]:
    """Results of a finished run under one name each; measured rows are named by metric, horizon and unit."""
    if not run.finished:
        return {}
    values = {k: v for k, v in flat(run).items() if k.startswith("results.")}
    rows = values.pop("results.rows", [])
    for row in rows:
        horizon = f"@{row['horizon']}" if row.get("horizon") else ""
        values[f"{row['metric']}{horizon} [{row['unit']}]"] = row["value"]
        if row.get("note"):
            values[f"{row['metric']}{horizon} note"] = row["note"]
    return values | {"seconds": run.times["seconds"]}


def _table(columns: list[dict[str, Any]]) -> list[tuple[str, list[Any]]]:
    keys = dict.fromkeys(key for column in columns for key in column)
    return [(key, [column.get(key) for column in columns]) for key in keys]
