"""Everything that is wrong with a sequence file, in one go."""

from pathlib import Path

from garmentbench import sequence_file
from garmentbench.errors import Problem, ProblemError, errors
from garmentbench.sequence_file.array_checks import through_itself
from garmentbench.sequence_file.checks import hash_problems, value_problems


def check_sequence(path: Path) -> list[Problem]:
    """All problems of a sequence file, warnings among them; an empty list for a good one."""
    try:
        contents, problems = sequence_file.read(path)
    except ProblemError as e:
        return [e.problem]
    unusable = frozenset(p.where for p in problems)
    problems += value_problems(contents, unusable) + ([] if unusable else hash_problems(contents))
    return problems if errors(problems) else problems + through_itself(contents.arrays)
