"""The command line: finds the command, and turns what goes wrong into one line and an exit code.

0: done. 1: a file, a mesh or the machine is wrong. 2: the call is wrong. 130: Ctrl-C, or SIGTERM, which clusters send.
"""

import argparse
import contextlib
import difflib
import inspect
import io
import os
import re
import signal
import sys
import threading
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import fields
from functools import reduce
from operator import or_
from typing import Annotated, Any, cast, get_origin, get_type_hints

import garmentbench
from garmentbench import paths
from garmentbench.commands import COMMANDS, Command
from garmentbench.errors import NEAR, UsageError, UserError, unknown_name
from garmentbench.paths import HOME_VARIABLE

DESCRIPTION = """A benchmark of learned garment dynamics.

Runs, sequences and reports go to the working folder, or with --home DIR (or the environment variable GARMENTBENCH_HOME)
to another one.

Example: garmentbench evals --preset smoke"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and give its exit code. `arguments` are those of the process by default."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        with _terminated_as_interrupted():
            return _run(arguments)


@contextlib.contextmanager
def _terminated_as_interrupted() -> Iterator[None]:
    """SIGTERM does what Ctrl-C does: workers end, and locks are let go."""
    if threading.current_thread() is not threading.main_thread():
        yield  # where signals can't be set
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _run(arguments: list[str]) -> int:
    try:
        if arguments == ["--version"]:
            print(f"garmentbench {garmentbench.__version__}")
        else:
            with _home(arguments) as rest:
                parse(rest or ["--help"]).run()
        sys.stdout.flush()
    except UserError as e:
        print(f"garmentbench: {e}", file=sys.stderr)
        return e.exit_code
    except KeyboardInterrupt:
        print("garmentbench: stopped; the same command again goes on from what is finished", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of a pipe has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return 0


@contextlib.contextmanager
def _home(arguments: list[str]) -> Iterator[list[str]]:
    """Take `--home DIR` out of the arguments, wherever it stands, and obey it; gives the others."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    parser.add_argument("--home")
    try:
        known, rest = parser.parse_known_args(arguments)
    except argparse.ArgumentError:
        raise UsageError("--home: wanted a folder after it, for runs, sequences and reports") from None
    before = os.environ.get(HOME_VARIABLE)
    try:
        if known.home is not None:
            os.environ[HOME_VARIABLE] = os.path.abspath(known.home)
        if paths.home().is_file():
            raise UsageError(f"--home: {paths.home()} is a file; wanted a folder, for runs, sequences and reports")
        yield rest
    finally:
        if before is None:
            os.environ.pop(HOME_VARIABLE, None)
        else:
            os.environ[HOME_VARIABLE] = before


def parse(arguments: list[str]) -> Command:
    """The command that was typed. Raises `UsageError`, with the nearest name where one is unknown; exits after help."""
    import tyro

    name = arguments[0]
    if not name.startswith("-") and name not in COMMANDS:
        raise unknown_name("command", name, list(COMMANDS))
    about = _text if name in COMMANDS else _first_sentence
    union: Any = reduce(
        or_,
        (Annotated[kind, tyro.conf.subcommand(n, description=about(kind))] for n, kind in COMMANDS.items()),
    )
    box = io.StringIO()
    try:
        with contextlib.redirect_stderr(box):
            command, unknown = tyro.cli(
                union, args=arguments, prog="garmentbench", description=DESCRIPTION, return_unknown_args=True
            )
    except SystemExit as e:
        if e.code == 0:
            raise
        raise UsageError(_one_line(box.getvalue())) from None
    if unknown:
        raise _unknown_argument(unknown[0], name, command)
    _once(arguments, command)
    return command


def _once(arguments: list[str], command: Command) -> None:
    """Raises `UsageError` where an option is given twice that takes all its values at once: all but the last would be
    dropped."""
    from tyro.conf import UseAppendAction

    hints = get_type_hints(type(command), include_extras=True)
    for option, count in Counter(word.split("=")[0] for word in arguments if word.startswith("--")).items():
        hint = hints.get(option[2:].replace("-", "_"))
        if count > 1 and hint is not None and UseAppendAction not in getattr(hint, "__metadata__", ()):
            several = "; all its values stand after it, as in " + option + " A B" if get_origin(hint) is tuple else ""
            raise UsageError(f"{option} is given {count} times; wanted once{several}")


def _text(command: type) -> str:
    """What a command's help says above its options, each example a paragraph, as tyro joins lines."""
    return (inspect.getdoc(command) or "").partition("\n\nAttributes:")[0].replace("\nExample: ", "\n\nExample: ")


def _first_sentence(command: type) -> str:
    return re.split(r"(?<=\.)\s", _text(command))[0]


def _show_warning(message: Warning | str, *_: object) -> None:
    print(f"garmentbench: warning: {message}", file=sys.stderr)


def _unknown_argument(argument: str, name: str, command: Command) -> UsageError:
    """What to say of an argument that a command does not know."""
    if not argument.startswith("-"):
        return UsageError(f"{name}: what to do with '{argument}'? See garmentbench {name} --help")
    options = ["--" + f.name.replace("_", "-") for f in fields(cast(Any, command))]
    near = difflib.get_close_matches(argument.lstrip("-"), [o.lstrip("-") for o in options], n=1, cutoff=NEAR)
    hint = f"did you mean '--{near[0]}'? " if near else ""
    return UsageError(f"{name}: unknown option '{argument}': {hint}See garmentbench {name} --help")


def _one_line(box: str) -> str:
    """The message in one of tyro's boxes, in one line."""
    lines = [line.strip(" │") for line in box.splitlines()[1:-1]]
    message = " ".join(line for line in lines if line.strip("─"))
    return " ".join(message.split())


if __name__ == "__main__":
    sys.exit(main())
