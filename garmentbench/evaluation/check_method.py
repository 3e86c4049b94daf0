"""Does a method keep the contract of `garmentbench.method`? Named checks on tiny scenes, all of which run and report.

In a test file of the method's own package:

    @parametrize_with_checks([(MyMethod, MyMethod.Config())])
    def test_my_method(method, check):
        check(method)
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from garmentbench.errors import Problem
from garmentbench.evaluation.checks import (
    CHECKS,
    ONCE,
    SCENES,
    CheckFailedError,
    CheckFunction,
    CheckSkippedError,
    Trial,
)
from garmentbench.method import Method
from garmentbench.sequence import HUMAN

if TYPE_CHECKING:
    import pytest

PARTS = ("fit", "save", "load", "begin", "step")
PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


@dataclass(frozen=True)
class Result:
    """What a check found.

    Attributes:
        check: Its name, e.g. "output_is_finite".
        scene: "human", "object", "garment", "bodiless", or "class" for what needs no scene.
        status: "passed", "failed" or "skipped".
        problem: What is wrong, of a failed one.
        reason: Why it was skipped.
    """

    check: str
    scene: str
    status: str
    problem: Problem | None = None
    reason: str = ""

    def __str__(self) -> str:
        more = self.problem.what + "; " + self.problem.do if self.problem else self.reason
        return f"{self.scene}: {self.check.replace('_', ' ')}: {self.status}" + (f": {more}" if more else "")


@dataclass(frozen=True)
class Report:
    """What all checks of a method found."""

    method: str
    results: tuple[Result, ...]

    @property
    def ok(self) -> bool:
        """No check failed."""
        return not self.problems

    @property
    def problems(self) -> list[Problem]:
        """What is wrong, one a failed check."""
        return [result.problem for result in self.results if result.problem is not None]

    @property
    def skipped(self) -> int:
        """How many checks say nothing."""
        return sum(result.status == SKIPPED for result in self.results)

    def __str__(self) -> str:
        counts = {s: sum(r.status == s for r in self.results) for s in (PASSED, FAILED, SKIPPED)}
        failed = [str(result) for result in self.results if result.status == FAILED]
        return "\n".join([*failed, f"{self.method}: " + ", ".join(f"{n} {s}" for s, n in counts.items())])


def check_method(method: type[Method], config: Any = None, finished: Callable[[Result], None] | None = None) -> Report:
    """Run all checks on tiny scenes with a human body, an object, an inner garment, and nothing beneath.

    Args:
        method: The class.
        config: A configuration, the smaller the better; `method.Config()` if none is given.
        finished: Called with each result as soon as it is known.
    """
    results = []
    for check in _bound_checks(method, config):
        results.append(check.result())
        if finished is not None:
            finished(results[-1])
    return Report(str(getattr(method, "name", None) or method.__name__), tuple(results))


def missing_parts(method: type) -> list[Problem]:
    """What a class lacks to be a method at all."""
    problems = []
    if not isinstance(getattr(method, "name", None), str):
        do = "give the class an attribute `name`, as in the tables"
        problems.append(Problem("name", "is missing or no text", do))
    if not is_dataclass(getattr(method, "Config", None)):
        do = "give the class an attribute `Config`, a frozen dataclass"
        problems.append(Problem("Config", "is missing or no dataclass", do))
    for part in PARTS:
        if not callable(getattr(method, part, None)):
            problems.append(Problem(part, "is missing", f"write the method `{part}` (see garmentbench.method.Method)"))
    return problems


@dataclass(frozen=True)
class Check:
    """A check bound to a method and a scene; call it with the class in a test. Its text is its name and scene."""

    name: str
    scene: str
    result: Callable[[], Result]

    def __call__(self, method: type[Method]) -> None:
        """Run it, within pytest. Raises `CheckFailedError` where it fails, skips the test where it says nothing."""
        result = self.result()
        if result.problem is not None:
            raise CheckFailedError(result.problem.what, result.problem.do)
        if result.status == SKIPPED:
            import pytest

            pytest.skip(result.reason)

    def __str__(self) -> str:
        return f"{self.name}-{self.scene}"


def parametrize_with_checks(
    methods: Iterable[type[Method] | tuple[type[Method], Any]],
) -> "pytest.MarkDecorator":
    """A pytest decorator: the test is run with every method and check, as arguments `method` and `check`.

    Args:
        methods: Classes, or pairs of a class and a small configuration (`Config()` if none is given).
    """
    import pytest

    pairs = [m if isinstance(m, tuple) else (m, None) for m in methods]
    cases = [(method, check) for method, config in pairs for check in _bound_checks(method, config)]
    return pytest.mark.parametrize(("method", "check"), cases, ids=[f"{m.__name__}-{c}" for m, c in cases])


def _bound_checks(method: type[Method], config: Any) -> list[Check]:
    """All checks of a method. Those of a scene share one trial, which is made when the first of them runs."""
    trials: dict[str, Trial] = {}
    root: list[TemporaryDirectory] = []

    def trial(scene: str) -> Trial:
        if not root:
            root.append(TemporaryDirectory(prefix="garmentbench-check-"))
        if scene not in trials:
            chosen = method.Config() if config is None else config
            trials[scene] = Trial(method, chosen, scene, Path(root[0].name).resolve())
        return trials[scene]

    def bound(check: CheckFunction, scene: str) -> Check:
        name = check.__name__.removeprefix("check_")
        return Check(name, scene, lambda: _result(check, name, scene, trial))

    parts = Check("has_all_parts", "class", lambda: _class_result(method))
    if missing_parts(method):
        return [parts]
    return [parts] + [
        bound(check, scene) for scene in SCENES for check in CHECKS if scene == HUMAN or check not in ONCE
    ]


def _result(check: CheckFunction, name: str, scene: str, trial: Callable[[str], Trial]) -> Result:
    try:
        check(trial(scene))
    except CheckFailedError as e:
        return Result(name, scene, FAILED, Problem(f"{name}, {scene} scene", e.what, e.do))
    except CheckSkippedError as e:
        return Result(name, scene, SKIPPED, reason=str(e))
    return Result(name, scene, PASSED)


def _class_result(method: type) -> Result:
    missing = missing_parts(method)
    if not missing:
        return Result("has_all_parts", "class", PASSED)
    what = ", ".join(f"`{p.where}` {p.what}" for p in missing)
    return Result("has_all_parts", "class", FAILED, Problem("class", what, "; ".join(p.do for p in missing)))
