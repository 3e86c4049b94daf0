"""Units, up axis and frame rate: as given, else as the file says, else worked out from the body.

Refused where unclear.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from garmentbench.errors import UsageError, UserError
from garmentbench.importing.meshes.mesh_sequence import MeshSequence

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
AXES = {  # new x, y, z as signed axes of the file's (1 is x); all are turns, no mirror images
    "z": (1, 2, 3),
    "y": (1, -3, 2),
    "x": (2, 3, 1),
    "-z": (1, -2, -3),
    "-y": (1, 3, -2),
    "-x": (3, 2, -1),
}
HEIGHTS = 1.0, 2.4  # of a standing human body [m]
SPANS = 0.4, 2.8  # diagonal of a garment's bounding box [m]
SLOWEST = 4.0  # frames a second: what is recorded at fewer is no motion of cloth
_STANDS = 0.05  # a body's lowest point is this near to 0, relative to its height


@dataclass(frozen=True)
class Given:
    """What the user says.

    Attributes:
        units: A key of `UNITS`, or None.
        up: A key of `AXES`, or None.
        fps: Frames a second, or None.
        body_units, body_up: Of the body, where they are not the garment's.
    """

    units: str | None = None
    up: str | None = None
    fps: float | None = None
    body_units: str | None = None
    body_up: str | None = None

    def __post_init__(self) -> None:
        for option, units in (("--units", self.units), ("--body-units", self.body_units)):
            if units not in (None, *UNITS):
                raise UsageError(f"{option} is '{units}'; wanted {', '.join(UNITS)}")
        for option, up in (("--up", self.up), ("--body-up", self.body_up)):
            if up not in (None, *AXES):
                raise UsageError(f"{option} is '{up}'; wanted {', '.join(AXES)}")
        if self.fps is not None and not 1 <= self.fps <= 1000:
            raise UsageError(f"--fps is {self.fps:g}; wanted 1 to 1000 frames a second")


@dataclass(frozen=True)
class Conventions:
    """What positions mean.

    Attributes:
        unit: Metres in the garment's unit, and in the body's (files may differ only where they say so themselves).
        up: A key of `AXES`, for the garment and for the body.
        fps: Frames a second.
        assumed: One line each on units, up and fps.
    """

    unit: tuple[float, float]
    up: tuple[str, str]
    fps: float
    assumed: tuple[str, str, str]


def find_conventions(garment: MeshSequence, body: MeshSequence | None, given: Given, human: bool = True) -> Conventions:
    """Find them for both meshes. Raises `UserError`, with advice, where something stays unclear."""
    other = garment if body is None else body
    person = body if human else None
    ups = given.up, given.body_up or given.up
    up, about_up = _decide("up", ups, garment.up, other.up, lambda: guess_up(person))
    units, about_units = _decide(
        "units",
        (_metres(given.units), _metres(given.body_units or given.units)),
        garment.unit,
        other.unit,
        lambda: guess_unit(garment, person if given.body_units is None else None, up[1]),
    )
    still = len(other.frames) == 1  # a body that stands has no rate
    rates = garment.fps, garment.fps if still and garment.fps is not None else other.fps
    fps, about_fps = _decide("fps", (given.fps, given.fps), *rates, _no_rate)
    if given.fps is None and not min(fps) >= SLOWEST:
        found = f"fps: the files say {min(fps):g} frames a second: are their times milliseconds, or numbers of frames?"
        raise UserError(f"{found} Give --fps, e.g. --fps 30")
    if fps[0] != fps[1] and min(len(garment.frames), len(other.frames)) > 1:
        raise UserError(
            f"the garment has {fps[0]:g} frames a second, the body {fps[1]:g}; "
            "export both at the same rate, or give --fps if one of the files is wrong"
        )
    return Conventions(units, up, fps[0], (about_units, about_up, about_fps))


def converter(unit: float, up: str) -> np.ndarray:
    """Matrix M, shape (3, 3), float64: metres, z up = M x."""
    matrix = np.zeros((3, 3))
    for row, axis in enumerate(AXES[up]):
        matrix[row, abs(axis) - 1] = np.sign(axis) * unit
    return matrix


def unit_name(unit: float) -> str:
    """ "cm" for 0.01; a unit without a name in metres."""
    return next((name for name, size in UNITS.items() if abs(size / unit - 1) < 1e-6), f"{unit:g} m")


def _metres(units: str | None) -> float | None:
    return None if units is None else UNITS[units]


def _decide(
    name: str, given: tuple[Any, Any], garment: Any, body: Any, guess: Callable[[], tuple[Any, str]]
) -> tuple[Any, str]:
    """The value for garment and body, and a line about it; `given` are both as the user says."""
    show: Any = unit_name if name == "units" else lambda v: f"{v:g}" if isinstance(v, float) else v
    if given[0] is not None:
        more = "" if given[1] == given[0] else f", of the body {show(given[1])}"
        return given, f"{name}: {show(given[0])}{more} (given)"
    if given[1] is not None:
        value, why = (garment, "as the file says") if garment is not None else guess()
        why = why if garment is not None else f"inferred: {why}"
        return (value, given[1]), f"{name}: {show(value)} ({why}), of the body {show(given[1])} (given)"
    known: tuple[Any, Any] = garment if garment is not None else body, body if body is not None else garment
    if known[0] is not None:
        both = show(known[0]) if known[0] == known[1] else f"{show(known[0])}, of the body {show(known[1])}"
        if garment is None or body is None:
            one, other = ("body", "garment") if garment is None else ("garment", "body")
            return known, f"{name}: {both} (as the {one}'s file says; the {other}'s says nothing)"
        return known, f"{name}: {both} (as the file says)"
    value, why = guess()
    return (value, value), f"{name}: {show(value)} (inferred: {why})"


def guess_up(body: MeshSequence | None) -> tuple[str, str]:
    """The axis along which a body is long in its first frame, of two, as in a T-pose, the one along which it stands at
    0; and why. Raises `UserError` where none is, or there is no body.
    """
    do = "give --up y (Maya, most films) or --up z (Blender, 3ds Max)"
    if body is None:
        raise UserError(f"up axis: can't be told without a human body; {do}")
    first = np.asarray(body.frames[0], np.float64)
    low, size = first.min(axis=0), np.ptp(first, axis=0)
    long = np.flatnonzero(size >= 0.85 * size.max())
    standing = [axis for axis in long if abs(low[axis]) <= _STANDS * size[axis]]
    names, extents = "xyz", " x ".join(f"{s:.3g}" for s in size)
    if len(long) == 1:
        return names[long[0]], f"the body measures {extents}"
    if len(standing) == 1:
        return names[standing[0]], f"the body measures {extents} and stands at 0 along {names[standing[0]]}"
    raise UserError(f"up axis: can't be told from a body of {extents}; {do}")


def guess_unit(garment: MeshSequence, body: MeshSequence | None, up: str) -> tuple[float, str]:
    """The unit [m] in which a body stands as high as people do, or without one in which a garment has a garment's size;
    and why. Raises `UserError` where none or several fit.
    """
    if body is not None:
        axis = abs(AXES[up][2]) - 1
        size = float(np.ptp(np.asarray(body.still, np.float64)[:, axis]))
        moving = float(np.ptp(np.asarray(body.frames[0], np.float64)[:, axis]))
        what, (low, high), known = "body height", HEIGHTS, UNITS
        size = size if size > 0.5 * moving else moving  # a template that lies on its back
    else:
        size = float(np.linalg.norm(np.ptp(np.asarray(garment.still, np.float64), axis=0)))
        what, (low, high), known = "the garment's diagonal", SPANS, {k: UNITS[k] for k in ("m", "cm", "mm")}
    fits = [unit for unit in known.values() if low <= size * unit <= high]
    if len(fits) != 1:
        raise UserError(f"units: can't be told from {what} {size:.4g}; give --units ({', '.join(UNITS)})")
    return fits[0], f"{what} {size:.4g}"


def _no_rate() -> tuple[float, str]:
    raise UserError("fps: the files don't say how many frames a second they have; give --fps, e.g. --fps 30")
