"""Shapes of arrays, checked while tests run: which modules, and what of a function's annotations."""

import ast
from pathlib import Path
from typing import Any, get_args, get_origin

from beartype import beartype
from jaxtyping import AbstractArray

PACKAGE = Path(__file__).parents[2] / "garmentbench"
CHECKED = (
    "evaluation/excerpt.py",
    "evaluation/rollout.py",
    "geometry",
    "method.py",
    "methods/motion_guided/descriptor.py",
    "methods/motion_guided/networks.py",
    "methods/motion_guided/skinning.py",
    "metrics",
    "simulation",
    "sequence.py",
)


def checked_modules() -> list[str]:
    """Modules in `CHECKED` but those with kernels: Warp compiles a function's source and takes no wrapped one."""
    files: list[Path] = []
    for place in CHECKED:
        files += [PACKAGE / place] if place.endswith(".py") else sorted((PACKAGE / place).rglob("*.py"))
    return [
        ".".join(("garmentbench", *file.relative_to(PACKAGE).with_suffix("").parts))
        for file in files
        if file.name != "__init__.py" and not _has_kernels(file)
    ]


def _has_kernels(file: Path) -> bool:
    tree = ast.parse(file.read_text())
    return any(ast.unparse(d).startswith("wp.") for node in ast.walk(tree) for d in getattr(node, "decorator_list", ()))


def checked(function: Any) -> Any:
    """A function that checks those arguments and results that are annotated with a shape; the rest is pyright's."""
    hints = {name: hint for name, hint in function.__annotations__.items() if _has_shape(hint)}
    if not hints:
        return function
    function.__annotations__ = hints
    return beartype(function)


def _has_shape(hint: Any) -> bool:
    if isinstance(hint, type) and not get_origin(hint):
        return issubclass(hint, AbstractArray)
    return any(map(_has_shape, get_args(hint)))
