"""A folder of files as the authors of the motion-guided model released them, from a baked body and T-shirt.

All coordinates are multiples of 2^-12 m, so that nothing is rounded on the way through float32.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from garmentbench.geometry.mesh import normalised, tangent_frames, vertex_normals
from garmentbench.geometry.surface_seeds import surface_frames, surface_seeds
from garmentbench.geometry.uvmap import bilinear_table, chart
from garmentbench.methods.motion_guided.authors.axes import Placement
from garmentbench.methods.motion_guided.frames import smallest_rotations
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.garments import load_garment

Y_UP = Placement(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), "m")  # the body faces +z
Z_UP = Placement(np.eye(3), "m")
PARTS = 3


@dataclass
class Written:
    """What was written, in the files' coordinates; positions are shape (T, ., 3)."""

    folder: Path
    place: Placement
    rest: np.ndarray
    body_rest: np.ndarray
    garment: np.ndarray
    body: np.ndarray
    uv: np.ndarray
    frames: np.ndarray  # H_0, shape (V, 3, 3)
    corners: np.ndarray
    weights: np.ndarray
    labels: np.ndarray
    chart_table: np.ndarray  # x y i0 i1 i2 u v
    pixels: np.ndarray  # (x, y) of the four pixels, shape (V, 4, 2)
    pixel_weights: np.ndarray
    seams: np.ndarray
    rotations: np.ndarray = field(default=None)
    seeds: np.ndarray = field(default=None)
    normals: np.ndarray = field(default=None)


def write_release(
    folder: Path,
    place: Placement = Y_UP,
    frames: int = 6,
    size: int = 8,
    seed_count: int = 12,
    scale: float = 1.0,
    meshes: tuple[str, str] = ("smoke", "small"),
) -> Written:
    """Write everything but checkpoints. The maps' rows run downwards, as ours do not.

    Args:
        scale: Units in a metre.
        meshes: Sizes of the baked garment and body.
    """
    garment, body = load_garment("tshirt", meshes[0]), load_body("base", meshes[1]).body
    rng = np.random.default_rng(0)

    def theirs(points: np.ndarray) -> np.ndarray:
        return scale * np.round(4096 * np.asarray(points, np.float64)) / 4096 @ place.turn

    rest, body_rest = theirs(garment.rest), theirs(body.rest)
    time = 0.2 * np.arange(frames)[:, None]
    near = np.flatnonzero(np.linalg.norm(body.rest - garment.rest.mean(axis=0), axis=1) < 0.25)
    triangles = body.faces[np.isin(body.faces, near).all(axis=1)]
    corners = triangles[rng.choice(len(triangles), seed_count, replace=False)].astype(np.int64)
    weights = np.round(64 * rng.dirichlet(np.full(3, 5.0), seed_count)) / 64
    weights[:, 0] = 1 - weights[:, 1:].sum(axis=1)
    table = chart(garment.uv, garment.faces, size)
    last = np.round(256 * table.weights[:, 1:]) / 256
    y, x = np.divmod(table.pixels, size)
    pixels, pixel_weights = bilinear_table(garment.uv, 2 * size)
    rows, columns = np.divmod(pixels, 2 * size)
    axes = tangent_frames(rest / scale, garment.faces, garment.uv).astype(np.float32).astype(np.float64)
    written = Written(
        folder,
        place,
        rest,
        body_rest,
        garment=np.stack([theirs(_moved(garment.rest, t) + 0.01 * np.sin(9 * garment.rest + t)) for t in time[:, 0]]),
        body=np.stack([theirs(_moved(body.rest, t)) for t in time[:, 0]]),
        uv=np.round(4096 * garment.uv.astype(np.float64)) / 4096,
        frames=axes,
        corners=corners,
        weights=weights,
        labels=np.arange(seed_count) % PARTS,
        chart_table=np.column_stack([x, size - 1 - y, table.vertices, last]),
        pixels=np.stack([columns, 2 * size - 1 - rows], axis=-1),
        pixel_weights=np.round(256 * pixel_weights) / 256,
        seams=garment.seams,
    )
    _write_template(written, garment.faces, body.faces, size)
    _write_motion(written, folder, body.faces)
    return written


def _moved(rest: np.ndarray, t: float) -> np.ndarray:
    """Bent and carried along."""
    lean = 0.1 * np.sin(2 * t)
    return rest + np.stack([lean * rest[:, 2], -0.3 * t + 0 * rest[:, 0], 0.05 * np.sin(t) * rest[:, 0]], axis=1)


