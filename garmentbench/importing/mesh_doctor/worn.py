"""Is a garment on its body? The body goes through its openings; and what would bring it there, where it doesn't."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from garmentbench.errors import Problem
from garmentbench.geometry.mesh import unique_edges
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.body import Wearer, depths
from garmentbench.importing.mesh_doctor.finding import Finding
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import borders
from garmentbench.importing.meshes.conventions import UNITS, converter, unit_name
from garmentbench.sequence import HUMAN, Sequence

SLIPPED = "worn in frame 0, but here"
_SAME_UNIT = 1e-3  # relative difference
_WIDE = 0.5  # [m] from the skin in the median: wider than any garment, the suite's widest has 0.08
NEAR = 0.1  # [m] a garment with one border (a cape) is worn where it is this near
_SIZES = 0.25, 2.5  # diagonal of a garment [m]
_STEP = 0.1  # [m] of the heights that are tried
_BESIDE = 0.3  # [m] from the body's axis, from where on it is tried to bring a garment back
_LARGE = 0.25  # of the longest opening's length: buttonholes and slits are no openings to be worn by
_LOWEST = 0.2  # of the body's height: no garment's middle is below
_TALL = 1.0  # [m] a body that stands on soles
_SOLES = 0.05  # of the body's height: a garment whose middle is below is no garment on feet
_PELVIS = 0.5  # height of the pelvis over that of the body
_FEW = 5.0  # [%] of the vertices inside: then it is worn well enough to be proposed
_CHUNK = 2_000  # body edges tested at once
_SHIFTS, _SHORTEST = 12, 4  # frames that a garment may be off, and that have to be left then
_LOOKED_AT = 3  # frames of a sequence: the first, the middle, the last


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
        up, unit = f"{self.up} up" if self.up != "z" else "", f"in {self.units}" if self.units != "m" else ""
        x, y, z = self.shift
        moved = (
            f"{z:+.2g} m"
            if z and not (x or y)
            else f"moved by ({x:.2g}, {y:.2g}, {z:.2g}) m"
            if any(self.shift)
            else ""
        )
        return ", ".join(filter(None, (unit, up, moved)))


def is_worn(mesh: Mesh, wearer: Wearer) -> bool:
    """Does the body go through most of the garment's large openings [m], lie within it, or is a cape near it?"""
    points = mesh.points[np.unique(mesh.corners)]
    low, high, body = points.min(axis=0), points.max(axis=0), wearer.body.rest
    soles, height = body[:, 2].min(), np.ptp(body[:, 2])
    at_the_feet = (low[2] + high[2]) / 2 < soles + _SOLES * height
    if wearer.body.kind == HUMAN and height > _TALL and (at_the_feet or _median_gap(mesh, wearer) > _WIDE):
        return False
    length, hubs, crossed = _openings(mesh, _skin(wearer))
    large = length > _LARGE * length.max(initial=0)
    left = large & ~crossed
    if crossed[large].sum() <= large.sum() / 2 and left.any():
        crossed[left] = depths(hubs[left], wearer) > 0
    if crossed[large].sum() > large.sum() / 2:
        return True
    middle = (body.min(axis=0) + body.max(axis=0)) / 2
    if ((low < middle) & (middle < high)).all() and ((low < body.min(axis=0)) & (high > body.max(axis=0))).any():
        return True
    return len(length) < 2 and bool(nearest_vertices(points, body)[0].min() < NEAR)


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


def never_worn(sequence: Sequence) -> list[Problem]:
    """A problem where the body of a sequence, if it is a human, isn't in the garment: an error in frame 0, a warning
    where it slips out later.
    """
    template = sequence.template
    if template.body is None or sequence.body is None or template.body.kind != HUMAN:
        return []
    for frame in np.unique(np.linspace(0, len(sequence) - 1, _LOOKED_AT).round().astype(int)):
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
            return [Problem(f"frame {frame}", f"{SLIPPED} {off}", do, warning=True)]
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
        return f"worn at {factor:.3g} times its size: {_RATIOS[factor]}? Then {do}"
    if change is None:
        do = "export both alike" if imported else "bring it to where it is worn"
        return f"another origin, axes, unit or time than the body's? Then {do}"
    if not imported:
        return f"{change.words()} would bring it on: garmentbench check FILE --fix OUT {change.options()}"
    do = f"import it with --up {change.up} (--body-up for the body)" if change.up != "z" else ""
    if any(change.shift):
        do += f"{', and ' if do else ''}move it in the program that it comes from: import moves nothing"
    return f"{change.words()} would bring it on: {do}"


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
            inside = max(inside, _inside(mesh, wearer)) if is_worn(mesh, wearer) else np.inf
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
    for factor in _RATIOS:
        known = unit is None or any(abs(factor * unit / u - 1) < _SAME_UNIT for u in UNITS.values())
        if known and _SIZES[0] <= factor * mesh.size <= _SIZES[1]:
            scaled = mesh.scaled(factor)
            if is_worn(scaled, wearer) and _inside(scaled, wearer) <= _FEW:
                fits[factor] = _median_gap(scaled, wearer)
    return min(fits, key=fits.__getitem__)


