"""Findings on garments that nobody wears, with the likely cause."""

from dataclasses import dataclass, replace

import numpy as np

from garmentbench.errors import Problem
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.body import Wearer
from garmentbench.importing.mesh_doctor.bringing_on import (
    LOOKED_AT,
    RATIOS,
    other_time,
    other_unit,
    proposal,
    unit_question,
)
from garmentbench.importing.mesh_doctor.finding import Finding
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.worn import is_worn, of_frame
from garmentbench.importing.meshes.conventions import UNITS, unit_name
from garmentbench.sequence import HUMAN, Sequence


@dataclass(frozen=True)
class Slipped(Problem):
    """A garment that is worn in frame 0 and not in a later one, which `where` names."""


def not_worn(mesh: Mesh, wearer: Wearer, units: str = "m") -> list[Finding]:
    """A finding where the body isn't in the garment [m]; it names what would bring it there. `units` are the file's."""
    if is_worn(mesh, wearer):
        return []
    low, high = mesh.points[mesh.corners].min(axis=(0, 1)), mesh.points[mesh.corners].max(axis=(0, 1))
    middle = ", ".join(f"{x:.2f}" for x in (low + high) / 2)
    what = f"not worn by '{wearer.body.name}': it doesn't go through most of the openings, or it stands far off; "
    what += f"the middle is at ({middle}) m"
    factor = other_unit(mesh, wearer, UNITS[units])
    change = proposal(mesh, wearer) if factor == 1 else None
    if factor != 1:
        right = unit_name(UNITS[units] * factor)
        do = f"in {right} it would be worn: --fix OUT --units {right}; until then nothing is pushed"
    elif change is None:
        do = "bring it to where it is worn; --fix pushes nothing"
    else:
        change = replace(change, units=units)
        do = f"{change.words()} would bring it on: --fix OUT {change.options()}; until then nothing is pushed"
    return [Finding(Problem("body", what, do))]


def unit_worn(mesh: Mesh, wearer: Wearer) -> list[Finding]:
    """A finding on a garment whose unit its size doesn't tell, where the body does; the unit is still to be
    confirmed.
    """
    change = proposal(mesh, wearer, tuple(UNITS))
    if change is None:
        return []
    worn = f"on '{wearer.body.name}' it is worn {change.words()}"
    what = f"measures {mesh.size:.3g} across: {unit_question(mesh.size)}; {worn}"
    return [Finding(Problem("scale", what, f"give --fix OUT {change.options()} if that is right"))]


def never_worn(sequence: Sequence) -> list[Problem]:
    """A problem where the body of a sequence, if it is a human, isn't in the garment: an error in frame 0, a warning
    where it slips out later.
    """
    template = sequence.template
    if template.body is None or sequence.body is None or template.body.kind != HUMAN:
        return []
    for frame in np.unique(np.linspace(0, len(sequence) - 1, LOOKED_AT).round().astype(int)):
        mesh, wearer = of_frame(sequence, int(frame))
        if is_worn(mesh, wearer):
            continue
        gap = nearest_vertices(mesh.points, wearer.body.rest)[0].min()
        off = f"'{template.body.name}' doesn't go through most of the garment's openings, or it stands far off the skin"
        off += f" (the nearest point is {gap:.2g} m away)"
        if frame:
            shift = other_time(sequence)
            likely = f"{later(shift)}? Export" if shift else "do both have the same times and rate? If not, export"
            do = f"look at it (garmentbench view); {likely} both over the same frames"
            return [Slipped(f"frame {frame}", f"worn in frame 0, but here {off}", do, warning=True)]
        return [Problem("frame 0", off, f"{likely_cause(sequence)}; look at it (--picture)")]
    return []


def later(shift: int) -> str:
    """Where in time a garment fits its body, by `other_time`."""
    return f"it fits the body {shift:+d} frame{'' if abs(shift) == 1 else 's'} away"


def likely_cause(sequence: Sequence) -> str:
    """The likely cause of a garment's not being on its body in frame 0, and what mends it."""
    mesh, wearer = of_frame(sequence, 0)
    factor = other_unit(mesh, wearer)
    shift = 0 if factor != 1 else other_time(sequence)
    if shift:
        return f"{later(shift)}? Export both over the same frames"
    change = None if factor != 1 else proposal(mesh, wearer)
    if change is not None and change.up != "z" and any(change.shift[:2]):  # two faults at once are far-fetched
        change = None
    imported = "imported" in sequence.info
    if factor != 1:
        do = "import it with the right --units or --body-units" if imported else "scale it (garmentbench check --fix)"
        return f"worn at {factor:.3g} times its size: {RATIOS[factor]}? Then {do}"
    if change is None:
        do = "export both alike" if imported else "bring it to where it is worn"
        return f"another origin, axes, unit or time than the body's? Then {do}"
    if not imported:
        return f"{change.words()} would bring it on: garmentbench check FILE --fix OUT {change.options()}"
    do = f"import it with --up {change.up} (--body-up for the body)" if change.up != "z" else ""
    if any(change.shift):
        do += f"{', and ' if do else ''}move it in the program that it comes from: import moves nothing"
    return f"{change.words()} would bring it on: {do}"