def _write_template(w: Written, faces: np.ndarray, body_faces: np.ndarray, size: int) -> None:
    cloth, person = w.folder / "uv_tshirt", w.folder / "uv_body"
    cloth.mkdir(parents=True)
    person.mkdir()
    write_obj(person / "body_geo.obj", w.body_rest, vertex_normals(w.body_rest, body_faces), body_faces)
    write_obj(cloth / "garment_geo.obj", w.rest, vertex_normals(w.rest, faces), faces)
    write_obj(cloth / "garment_uv.obj", np.column_stack([w.uv, np.zeros(len(w.uv))]), None, faces)
    lines(
        person / f"body_t_{len(w.labels)}_sample.txt",
        f"# {len(w.labels)}",
        (
            f"{label} {a} {b} {c} {u!r} {v!r}"
            for label, (a, b, c), (_, u, v) in zip(w.labels, w.corners.tolist(), w.weights.tolist(), strict=True)
        ),
    )
    for k, name in enumerate(("tangents", "basements", "normals")):
        lines(cloth / f"garment_canc_{name}.txt", str(len(w.rest)), map(numbers, w.frames[:, :, k]))
    map_lines = (" ".join(str(int(n)) for n in row[:5]) + " " + numbers(row[5:]) for row in w.chart_table)
    lines(cloth / f"garment_uvMap_{size}.txt", f"1\n{size} \n{size} \n0 {len(w.chart_table)}", map_lines)
    lines(
        cloth / f"garment_{2 * size}_vertPixel.txt",
        f"# {len(w.rest)}",
        (
            " ".join(map(str, p.ravel().tolist())) + " " + numbers(k)
            for p, k in zip(w.pixels, w.pixel_weights, strict=True)
        ),
    )
    groups = _groups(len(w.rest), w.seams)
    lines(cloth / "ind_B2O_10.txt", f"# {len(groups)}", (" ".join(map(str, [len(g), *g])) for g in groups))


def _groups(count: int, seams: np.ndarray) -> list[list[int]]:
    group = {k: [k] for k in range(count)}
    for a, b in seams.tolist():
        if group[a] is not group[b]:
            group[a].extend(group[b])
            for k in group[b]:
                group[k] = group[a]
    return [g for k, g in group.items() if g[0] == k]


def _write_motion(w: Written, folder: Path, body_faces: np.ndarray) -> None:
    """Frames 1, 2 ... of garment, body and seeds. Normals are the faces' uniform mean; the authors' differ."""
    cloth, person, seeds_folder = folder / "TShirt_pnva", folder / "body_n", folder / f"body_RTVN_{len(w.labels)}"
    for made in (cloth, person, seeds_folder):
        made.mkdir(parents=True)
    seeds = surface_seeds(w.body_rest, body_faces, w.corners, w.weights)
    positions, _, normals = surface_frames(w.body, seeds)
    w.rotations, w.seeds, w.normals = smallest_rotations(seeds.frames[..., 2], normals), positions, normals
    velocity = np.diff(w.garment, axis=0, prepend=w.garment[:1])
    acceleration = np.diff(velocity, axis=0, prepend=np.zeros_like(velocity[:1]))
    for t in range(len(w.garment)):
        name = f"{t + 1:06d}"
        save_arrays(cloth / f"{name}.npy", w.garment[t], normalised(w.garment[t]), velocity[t], acceleration[t])
        write_obj(person / f"{name}.obj", w.body[t], vertex_normals(w.body[t], body_faces))
        stored = (w.rotations[t], w.seeds[t] - seeds.rest, w.seeds[t], w.normals[t])
        save_arrays(seeds_folder / f"{name}.npy", *(x.astype(np.float32) for x in stored))


def save_arrays(path: Path, *arrays: np.ndarray) -> None:
    """One after another in one file."""
    with path.open("wb") as file:
        for array in arrays:
            np.save(file, array)


def write_obj(
    path: Path, vertices: np.ndarray, normals: np.ndarray | None = None, faces: np.ndarray | None = None
) -> None:
    text = [f"v {numbers(v)}" for v in vertices]
    text += [] if normals is None else [f"vn {numbers(n)}" for n in normals]
    text += [] if faces is None else ["f " + " ".join(f"{i + 1}//{i + 1}" for i in face) for face in faces]
    path.write_text("\n".join(text) + "\n")


def lines(path: Path, first: str, rest) -> None:
    path.write_text("\n".join([first, *rest]) + "\n")


def numbers(values: np.ndarray) -> str:
    return " ".join(map(repr, np.asarray(values).tolist()))
