"""Numbers, triangles and edges of a garment's rest shape.

NaN, faces without area, slivers, short edges, unit, up axis.
"""

import numpy as np

from garmentbench.errors import Problem
from garmentbench.importing.mesh_doctor.finding import Finding, listed
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import repeats_a_corner
from garmentbench.importing.meshes.conventions import UNITS
from garmentbench.importing.text import counted
from garmentbench.sequence_file.array_checks import LARGEST, SMALLEST

FLAT = 1e-6  # height over longest edge: no area
SLIVER = 0.05  # height over longest edge
POINT = 1e-6  # edge length over the mesh's diagonal: no length
SHORT = 0.1  # edge length over the median edge


def not_finite(mesh: Mesh) -> list[Finding]:
    """NaN or infinite positions."""
    bad = np.flatnonzero(~np.isfinite(mesh.vertices).all(axis=1))
    if not len(bad):
        return []
    count = counted(len(bad), "vertex", "vertices")
    what = f"{count} with NaN or infinite positions, at vertex {listed(mesh.numbers[bad])}"
    return [Finding(Problem("vertices", what, "export the mesh again; nothing else can be checked until then"))]


def heights(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Least height over longest edge of each face (0.87 where equilateral), and its longest edge, shape (F,) each."""
    corners = mesh.points[mesh.corners]
    a, b, c = corners.transpose(1, 0, 2)
    longest = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    twice_area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return twice_area / np.where(longest > 0, longest, 1.0) ** 2, longest


def without_area(mesh: Mesh) -> np.ndarray:
    """Which faces have no area, shape (F,), bool."""
    ratio, longest = heights(mesh)
    return (ratio <= FLAT) | (longest <= POINT * mesh.size) | repeats_a_corner(mesh.corners)


def degenerate(mesh: Mesh) -> list[Finding]:
    """Faces without area, edges without length, slivers."""
    ratio, flat = heights(mesh)[0], without_area(mesh)
    thin = np.flatnonzero(~flat & (ratio < SLIVER))
    points = points_as_edges(mesh)
    found = []
    if flat.any():
        faces = np.flatnonzero(flat)
        what = f"{counted(len(faces), 'face')} without area, at face {listed(faces)}"
        found.append(Finding(Problem("faces", what, "delete them (--fix does where that opens no slit)"), faces=faces))
    if len(points):
        what = f"{counted(len(points), 'edge')} without length, at {listed(mesh.numbers[points])}"
        found.append(Finding(Problem("edges", what, "merge their ends (--fix does)"), edges=points))
    if len(thin):
        thin = thin[np.argsort(ratio[thin], kind="stable")]
        what = (
            f"{counted(len(thin), 'sliver')} (height below {SLIVER:g} of the longest edge, {ratio[thin[0]]:.2g} the "
            f"least), at face {listed(thin)}"
        )
        do = "remesh there: the simulator softens slivers; --fix leaves them"
        found.append(Finding(Problem("faces", what, do, warning=True), faces=thin))
    return found


def points_as_edges(mesh: Mesh) -> np.ndarray:
    """Edges whose ends coincide, vertex pairs, shape (N, 2)."""
    a, b = mesh.sides.edges.T
    length = np.linalg.norm(mesh.points[a] - mesh.points[b], axis=1)
    return mesh.vertex[mesh.sides.edges[length <= POINT * mesh.size]]


def unit(size: float) -> tuple[str, float] | None:
    """Unit and its metres of a garment of some diagonal; None where more than one unit would do.

    >>> unit(1.1), unit(130.0), unit(1100.0), unit(300.0), unit(95.0)
    (('m', 1.0), ('cm', 0.01), ('mm', 0.001), None, None)
    """
    if SMALLEST <= size <= LARGEST:
        return "m", 1.0
    if 110 < size <= 250:  # below, inches are as likely
        return "cm", 0.01
    return ("mm", 0.001) if 400 <= size <= 3000 else None


def scale(mesh: Mesh) -> list[Finding]:
    """A size that no garment has in metres."""
    guess = unit(mesh.size)
    if guess is not None and guess[0] == "m":
        return []
    what = f"measures {mesh.size:.3g} across, wanted {SMALLEST:g} to {LARGEST:g} m"
    if guess is None:
        likely = " or ".join(
            f"{name} ({mesh.size * size:.2g} m)" for name, size in UNITS.items() if 0.25 <= mesh.size * size <= 5
        )
        do = "say which with --fix and --units (m, cm, mm, in, ft)"
        found = f"{what}; the unit can't be told from that" + (f": {likely}?" if likely else "")
        return [Finding(Problem("scale", found, do))]
    name, factor = guess
    do = f"multiply all positions by {factor:g} (--fix does); everything else is said as if that were done"
    return [Finding(Problem("scale", f"{what}: in {name}", do))]


def up_axis(mesh: Mesh) -> list[Finding]:
    """A garment that seems to stand along x or y. A guess from where its middle lies and what it measures."""
    low, high = mesh.points[mesh.corners].min(axis=(0, 1)), mesh.points[mesh.corners].max(axis=(0, 1))
    extent, off = high - low, np.abs(low + high) / 2
    lifted = off > 0.5 * extent.max()  # a worn garment hangs a metre above the floor, over its origin
    if lifted.sum() == 1 and not lifted[2]:
        axis = int(np.argmax(lifted))
        why = f"its middle lies {off[axis]:.2g} m along {'xyz'[axis]} and {off[2]:.2g} m along z"
    elif not lifted.any() and 0 < extent[2] < 0.5 * extent[:2].min():
        axis, why = 1, f"it measures {extent[0]:.2g} x {extent[1]:.2g} x {extent[2]:.2g} m, and is thin along z"
    else:
        return []
    what = f"{'xyz'[axis]} looks like up, wanted z: {why}"
    do = "turn it (garmentbench import --up does), unless it is meant to lie"
    return [Finding(Problem("axes", what, do, warning=True))]
