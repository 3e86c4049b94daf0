"""Hashes of what decides a result: plain values, and the source code that computes it."""

import ast
import dataclasses
import hashlib
import importlib.util
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

# Modules that carry results without deciding them: an edit there keeps what was trained and simulated. They count where
# they are named themselves.
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
    )
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
    as_list = getattr(value, "tolist", None)
    if as_list is not None:
        return as_list()
    raise TypeError(f"{type(value).__name__} is not plain JSON: {value!r}")


def content_hash(value: Any) -> str:
    """The first 12 hexadecimal digits of the SHA-256 of a plain value's canonical JSON."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()[:12]


def fingerprint(*sources: str | Path) -> str:
    """Hash of the code (and data) that a result depends on.

    A module's name ("garmentbench.simulation") stands for that module, or all modules of that package, and every module
    of the same project that they import, directly or not. Modules count by what they contain, whatever they are called
    and wherever they lie. Comments, docstrings, layout, plain functions' annotations and imports for type checkers
    don't count. A path stands for the bytes of that file or folder. Raises ModuleNotFoundError for an unknown name.
    """
    code = [_hash_with_imports(name) for name in _reached([s for s in sources if isinstance(s, str)])]
    data = {}
    for source in (s for s in sources if isinstance(s, Path)):
        files = sorted(p for p in source.rglob("*") if p.is_file()) if source.is_dir() else [source]
        data |= {f"{source.name}/{p.relative_to(source)}": hashlib.sha256(p.read_bytes()).hexdigest() for p in files}
    return content_hash([sorted(code), data])


def _reached(names: list[str]) -> set[str]:
    """The named modules, what lies in them, and all that they import of garmentbench and their own package."""
    todo = [inner for name in names for inner in _inside(name)]
    reached: set[str] = set()
    while todo:
        name = todo.pop()
        if name not in reached:
            reached.add(name)
            todo += [found.module for found in _imports(name) if not _bystander(found.module)]
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


def _source(file: Path) -> bytes:
    return file.read_bytes()


@dataclass(frozen=True)
class _Import:
    """One name that a module imports from its own project.

    Attributes:
        module: The module that it comes from.
        attribute: Its name there; None where the module itself is imported.
        bound: Its name here.
    """

    module: str
    attribute: str | None
    bound: str


@dataclass(frozen=True)
class _Parsed:
    """A module: a hash of its own code without imports from its own project, these imports, and those for type
    checkers."""

    own: str
    imports: tuple[_Import, ...]
    typing: tuple[_Import, ...]


@cache
def _parsed(name: str) -> _Parsed:
    file = _file(name)
    assert file is not None, name
    reader = _Reader(name, name if file.name == "__init__.py" else name.rpartition(".")[0])
    tree = reader.visit(ast.parse(_source(file)))
    # A module that is used by its name ("score.rows()") is named by the order of use, so that it may be renamed.
    modules = {found.bound for found in reader.imports if found.attribute is None}
    used = [node for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id in modules]
    order = {bound: f"module {i}" for i, bound in enumerate(dict.fromkeys(node.id for node in used))}
    for node in used:
        node.id = order[node.id]
    imports = tuple(dataclasses.replace(i, bound=order.get(i.bound, i.bound)) for i in reader.imports)
    return _Parsed(hashlib.sha256(ast.dump(tree).encode()).hexdigest(), imports, tuple(reader.typing))


@cache
def _imports(name: str) -> tuple[_Import, ...]:
    """What a module imports of its own project, from where it is defined rather than from a package that passes it
    on."""
    return tuple(_defined(found) for found in _parsed(name).imports)


def _defined(found: _Import) -> _Import:
    file = _file(found.module)
    if found.attribute is None or file is None or file.name != "__init__.py":
        return found
    package = _parsed(found.module)
    passed_on = next((i for i in (*package.imports, *package.typing) if i.bound == found.attribute), None)
    return found if passed_on is None else _defined(dataclasses.replace(passed_on, bound=found.bound))


@cache
def _hash_with_imports(name: str) -> str:
    """A module's hash, with each imported name and the hash of the module that it comes from, in any order."""
    links = [(i.bound, i.attribute, None if _bystander(i.module) else _parsed(i.module).own) for i in _imports(name)]
    return content_hash([_parsed(name).own, sorted({canonical_json(link) for link in links})])


class _Reader(ast.NodeTransformer):
    """Takes out of a module what decides no result, and imports from its own project, which it notes."""

    def __init__(self, name: str, package: str) -> None:
        self.own = {"garmentbench", name.split(".")[0]}
        self.package = package.split(".")
        self.imports: list[_Import] = []
        self.typing: list[_Import] = []

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        is_text = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        return None if is_text else self.generic_visit(node)

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            count = len(self.imports)
            for statement in node.body:
                self.visit(statement)
            self.typing, self.imports = [*self.typing, *self.imports[count:]], self.imports[:count]
            return [kept for statement in node.orelse if (kept := self.visit(statement)) is not None]
        return self.generic_visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        if not node.decorator_list:  # a decorator may go by the annotations, as Warp's kernels do
            node.returns = None
            for argument in ast.walk(node.args):
                if isinstance(argument, ast.arg):
                    argument.annotation = None
        return self.generic_visit(node)

    def visit_Import(self, node: ast.Import) -> ast.AST | None:
        ours = [a for a in node.names if a.name.split(".")[0] in self.own and _file(a.name) is not None]
        self.imports += [_Import(a.name, None, a.asname or a.name) for a in ours]
        node.names = [a for a in node.names if a not in ours]
        return node if node.names else None

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST | None:
        above = self.package[: len(self.package) - node.level + 1] if node.level else []
        module = ".".join([*above, *([node.module] if node.module else [])])
        if module.split(".")[0] not in self.own:
            return node
        for alias in node.names:
            inner, bound = f"{module}.{alias.name}", alias.asname or alias.name
            if _file(inner) is not None:  # the module itself; its package's own code is not used
                self.imports.append(_Import(inner, None, bound))
            elif _file(module) is not None:
                self.imports.append(_Import(module, alias.name, bound))
        return None
