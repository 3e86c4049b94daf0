"""Is a garment on its body? The body goes through most of its openings, and none of it is far off."""

from dataclasses import replace

import numpy as np

from garmentbench.geometry.mesh import unique_edges
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.body import Wearer, depths
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import borders
from garmentbench.sequence import HUMAN, Sequence

_WIDE = 0.5  # [m] from the skin in the median: wider than any garment, the suite's widest has 0.08
NEAR = 0.1  # [m] a garment with one border (a cape) is worn where it is this near
_LARGE = 0.25  # of the longest opening's length: buttonholes and slits are no openings to be worn by
_TALL = 1.0  # [m] a body that stands on soles
_SOLES = 0.05  # of the body's height: a garment whose middle is below is no garment on feet
_CHUNK = 2_000  # body edges tested at once


def is_worn(mesh: Mesh, wearer: Wearer) -> bool:
    """Does the body go through most of the garment's large openings [m], lie within it, or is a cape near it?"""
    points = mesh.points[np.unique(mesh.corners)]
    low, high, body = points.min(axis=0), points.max(axis=0), wearer.body.rest
    soles, height = body[:, 2].min(), np.ptp(body[:, 2])
    at_the_feet = (low[2] + high[2]) / 2 < soles + _SOLES * height
    if wearer.body.kind == HUMAN and height > _TALL and (at_the_feet or median_gap(mesh, wearer) > _WIDE):
        return False
    length, hubs, crossed = openings(mesh, skin_edges(wearer))
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


def inside_percent(mesh: Mesh, wearer: Wearer) -> float:
    """How many of a garment's points are inside the body, of a thousand or fewer [%]."""
    points = mesh.points[np.unique(mesh.corners)]
    return 100 * float((depths(points[:: max(1, len(points) // 1000)], wearer) > 0).mean())


def median_gap(mesh: Mesh, wearer: Wearer) -> float:
    """How far a garment is from the body's vertices, in the median of a thousand points or fewer [m]."""
    points = mesh.points[np.unique(mesh.corners)]
    return float(np.median(nearest_vertices(points[:: max(1, len(points) // 1000)], wearer.body.rest)[0]))


def openings(mesh: Mesh, skin: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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


def skin_edges(wearer: Wearer) -> np.ndarray:
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
