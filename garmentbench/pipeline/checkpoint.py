"""A trained method to give away: a folder of its numbers (safetensors), config.json and a card.

Nothing in it can run code. It holds what a training's folder "method" holds, whatever the method calls its files: text,
.npz arrays and .pt tensors, the numbers of all of them in one file.
"""

import hashlib
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from garmentbench.errors import UserError
from garmentbench.pipeline.choice import load_method
from garmentbench.pipeline.shell import finished
from garmentbench.storage.atomic import write_text, written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.runs import Run, RunStore

NUMBERS, CONFIG, CARD = "model.safetensors", "config.json", "README.md"
SCHEMA = 1
TEXTS = (".json", ".txt", ".toml")
SMALL = 4096  # numbers; an array of fewer keeps its precision whatever is asked for: scales and origins are such
LARGEST_HALF = 65504.0
_MAKE = "make it again (garmentbench checkpoint)"

Tree = dict[str, Any]  # tensors by name, or such dictionaries by name


def write_checkpoint(trained: Run, folder: Path, half: bool = False) -> None:
    """Write what a finished training learnt into a folder, config.json last.

    Args:
        trained: The training's run.
        folder: Is made; a checkpoint that is there is replaced.
        half: Keep arrays of `SMALL` and more floating-point numbers with 16 bits, where none is larger than these can
            hold. They come back in the precision that they had, rounded.

    Raises:
        UserError: The training is not finished, a file of the method is of no kind that can be kept, or the folder
            can't be written to.
    """
    from safetensors.numpy import save

    results, record = trained.results, trained.record or {}
    arrays: dict[str, np.ndarray] = {}
    files: dict[str, str | dict[str, str]] = {}
    for path in sorted(p for p in (trained.folder / "method").rglob("*") if p.is_file()):
        name = path.relative_to(trained.folder / "method").as_posix()
        if path.suffix in TEXTS:
            files[name] = path.read_text(encoding="utf-8")
            continue
        found = _arrays(path)
        files[name] = {key: array.dtype.str for key, array in found.items()}
        arrays |= {f"{name}/{key}": _halved(array) if half else array for key, array in found.items()}
    config = {"schema": SCHEMA, "identity": trained.identity, "results": results, "files": files}
    config |= {key: record[key] for key in ("times", "code_version", "machine")}
    numbers = save({key: np.ascontiguousarray(array).reshape(array.shape) for key, array in arrays.items()})
    with written_whole(folder / NUMBERS) as partial:
        partial.write_bytes(numbers)
    write_text(folder / CONFIG, json.dumps(config | {"sha256": hashlib.sha256(numbers).hexdigest()}, indent=1) + "\n")


def read_checkpoint(folder: Path, store: RunStore) -> Run:
    """The finished training run of a checkpoint's folder, in that store, to be evaluated as any other.

    Raises:
        UserError: The folder holds no checkpoint, or a damaged one.
    """
    config, numbers = _config(folder), _bytes(folder)
    if hashlib.sha256(numbers).hexdigest() != config["sha256"]:
        raise UserError(f"{folder / NUMBERS}: is not the file that {CONFIG} was written for; copy the folder again")
    method = load_method(config["identity"]["class"])
    left_out = ("code", "device")  # of the training; what it learnt is what counts here
    identity = {key: value for key, value in config["identity"].items() if key not in left_out} | {
        "checkpoint": config["sha256"],
        "code": fingerprint(method.__module__),
    }
    with store.open("train", identity) as run:
        if not run.finished:
            _restore(folder, config, numbers, run.folder / "method")
            run.finish(config["results"])
    return finished(run)


def is_checkpoint(word: str) -> bool:
    """Does a word name a folder that holds a checkpoint, or claims to?"""
    return (Path(word) / CONFIG).is_file()


def write_card(folder: Path, rows: list[tuple[str, dict[str, Any]]]) -> None:
    """Write the card: what it is, what it was trained on, what that cost, and how well it does.

    Args:
        folder: Of a checkpoint.
        rows: Of its evaluations: the scene, and a row of results.
    """
    config = _config(folder)
    about, results = config["identity"], config["results"]
    garment, machine = results.get("garment", {}), config["machine"]
    size = sum((folder / name).stat().st_size for name in (NUMBERS, CONFIG)) / 1e6
    lines = [
        f"# {about['method']} ({about['variant']}), {garment.get('name', 'any garment')}",
        "",
        f"- **Trained on** {_several(about['train_scenes'])}: {_several(about['train_frames'])} frames, seed "
        f"{about['seed']}, preset {about.get('preset', '?')}, simulated by garmentbench itself.",
        f"- **Garment mesh**: {garment.get('vertices', '?')} vertices; it predicts no other.",
        f"- **Cost**: {config['times']['seconds'] / 60:.1f} minutes on {machine.get('cpu', '?')}, "
        f"{machine.get('threads', '?')} thread, stages shared with other trainings not counted.",
        f"- **Made by** garmentbench {config['code_version']}; {size:.1f} MB.",
        "- **Licence**: that of garmentbench, Apache 2.0. No one's scans or recordings went into it.",
        "",
        "| scene | roll-out error | single step | time a frame | status |",
        "| --- | ---: | ---: | ---: | --- |",
    ]
    for scene in dict.fromkeys(scene for scene, _ in rows):
        of_scene = [row for name, row in rows if name == scene]
        cells = [_value(of_scene, metric) for metric in ("rollout_l2", "one_step_l2", "ms_per_frame")]
        status = next((row["status"] for row in of_scene if row["metric"] == "rollout_l2"), "")
        lines.append(f"| {scene} | {' | '.join(cells)} | {status} |")
    lines += ["", f"    garmentbench evaluate {folder.as_posix()} --scene {rows[0][0]}"] if rows else []
    write_text(folder / CARD, "\n".join(lines) + "\n")


