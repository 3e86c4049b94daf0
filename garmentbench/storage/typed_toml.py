"""TOML files read into dataclasses.

What does not fit is one line that names file, key, what was found and what is wanted.
"""

import math
import re
import tomllib
from dataclasses import MISSING, Field, fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

import msgspec

from garmentbench.errors import UserError, unknown_name

T = TypeVar("T")

_KINDS = {
    "str": "a text in quotes",
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "array": "a list",
    "object": "a table",
}


def read_toml(path: Path) -> dict[str, Any]:
    """The table of a TOML file. Raises `UserError` where it can't be read."""
    try:
        return tomllib.loads(path.read_text())
    except OSError as e:
        raise UserError(f"{path}: {e.strerror}; wanted a TOML file") from e
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise UserError(f'{path}: not a TOML file ({e}); wanted lines like frames = 100 and motion = "fast"') from e


def typed(table: dict[str, Any], kind: type[T], file: Path | str) -> T:
    """A table as a dataclass, of the types and limits (`msgspec.Meta`) that its fields are annotated with.

    A dataclass of which one text is all that is required may be given as that text: motion = "fast", for one.

    Args:
        table: As TOML gives it.
        kind: The dataclass; those nested in it and tables of them are read alike.
        file: What messages call the table's file.

    Raises:
        UserError: A key is unknown, missing, or its value does not fit.
    """
    return _converted(table, kind, str(file), "")


def _converted(value: Any, kind: Any, file: str, at: str) -> Any:
    """A value as a kind. `at`: the dotted key of the value, "" for the whole file."""
    _check(value, kind, file, at)
    try:
        return msgspec.convert(value, kind)
    except msgspec.ValidationError as e:
        raise UserError(f"{file}: {_complaint(str(e), value, kind, at)}") from None


def _check(value: Any, kind: Any, file: str, at: str) -> None:
    """Raises `UserError` for a key that no dataclass has, for a number that is not finite, and in a table of named
    entries for the entry that does not fit. Texts that stand for a dataclass become tables."""
    if isinstance(value, float) and not math.isfinite(value):
        raise UserError(f"{file}: {at} is {value}; wanted a finite number")
    if isinstance(value, list):
        for i, item in enumerate(value):
            _check(item, _item_kind(kind), file, f"{at}[{i}]")
    if not isinstance(value, dict):
        return
    inner = _dataclass(kind)
    hints = get_type_hints(inner, include_extras=True) if inner else None
    for key, item in value.items():
        where = f"{at}.{key}" if at else key
        if hints is not None and key not in hints:
            raise UserError(f"{file}: {unknown_name(f'key of [{at}]' if at else 'key', key, list(hints))}")
        if hints is not None:
            text = _sole_text(hints[key])
            if text and isinstance(item, str):
                value[key] = item = {text: item}
            _check(item, hints[key], file, where)
        elif get_origin(kind) is dict:
            _converted(item, get_args(kind)[1], file, where)


def _item_kind(kind: Any) -> Any:
    """What a list's items are to be, where a kind is a list or may be one; None elsewhere."""
    if get_origin(kind) is list:
        return get_args(kind)[0]
    return next((found for part in get_args(kind) if (found := _item_kind(part)) is not None), None)


def _dataclass(kind: Any) -> Any:
    """The dataclass that a kind is, or may be (`X | None`)."""
    if get_origin(kind) is dict:
        return None
    return next((k for k in (kind, *get_args(kind)) if is_dataclass(k)), None)


def _sole_text(kind: Any) -> str | None:
    """The field of a dataclass that a text alone stands for: the only one that is required, if it is a text."""
    holder = _dataclass(kind)
    required = [f.name for f in fields(holder) if _is_required(f)] if holder else []
    return required[0] if len(required) == 1 and get_type_hints(holder)[required[0]] is str else None


def _complaint(message: str, value: Any, kind: Any, at: str) -> str:
    """msgspec's message with the key as it is written, the value that was found, and what is wanted in plain words."""
    message, _, path = message.partition(" - at `$")
    path = path.rstrip("`").lstrip(".")
    for step in re.findall(r"[\w-]+", path):
        value = value[int(step) if isinstance(value, list) else step]
        holder = _dataclass(kind)
        kind = get_type_hints(holder)[step] if holder else _item_kind(kind) or (get_args(kind) or (None,))[-1]
    key = ".".join(filter(None, (at, path)))
    if message.startswith("Object missing"):
        holder = _dataclass(kind)
        lacking = [f.name for f in fields(holder) if _is_required(f) and f.name not in value]
        wanted = [_described(get_type_hints(holder, include_extras=True)[name]) for name in lacking]
        named = ", ".join(lacking) + (" is" if len(lacking) == 1 else " are")
        return f"{key + ': ' if key else ''}{named} missing; wanted {', '.join(wanted)}"
    return f"{key} is {value!r}; wanted {_wanted(message, kind)}"


def _is_required(field: Field) -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _described(kind: Any) -> str:
    """What is wanted of a kind, in plain words, as msgspec complains of what fits none."""
    try:
        msgspec.convert(object(), kind)
    except msgspec.ValidationError as e:
        return _wanted(str(e), kind)
    return "anything"


def _wanted(message: str, kind: Any) -> str:
    if get_origin(kind) is Literal:
        return " or ".join(f'"{choice}"' for choice in get_args(kind))
    expected = re.match(r"Expected `([^`]*)`(.*?)(, got .*)?$", message)
    if expected is None:
        return message
    kinds = [_KINDS.get(name, name) for name in expected[1].split(" | ") if name != "null"]
    limit = expected[2].replace(">=", "of at least").replace("<=", "of at most").replace(" > ", " above ")
    kinds = ["a text in quotes"] * (_sole_text(kind) is not None) + kinds
    return " or ".join(dict.fromkeys(kinds)) + re.sub(r"\.0$", "", limit)