def _median_gap(mesh: Mesh, wearer: Wearer) -> float:
    """How far a garment is from the body's vertices, in the median of a thousand points or fewer [m]."""
    points = mesh.points[np.unique(mesh.corners)]
    return float(np.median(nearest_vertices(points[:: max(1, len(points) // 1000)], wearer.body.rest)[0]))


_RATIOS = {a / b: f"{u} taken for {v}" for (u, a), (v, b) in product(UNITS.items(), UNITS.items()) if u != v}


def garment_in(sequence: Sequence, frame: int) -> Mesh:
    """The garment as it is in a frame."""
    garment, positions = sequence.template.garment, sequence.garment[frame].astype(np.float64)
    count, faces, seams = np.arange(len(positions)), garment.faces.astype(np.int64), garment.seams.astype(np.int64)
    return Mesh(garment.name, positions, faces, None, count, seams=seams)


def of_frame(sequence: Sequence, frame: int, body_frame: int | None = None) -> tuple[Mesh, Wearer]:
    """Garment and body, which there has to be, as they are in a frame; the body perhaps in another one."""
    body = sequence.template.body
    assert body is not None and sequence.body is not None, "ask for the body first"
    rest = sequence.body[frame if body_frame is None else body_frame]
    return garment_in(sequence, frame), Wearer(replace(body, rest=rest), None)


_MIRRORS = {  # what a mirror image may be of, and the matrix that undoes it
    "x turned round": np.diag([-1.0, 1.0, 1.0]),
    "y turned round": np.diag([1.0, -1.0, 1.0]),
    "y and z swapped": np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]]),
    "x and y swapped": np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]]),
}


def fits_mirrored(sequence: Sequence, inside: float) -> str:
    """Of which kind of mirror image a garment is that isn't on its body, or deep inside it, as it is; "" of none.

    A kind counts where the body goes through the garment's openings once it is undone, in all frames looked at, with at
    most `inside` of its vertices in the body [%].
    """
    body = sequence.template.body
    if body is None or body.kind != HUMAN:
        return ""
    frames = [of_frame(sequence, int(k)) for k in np.unique(np.linspace(0, len(sequence) - 1, _LOOKED_AT).astype(int))]
    for said, matrix in _MIRRORS.items():
        undone = [(replace(mesh, vertices=mesh.vertices @ matrix.T), wearer) for mesh, wearer in frames]
        if all(is_worn(mesh, wearer) and _inside(mesh, wearer) <= inside for mesh, wearer in undone):
            return said
    return ""


def _inside(mesh: Mesh, wearer: Wearer) -> float:
    """How many of a garment's points are inside the body, of a thousand or fewer [%]."""
    points = mesh.points[np.unique(mesh.corners)]
    return 100 * float((depths(points[:: max(1, len(points) // 1000)], wearer) > 0).mean())


def proposal(mesh: Mesh, wearer: Wearer, units: tuple[str, ...] = ("m",)) -> Change | None:
    """The change after which the body goes through most openings, with few vertices inside; None where none does."""
    skin, most, found = _skin(wearer), 0, None
    for change in _changes(mesh, wearer, units):
        moved = change.of(mesh)
        crossed = _openings(moved, skin)[2]
        if crossed.sum() <= most:
            continue
        if _inside(moved, wearer) <= _FEW and is_worn(moved, wearer):
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


def _openings(mesh: Mesh, skin: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Length of each opening [m], its middle, and whether an edge of the body, shape (N, 2, 3), crosses it; shapes
    (openings,), (openings, 3), (openings,)."""
    edges, loop = borders(mesh.sides, len(mesh.vertex))
    length, hubs, crossed = [], [], []
    for k in range(int(loop.max(initial=-1)) + 1):
        ring = mesh.points[edges[loop == k]]
        hub, low, high = ring.mean(axis=(0, 1)), ring.min(axis=(0, 1)), ring.max(axis=(0, 1))
        near = skin[((skin.max(axis=1) >= low) & (skin.min(axis=1) <= high)).all(axis=1)]
        chunks = (near[s : s + _CHUNK] for s in range(0, len(near), _CHUNK))
        crossed.append(any(_crosses(chunk, ring[:, 0], ring[:, 1], hub) for chunk in chunks))
        hubs.append(hub)
        length.append(float(np.linalg.norm(ring[:, 1] - ring[:, 0], axis=1).sum()))
    return np.array(length), np.array(hubs).reshape(-1, 3), np.array(crossed, bool)


def _skin(wearer: Wearer) -> np.ndarray:
    """The edges of the body by the positions of their ends [m], shape (N, 2, 3)."""
    return wearer.body.rest.astype(np.float64)[unique_edges(wearer.body.faces)]


def _crosses(segments: np.ndarray, a: np.ndarray, b: np.ndarray, hub: np.ndarray) -> bool:
    """Does any segment, shape (N, 2, 3), go through a triangle (a, b, hub), shapes (M, 3), (M, 3), (3,)?"""
    u, v = a - hub, b - hub
    normal = np.cross(u, v)
    start, along = segments[:, None, 0] - hub, segments[:, None, 1] - segments[:, None, 0]
    height, fall = np.sum(start * normal, axis=-1), np.sum(along * normal, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = -height / fall
        at = start + share[..., None] * along
        area = np.sum(normal**2, axis=-1)
        s = np.sum(np.cross(at, v) * normal, axis=-1) / area
        t = np.sum(np.cross(u, at) * normal, axis=-1) / area
    return bool(((share >= 0) & (share <= 1) & (s >= 0) & (t >= 0) & (s + t <= 1)).any())


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


def unit_question(size: float) -> str:
    """The units that a garment of this diagonal may be in, e.g. "cm (0.43 m) or in (1.1 m)"; "" for none."""
    fits = [
        f"{name} ({size * unit:.2g} m)" for name, unit in UNITS.items() if _SIZES[0] <= size * unit <= 2 * _SIZES[1]
    ]
    return " or ".join(fits)