def _value(rows: list[dict[str, Any]], metric: str) -> str:
    """A metric's value at the longest horizon, with its unit."""
    found = [row for row in rows if row["metric"] == metric and row["value"] is not None]
    if not found:
        return "–"
    row = max(found, key=lambda row: row.get("horizon") or 0)
    return f"{row['value']:.3g} {row['unit']}"


def _several(values: Any) -> str:
    return ", ".join(map(str, values)) if isinstance(values, list) else str(values)


def _config(folder: Path) -> dict[str, Any]:
    path = folder / CONFIG
    try:
        config = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as e:
        raise UserError(f"{folder}: has no {CONFIG}; wanted a checkpoint's folder") from e
    except (OSError, ValueError) as e:
        raise UserError(f"{path}: can't be read ({e}); {_MAKE}") from e
    wanted = {"schema", "identity", "results", "files", "times", "code_version", "machine", "sha256"}
    if not isinstance(config, dict) or not wanted <= config.keys() or "class" not in config["identity"]:
        raise UserError(f"{path}: is no checkpoint's; wanted {', '.join(sorted(wanted))}; {_MAKE}")
    if config["schema"] != SCHEMA:
        raise UserError(f"{path}: is of schema {config['schema']}, this garmentbench reads {SCHEMA}; {_MAKE}")
    return config


def _bytes(folder: Path) -> bytes:
    try:
        return (folder / NUMBERS).read_bytes()
    except OSError as e:
        raise UserError(f"{folder / NUMBERS}: can't be read ({e.strerror or e}); copy the folder again") from e


def _restore(folder: Path, config: dict[str, Any], numbers: bytes, target: Path) -> None:
    """Write the files of a trained method as it wrote them itself."""
    from safetensors.numpy import load

    arrays = load(numbers)
    for name, content in config["files"].items():
        path = target / name
        if not path.resolve().is_relative_to(target.resolve()):
            raise UserError(f"{folder / CONFIG}: names the file {name}, which lies outside of the folder; {_MAKE}")
        if isinstance(content, str):
            write_text(path, content)
            continue
        found = {key: arrays[f"{name}/{key}"].astype(kind, copy=False) for key, kind in content.items()}
        with written_whole(path) as partial:
            partial.write_bytes(_npz(found) if path.suffix == ".npz" else _pt(found))


def _arrays(path: Path) -> dict[str, np.ndarray]:
    """The arrays in a method's file, by name; of nested tensors the names are paths."""
    if path.suffix == ".npz":
        with np.load(path, allow_pickle=False) as file:
            found = dict(file)
    elif path.suffix == ".pt":
        import torch

        found = dict(_leaves(torch.load(path, map_location="cpu", weights_only=True)))
    else:
        raise UserError(f"{path}: can't go into a checkpoint; wanted .npz, .pt or text ({', '.join(TEXTS)})")
    wrong = sorted(key for key, array in found.items() if array.dtype.kind not in "biuf")
    if wrong:
        raise UserError(f"{path}: {wrong[0]} holds no numbers ({found[wrong[0]].dtype}); wanted numbers alone")
    return found


def _leaves(tree: Tree, prefix: str = "") -> Iterator[tuple[str, np.ndarray]]:
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{prefix}{key}/")
        else:
            yield f"{prefix}{key}", value.numpy()


def _npz(arrays: dict[str, Any]) -> bytes:
    out = io.BytesIO()
    np.savez(out, **arrays)
    return out.getvalue()


def _pt(arrays: dict[str, np.ndarray]) -> bytes:
    import torch

    tree: Tree = {}
    for key, array in arrays.items():
        *above, last = key.split("/")
        at = tree
        for name in above:
            at = at.setdefault(name, {})
        at[last] = torch.from_numpy(array.copy())
    out = io.BytesIO()
    torch.save(tree, out)
    return out.getvalue()


def _halved(array: np.ndarray) -> np.ndarray:
    large = array.dtype.kind == "f" and array.size >= SMALL
    return array.astype(np.float16) if large and np.abs(array).max() <= LARGEST_HALF else array
