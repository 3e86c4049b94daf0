"""A trained method from the authors' release: their two checkpoints, their tables, their seed points, their options."""

from pathlib import Path

import numpy as np
import torch

from garmentbench.errors import UserError
from garmentbench.geometry.surface_seeds import SurfaceSeeds, surface_frames, surface_seeds
from garmentbench.methods.motion_guided.authors.axes import Placement, placement
from garmentbench.methods.motion_guided.authors.checkpoint import (
    DYNAMIC,
    SDF,
    STATIC,
    code_config,
    read_checkpoint,
    sizes_of,
)
from garmentbench.methods.motion_guided.authors.files import (
    read_arrays,
    read_chart,
    read_mesh,
    read_points,
    read_samples,
    read_sampling,
    read_vectors,
)
from garmentbench.methods.motion_guided.authors.networks import load_dynamic, load_sdf, load_static
from garmentbench.methods.motion_guided.authors.read import read_garment
from garmentbench.methods.motion_guided.authors.release import Release
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.frames import smallest_rotations
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.method import MotionGuided
from garmentbench.methods.motion_guided.uv_tables import UVTables


def read_model(
    release: Release, static: Path, dynamic: Path, unit: str = "auto", axes: str = "auto"
) -> tuple[MotionGuided, list[str]]:
    """The authors' trained model, in our axes, and notes for the user, line by line.

    Args:
        release: Where its template, tables and seed points are.
        static: Checkpoint of stage 1.
        dynamic: Checkpoint of stage 2.
        unit, axes: As for `placement`.

    Raises:
        UserError: A file is missing, damaged, or does not belong to the others.
    """
    body, faces = read_mesh(release.body("body_geo.obj"))
    place = placement(body, unit, axes)
    if place.unit != "m":
        raise UserError(
            f"{release.folder}: in {place.unit}; the authors' networks are in metres, as their constants are, so "
            "their checkpoints need data in metres"
        )
    first, second = read_checkpoint(static, STATIC), read_checkpoint(dynamic, DYNAMIC)
    config = code_config(sizes_of(first))
    canonical = read_canonical(release, place, body, faces, config.model.map_size)
    if len(canonical.seeds.rest) != config.model.seeds:
        raise UserError(
            f"{static}: made for {config.model.seeds} seeds, {release.folder} has {len(canonical.seeds.rest)}; "
            "use the checkpoint that belongs to this data"
        )
    model = GenerativeModel(canonical, config.model)
    dynamics = DynamicEncoder(config.model, config.model.seeds, config.stage2)
    turn = torch.from_numpy(place.turn)
    assert canonical.seeds.labels is not None, "read with the seeds"
    load_static(model, first, static, torch.from_numpy(np.unique(canonical.seeds.labels)), turn)
    load_dynamic(dynamics, second, dynamic, turn)
    method = MotionGuided(canonical, config, model.requires_grad_(False), dynamics.requires_grad_(False))
    return method, _told(release, place, method)


def read_canonical(release: Release, place: Placement, body: np.ndarray, faces: np.ndarray, size: int) -> Canonical:
    """Template, seeds and tables of the release, whose body has vertices `body`, shape (B, 3), as in the file."""
    garment = read_garment(release, place)
    count = len(garment.rest)
    samples = read_samples(release.body("body_*_sample.txt"), len(body))
    seeds = surface_seeds(place(body), faces, samples.corners, samples.weights, samples.labels)
    axes = [read_vectors(release.cloth(f"garment_canc_{name}.txt")) for name in ("tangents", "basements", "normals")]
    chart = read_chart(release.cloth("garment_uvMap_*.txt"), count)
    pixels, weights = read_sampling(release.cloth("garment_*_vertPixel.txt"), count, 2 * size)
    if chart.size != size or any(len(vectors) != count for vectors in axes):
        where, found = (
            release.folder / f"uv_{release.garment}",
            f"maps of {chart.size} pixels and {len(axes[0])} tangents",
        )
        raise UserError(
            f"{where}: {found}; the checkpoint's networks take maps of {size} pixels, the garment has {count} "
            "vertices; use files that belong to each other"
        )
    frames = np.stack([place.directions(vectors) for vectors in axes], axis=-1)
    tables = UVTables(chart, pixels, weights, frames)
    return Canonical(garment.rest, garment.faces, garment.uv, garment.seams, seeds, len(body), tables)


def _told(release: Release, place: Placement, method: MotionGuided) -> list[str]:
    """What the release's own derived files say of how it was read."""
    sizes, seeds = method.config.model, method.canonical.seeds
    radii = ", ".join(f"{100 * r:.2f}" for r in method.generative.log_radii.exp().tolist())
    told = [
        f"axes: ours are the files' {place.axes}; first layers turned to them",
        f"networks: maps of {sizes.map_size} pixels, width {sizes.width}, latent codes of {sizes.latent}, "
        f"{sizes.seeds} seeds",
        f"kernel radii [cm]: {radii}",
    ]
    if isinstance(seeds, SurfaceSeeds) and any(release.folder.glob("body_RTVN_*")):
        told.append(_seed_difference(release, place, seeds))
    if any((release.folder / "uv_body").glob("*_sdf_*.ckp")):
        path = release.body("*_sdf_*.ckp")
        network = load_sdf(read_checkpoint(path, SDF), path, torch.from_numpy(place.turn))
        distance = network(torch.from_numpy(method.canonical.rest)).min().item()
        told.append(f"SDF_0: the rest garment keeps {1000 * distance:.1f} mm from the body at least")
    return told


def _seed_difference(release: Release, place: Placement, seeds: SurfaceSeeds) -> str:
    """How far our seeds are from those that the release stores for its first frame."""
    number, path = next(iter(release.seed_frames("").items()))
    rotations, _, positions, normals = read_arrays(path, 4)
    body = place(read_points(release.body_frames("")[number]))
    ours, _, our_normals = surface_frames(body, seeds)
    turns = smallest_rotations(seeds.frames[..., 2], our_normals)
    theirs = place.turn @ rotations @ place.turn.T
    metres = np.linalg.norm(ours - place(positions), axis=-1).max()
    degrees = [
        np.degrees(_angle(a))
        for a in (
            np.einsum("nx,nx->n", our_normals, place.directions(normals)),
            (np.einsum("nxy,nxy->n", turns, theirs) - 1) / 2,
        )
    ]
    return (
        f"seeds of frame {number} against the stored ones: positions within {1000 * metres:.2f} mm, normals within "
        f"{degrees[0]:.1f} and rotations within {degrees[1]:.1f} degrees (theirs are the files' normals, ours the "
        "faces' mean)"
    )


def _angle(cosines: np.ndarray) -> float:
    return float(np.arccos(np.clip(cosines, -1, 1)).max())
