"""All validation cases, in the order of their table."""

from garmentbench.evals.validation import beams, hanging, sheets, touching
from garmentbench.evals.validation.case import Case

CASES: dict[str, Case] = {case.name: case for case in (*beams.CASES, *hanging.CASES, *sheets.CASES, *touching.CASES)}
