"""Is an imported garment worn, and how much of it is inside the body? Said, and noted where it says something."""

from dataclasses import replace

import numpy as np

from garmentbench.importing.mesh_doctor.bringing_on import fits_mirrored, other_time
from garmentbench.importing.mesh_doctor.unworn import later, likely_cause, never_worn
from garmentbench.importing.meshes.mesh_sequence import refusal
from garmentbench.metrics.interpenetration_strict import PENETRATION
from garmentbench.metrics.metric import Motion, scores
from garmentbench.sequence import Sequence

_MUCH, _MOSTLY = 5.0, 50.0  # [%] of the garment inside the body: a warning, and an error
_FEW, _FAR_FEWER = 5.0, 4.0  # [%], and times fewer: so little is inside a body if mirroring is what was wrong
_MEASURED = 400_000  # vertices, over all frames, whose depth is measured: a few seconds


def worn(sequence: Sequence) -> tuple[Sequence, list[str]]:
    """The sequence with its interpenetration noted, and lines on whether it is worn.

    Of a garment that nobody wears, or that slips off, nothing is noted: none of it inside a body would say nothing.

    Raises `UserError` where most of it is inside the body, or where it fits as its mirror image only.
    """
    known, problems = measured(sequence), never_worn(sequence)
    percent = known.scores["interpenetration_strict"]
    body = sequence.template.body
    where = sequence.template.garment.name if body is None else f"{sequence.template.garment.name} on {body.name}"
    line = f"{percent:.3g} % of the garment's vertices lie inside the body"
    if problems or percent > _MUCH:
        mirrored = fits_mirrored(sequence, _FEW if problems else percent / _FAR_FEWER)
        if mirrored:
            found = f"{line}, but hardly one of its mirror image ({mirrored})"
            raise refusal(where, found, "export garment and body with the same axes, both right-handed")
    if percent > _MOSTLY:
        raise refusal(where, f"{line}, wanted it worn", f"{likely_cause(sequence)}, or name the right body")
    lines = [f"warning: {problem}" for problem in problems]
    if problems:
        return _with_lines(sequence, lines), lines
    if percent > _MUCH:
        shift = other_time(sequence)
        likely = "do both have the same times, axes and unit, and is this its body?"
        likely = f"{later(shift)}: do both begin at the same moment?" if shift else likely
        lines.append(f"warning: interpenetration: {line}: {likely}")
    else:
        lines.append(f"interpenetration: {line}")
    return _with_lines(known, lines), lines


def _with_lines(sequence: Sequence, lines: list[str]) -> Sequence:
    """With more of what was said when it was imported, for its data card."""
    imported = sequence.info.get("imported", {})
    return replace(
        sequence, info=sequence.info | {"imported": {**imported, "said": [*imported.get("said", []), *lines]}}
    )


def measured(sequence: Sequence) -> Sequence:
    """With its own interpenetration noted, measured on so many of its frames, evenly spaced, as `_MEASURED` allows."""
    frames = min(len(sequence), max(1, _MEASURED // sequence.garment.shape[1]))
    chosen = np.linspace(0, len(sequence) - 1, frames).round().astype(int)
    some = replace(sequence, garment=sequence.garment[chosen], body=sequence.body_positions[chosen])
    noted = {"scores": scores(Motion.of(some), *PENETRATION), "scored_frames": len(chosen)}
    return replace(sequence, info=sequence.info | noted)
