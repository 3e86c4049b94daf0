"""Hashes of what decides a result: plain values, and the source code that computes it."""

import ast
import dataclasses
import hashlib
import importlib.util
import json
from functools import cache
from pathlib import Path
from typing import Any

# Modules that carry results about but don't decide them: an edit there keeps what was trained and simulated. They count
# where they are named themselves.
BYSTANDERS = frozenset(
    f"garmentbench.{name}"
    for name in (
        "cli",
        "commands",
        "errors",
        "paths",
        "pipeline",
        "progress",
        "report",
        "storage.atomic",
        "storage.compare",
        "storage.fingerprint",
        "storage.jobs",
        "storage.lock",
        "storage.machine",
        "storage.runs",
        "viewing",
    )  # fmt: skip
)


def canonical_json(value: Any) -> str:
    """JSON that depends on content only: keys sorted, dataclasses as objects, tuples as arrays.

    Raises TypeError for what is not plain, ValueError for NaN and infinity.
    """
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False, default=plain)


def plain(value: Any) -> Any:
    """The plain JSON value of a dataclass, a path, a set or a NumPy scalar. Raises TypeError for anything else."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, set | frozenset):
        return sorted(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not plain JSON: {value!r}")


def content_hash(value: Any) -> str:
    """The first 12 hexadecimal digits of the SHA-256 of a plain value's canonical JSON."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()[:12]


def fingerprint(*sources: str | Path) -> str:
    """Hash of the code (and data) that a result depends on.

    A module's name ("garmentbench.simulation") stands for that module, or all modules of that package, and every
    module of the same project that they import, directly or not. A path stands for the bytes of that file or folder.
    Comments, docstrings and layout don't count, so that an explanation may be improved without training again.
    """
    names = [s for s in sources if isinstance(s, str)]
    parts = {name: _code(name) for name in _reached(names)}
    for source in sources:
        if isinstance(source, Path):
            files = sorted(p for p in source.rglob("*") if p.is_file()) if source.is_dir() else [source]
            parts |= {
                f"{source.name}/{p.relative_to(source)}": hashlib.sha256(p.read_bytes()).hexdigest() for p in files
            }
    return content_hash(parts)


def _reached(names: list[str]) -> set[str]:
    """The named modules, what lies in them, and all that they import of garmentbench, methods and their own package."""
    projects = {"garmentbench"} | {name.split(".")[0] for name in names}
    todo = [inner for name in names for inner in _inside(name)]
    reached: set[str] = set()
    while todo:
        name = todo.pop()
        if name in reached or name.split(".")[0] not in projects:
            continue
        reached.add(name)
        todo += [found for found in _imports(name) if not _bystander(found)]
    return reached


def _bystander(name: str) -> bool:
    return any(name == b or name.startswith(b + ".") for b in BYSTANDERS)


def _inside(name: str) -> list[str]:
    """A module's name; a package's with the names of all modules in it."""
    file = _file(name)
    if file is None:
        raise ModuleNotFoundError(f"no module named '{name}'")
    if file.name != "__init__.py":
        return [name]
    folder = file.parent
    modules = [p.relative_to(folder).with_suffix("").parts for p in folder.rglob("*.py")]
    return [".".join((name, *(m[:-1] if m[-1] == "__init__" else m))) for m in modules]


@cache
def _file(name: str) -> Path | None:
    """A module's source file, found without importing it; None where there is none."""
    top, *rest = name.split(".")
    spec = importlib.util.find_spec(top)
    if spec is None or spec.origin is None:
        return None
    if not rest:
        return Path(spec.origin)
    base = Path(spec.origin).parent.joinpath(*rest)
    return next((p for p in (base.with_suffix(".py"), base / "__init__.py") if p.is_file()), None)


@cache
def _tree(name: str) -> ast.Module:
    tree = ast.parse(_file(name).read_bytes())
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            node.body = node.body[1:]
    return tree


@cache
def _code(name: str) -> str:
    return hashlib.sha256(ast.dump(_tree(name)).encode()).hexdigest()


@cache
def _imports(name: str) -> tuple[str, ...]:
    """Names of the modules with a source file that a module imports, inside functions too."""
    package = name if _file(name).name == "__init__.py" else name.rpartition(".")[0]
    found = []
    for node in ast.walk(_tree(name)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            found += [module, *(f"{module}.{alias.name}" for alias in node.names)]
    own = {"garmentbench", name.split(".")[0]}
    return tuple(m for m in found if m.split(".")[0] in own and _file(m) is not None)
