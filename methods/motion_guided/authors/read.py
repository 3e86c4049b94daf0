"""The data that the authors of the motion-guided model released, as one of our sequences."""

import warnings
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.methods.motion_guided.authors.axes import Placement, placement
from garmentbench.methods.motion_guided.authors.files import (
    AGAIN,
    SurfaceSamples,
    read_arrays,
    read_groups,
    read_mesh,
    read_points,
    read_samples,
)
from garmentbench.methods.motion_guided.authors.release import Release
from garmentbench.progress import track
from garmentbench.sequence import Body, Garment, Sequence, Template

FPS = 30.0  # no file says it; the authors' scripts note a step of 1 / 30 s
UNEVEN = 1e-3  # [m] How far a stored velocity may be from the difference of two positions


def read_release(
    release: Release,
    scene: str,
    case: str = "",
    split: str = "train",
    fps: float = FPS,
    unit: str = "auto",
    axes: str = "auto",
    frames: int | None = None,
) -> tuple[Sequence, list[str]]:
    """A sequence, and notes for the user, line by line.

    Args:
        release: The folder and the garment.
        scene: What it is called in tables.
        case: Folder of the motion below it, e.g. "unseen_test/rumba_swing"; "" for the release's own.
        split: "train" or "test".
        fps: Frames a second, which no file says.
        unit, axes: As for `placement`.
        frames: How many frames to read, from the first on.

    Raises:
        UserError: A file is missing or damaged, or files do not fit each other.
    """
    rest, faces = read_mesh(release.body("body_geo.obj"))
    place = placement(rest, unit, axes)
    seeds = read_samples(release.body("body_*_sample.txt"), len(rest))
    body = Body("authors", place(rest), faces, *vertex_labels(rest, seeds))
    garment = read_garment(release, place)
    files, dropped = _common(release.garment_frames(case), release.body_frames(case), frames)
    clothes, bodies = _read_frames(files, place, len(garment.rest), len(rest))
    told = [
        f"unit: {place.unit}" + (" (told by the body's height)" if unit == "auto" else ""),
        f"axes: ours are the files' {place.axes}" + (" (told by the body's shape)" if axes == "auto" else ""),
        f"frame rate: {fps:g} a second (no file says it)",
        f"frames: {min(files)} to {max(files)}, {len(files)} of them" + dropped,
        f"garment: {garment.name}, {len(garment.rest)} vertices, {len(garment.seams)} seam pairs",
        f"body: {len(rest)} vertices; their parts are those of the nearest of {len(seeds.labels)} seeds",
    ]
    origin = f"the authors' release, {release.folder.resolve().name}/{case}".rstrip("/")
    imported = {"from": origin, "units": place.unit, "said": told}
    info = {
        "scene": scene,
        "split": split,
        "motion": Path(case).name or release.folder.resolve().name,
        "imported": imported,
    }
    return Sequence(Template(garment, body, fps), clothes, bodies, info), told


def read_garment(release: Release, place: Placement) -> Garment:
    """The garment's template. Raises `UserError` as `read_release`."""
    rest, faces = read_mesh(release.cloth("garment_geo.obj"))
    uv = read_points(release.cloth("garment_uv.obj"))
    if len(uv) != len(rest):
        raise UserError(
            f"{release.cloth('garment_uv.obj')}: {len(uv)} points for {len(rest)} vertices; wanted one each"
        )
    groups = read_groups(release.cloth("ind_B2O_*.txt"), len(rest))
    seams = [pair for group in groups for pair in combinations(sorted(group.tolist()), 2)]
    pairs = np.array(seams, np.int32).reshape(-1, 2)
    return Garment(release.garment, place(rest), faces, uv[:, :2].astype(np.float32), pairs)


def vertex_labels(rest: np.ndarray, seeds: SurfaceSamples) -> tuple[np.ndarray, tuple[str, ...]]:
    """The part of each body vertex, shape (B,), int8, that of the nearest seed, since only seeds have labels.

    And names.
    """
    points = np.einsum("nk,nkx->nx", seeds.weights, rest[seeds.corners])
    labels = seeds.labels[nearest_vertices(rest, points)[1]]
    return labels.astype(np.int8), tuple(f"part_{k}" for k in range(int(seeds.labels.max()) + 1))


def _common(
    garment: dict[int, Path], body: dict[int, Path], most: int | None
) -> tuple[dict[int, tuple[Path, Path]], str]:
    """Files of the frames that both have, by number, and what is to be said of the others."""
    both = [k for k in garment if k in body]
    if not both or both[-1] - both[0] + 1 != len(both):
        where = next(iter(garment.values())).parent
        gap = next((k for k, after in pairwise(both) if after != k + 1), None)
        found = "no frame of both garment and body" if gap is None else f"no frame {gap + 1} of both garment and body"
        raise UserError(f"{where}: {found}; wanted every frame of a motion, in {where.name} and in body_n")
    left_out = len(set(garment) ^ set(body))
    chosen = both[:most]
    return {
        k: (garment[k], body[k]) for k in chosen
    }, f" ({left_out} of garment or body alone left out)" if left_out else ""


def _read_frames(
    files: dict[int, tuple[Path, Path]], place: Placement, vertices: int, body_vertices: int
) -> tuple[np.ndarray, np.ndarray]:
    """Positions [m] of garment and body, shapes (T, V, 3) and (T, B, 3), float32; one file at a time is in memory."""
    clothes = np.empty((len(files), vertices, 3), np.float32)
    bodies = np.empty((len(files), body_vertices, 3), np.float32)
    uneven, before = [], None
    with track(len(files), "reading frames") as step:
        for t, (number, (garment, body)) in enumerate(files.items()):
            position, _, velocity = (_of_shape(garment, array, vertices) for array in read_arrays(garment, 3))
            clothes[t], bodies[t] = place(position), place(_of_shape(body, read_points(body), body_vertices))
            if t and np.abs(place(position - before) - place(velocity)).max() > UNEVEN:
                uneven.append(number)
            before = position
            step()
    if uneven:
        frames = f"{len(uneven)} frames, the first {uneven[0]}"
        first = f"{frames}, have moved otherwise since the frame before than their velocity says"
        warnings.warn(f"{first}: are frames missing?", stacklevel=2)
    return clothes, bodies


def _of_shape(path: Path, array: np.ndarray, count: int) -> np.ndarray:
    if array.shape != (count, 3):
        raise UserError(f"{path}: an array of shape {array.shape}, wanted ({count}, 3) as in the template; {AGAIN}")
    return array
