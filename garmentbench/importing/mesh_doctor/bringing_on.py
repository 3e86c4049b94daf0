"""What would bring a garment on its body: another unit, axis, place or time, or the undoing of a mirror image."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from garmentbench.importing.mesh_doctor.body import Wearer
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.worn import inside_percent, is_worn, median_gap, of_frame, openings, skin_edges
from garmentbench.importing.meshes.conventions import UNITS, converter
from garmentbench.sequence import HUMAN, Sequence

_SAME_UNIT = 1e-3  # relative difference
_SIZES = 0.25, 2.5  # diagonal of a garment [m]
_SAID = {"in": "inches", "ft": "feet"}
_STEP = 0.1  # [m] of the heights that are tried
_BESIDE = 0.3  # [m] from the body's axis, from where on it is tried to bring a garment back
_LOWEST = 0.2  # of the body's height: no garment's middle is below
_PELVIS = 0.5  # height of the pelvis over that of the body
_FEW = 5.0  # [%] of the vertices inside: then it is worn well enough to be proposed
_SHIFTS, _SHORTEST = 12, 4  # frames that a garment may be off, and that have to be left then
LOOKED_AT = 3  # frames of a sequence: the first, the middle, the last
RATIOS = {a / b: f"{u} taken for {v}" for (u, a), (v, b) in product(UNITS.items(), UNITS.items()) if u != v}
_MIRRORS = {  # what a mirror image may be of, and the matrix that undoes it
    "x turned round": np.diag([-1.0, 1.0, 1.0]),
    "y turned round": np.diag([1.0, -1.0, 1.0]),
    "y and z swapped": np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]]),
    "x and y swapped": np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]]),
}


@dataclass(frozen=True)
class Change:
    """What brings a garment on its body: unit, then axes, then a shift.

    Attributes:
        units: A key of `UNITS`.
        up: "x", "y" or "z": which axis is up.
        shift: [m], after the turn.
    """

    units: str = "m"
    up: str = "z"
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def of(self, mesh: Mesh) -> Mesh:
        """The mesh so changed."""
        return replace(mesh, vertices=mesh.vertices @ converter(UNITS[self.units], self.up).T + np.array(self.shift))

    def options(self) -> str:
        """The options that ask for it."""
        shift = f"--shift={','.join(f'{x:g}' for x in self.shift)}" if any(self.shift) else ""
        words = (
            f"--units {self.units}" if self.units != "m" else "",
            f"--up {self.up}" if self.up != "z" else "",
            shift,
        )
        return " ".join(filter(None, words))

    def words(self) -> str:
        """The same for a reader, e.g. "y up, +0.9 m"."""
        up, unit = (
            f"{self.up} up" if self.up != "z" else "",
            f"in {_SAID.get(self.units, self.units)}" if self.units != "m" else "",
        )
        x, y, z = self.shift
        moved = (
            f"{z:+.2g} m"
            if z and not (x or y)
            else f"moved by ({x:.2g}, {y:.2g}, {z:.2g}) m"
            if any(self.shift)
            else ""
        )
        return ", ".join(filter(None, (unit, up, moved)))


def proposal(mesh: Mesh, wearer: Wearer, units: tuple[str, ...] = ("m",)) -> Change | None:
    """The change after which the body goes through most openings, with few vertices inside; None where none does."""
    skin, most, found = skin_edges(wearer), 0, None
    for change in _changes(mesh, wearer, units):
        moved = change.of(mesh)
        crossed = openings(moved, skin)[2]
        if crossed.sum() <= most:
            continue
        if inside_percent(moved, wearer) <= _FEW and is_worn(moved, wearer):
            most, found = crossed.sum(), change
        if most == len(crossed):
            break
    return found


def _changes(mesh: Mesh, wearer: Wearer, units: tuple[str, ...]) -> Iterator[Change]:
    """What may bring a garment on, the likely first: other units, other axes, up by a pelvis' height, other places."""
    low, high = wearer.body.rest.min(axis=0), wearer.body.rest.max(axis=0)
    height = float(high[2] - low[2])
    pelvis = round(float(low[2]) + _PELVIS * height, 1)
    heights = [
        0.0,
        pelvis,
        *sorted(np.arange(-0.6 * height, 0.7 * height, _STEP).round(2), key=lambda z: abs(z - pelvis)),
    ]
    upright = [(u, up) for u, up in product(units, "zyx") if _SIZES[0] <= mesh.size * UNITS[u] <= _SIZES[1]]
    for aside in (False, True):
        for z, (unit, up) in product(heights, upright):
            plain = Change(unit, up)
            box = plain.of(mesh).points[mesh.corners]
            middle = (box.min(axis=(0, 1)) + box.max(axis=(0, 1))) / 2
            off = np.where(np.abs(middle - (low + high) / 2) > _BESIDE, middle - (low + high) / 2, 0.0)[:2]
            if middle[2] + z < low[2] + _LOWEST * height or (aside and not off.any()):
                continue
            x, y = -off.round(2) if aside else (0.0, 0.0)
            yield replace(plain, shift=(float(x) + 0.0, float(y) + 0.0, float(z)))


def other_time(sequence: Sequence) -> int:
    """By how many frames a garment is too early for its body, or too late if below 0: it is worn there, with few
    vertices inside, in the middle of the frames that both then have and at their ends; 0 for none.
    """
    if sequence.body is None or len(sequence) < 2 * _SHORTEST:
        return 0
    best, found = _FEW, 0
    farthest = min(_SHIFTS, len(sequence) - _SHORTEST)
    for shift in sorted(set(range(-farthest, farthest + 1)) - {0}, key=abs):
        first, last = max(0, -shift), min(len(sequence), len(sequence) - shift) - 1
        inside = 0.0
        for frame in (first, (first + last) // 2, last):
            mesh, wearer = of_frame(sequence, frame, frame + shift)
            inside = max(inside, inside_percent(mesh, wearer)) if is_worn(mesh, wearer) else np.inf
            if inside >= best:
                break
        if inside < best:
            best, found = inside, shift
    return found


def other_unit(mesh: Mesh, wearer: Wearer, unit: float | None = None) -> float:
    """By what a garment is to be scaled to be worn, if its unit is what is wrong with it; 1 where it isn't.

    Args:
        mesh: The garment, in metres if its unit is the one that it is taken for.
        wearer: The body.
        unit: That unit [m]; None: not known.

    Of several units the one in which it lies closest.
    """
    fits = {1.0: np.inf}
    for factor in RATIOS:
        known = unit is None or any(abs(factor * unit / u - 1) < _SAME_UNIT for u in UNITS.values())
        if known and _SIZES[0] <= factor * mesh.size <= _SIZES[1]:
            scaled = mesh.scaled(factor)
            if is_worn(scaled, wearer) and inside_percent(scaled, wearer) <= _FEW:
                fits[factor] = median_gap(scaled, wearer)
    return min(fits, key=fits.__getitem__)


def fits_mirrored(sequence: Sequence, inside: float) -> str:
    """Of which kind of mirror image a garment is that isn't on its body, or deep inside it, as it is; "" of none.

    A kind counts where the body goes through the garment's openings once it is undone, in all frames looked at, with at
    most `inside` of its vertices in the body [%].
    """
    body = sequence.template.body
    if body is None or body.kind != HUMAN:
        return ""
    frames = [of_frame(sequence, int(k)) for k in np.unique(np.linspace(0, len(sequence) - 1, LOOKED_AT).astype(int))]
    for said, matrix in _MIRRORS.items():
        undone = [(replace(mesh, vertices=mesh.vertices @ matrix.T), wearer) for mesh, wearer in frames]
        if all(is_worn(mesh, wearer) and inside_percent(mesh, wearer) <= inside for mesh, wearer in undone):
            return said
    return ""


def unit_question(size: float) -> str:
    """The units that a garment of this diagonal may be in, e.g. "cm (0.43 m) or in (1.1 m)"; "" for none."""
    fits = [
        f"{name} ({size * unit:.2g} m)" for name, unit in UNITS.items() if _SIZES[0] <= size * unit <= 2 * _SIZES[1]
    ]
    return " or ".join(fits)
