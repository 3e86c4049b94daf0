"""Meshes with exactly one fault, made by hand from a clean tube of cloth."""

from dataclasses import replace

import numpy as np

from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.sequence import Body

ROWS, COLUMNS, RADIUS, HEIGHT = 31, 60, 0.15, 0.6  # edges of about 2 cm


def tube() -> Mesh:
    """A clean tube round the z axis, 0.3 m wide, sewn along one line; UV in [0, 0.9], outward faces.

    Vertex (row, column) is number row * (COLUMNS + 1) + column; face 2 k and 2 k + 1 make up square k.
    """
    row, column = np.meshgrid(np.arange(ROWS), np.arange(COLUMNS + 1), indexing="ij")
    angle = 2 * np.pi * (column.ravel() % COLUMNS) / COLUMNS
    height = HEIGHT * (row.ravel() / (ROWS - 1) - 0.5)
    vertices = np.stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), height], axis=1)
    uv = 0.9 * np.stack([column.ravel() / COLUMNS, row.ravel() / (ROWS - 1)], axis=1)
    corner = (row * (COLUMNS + 1) + column)[:-1, :-1].ravel()
    right, up = corner + 1, corner + COLUMNS + 1
    faces = np.stack([corner, right, up, right, up + 1, up], axis=1).reshape(-1, 3)
    left = np.arange(ROWS) * (COLUMNS + 1)
    seams = np.stack([left, left + COLUMNS], axis=1)
    return Mesh("tube", vertices, faces, uv, np.arange(len(vertices)), seams, says_seams=True)


def at(row: int, column: int) -> int:
    """The vertex there."""
    return row * (COLUMNS + 1) + column


def moved(mesh: Mesh, vertex: int, to: np.ndarray) -> Mesh:
    vertices = mesh.vertices.copy()
    vertices[vertex] = to
    return replace(mesh, vertices=vertices)


def with_uv(mesh: Mesh, vertex: int | np.ndarray, to: np.ndarray) -> Mesh:
    uv = mesh.uv.copy()
    uv[vertex] = to
    return replace(mesh, uv=uv)


def more(mesh: Mesh, vertices: list, faces: list, uv: list, seams: list = ()) -> Mesh:
    """Further vertices, faces and seams; face and seam indices -1, -2 ... name the new vertices from the last."""
    count = len(mesh.vertices) + len(vertices)
    rows = lambda table: np.reshape(table, (-1, np.shape(table)[-1] if len(table) else 2))  # noqa: E731
    return replace(
        mesh,
        vertices=np.concatenate([mesh.vertices, rows(vertices)]),
        uv=np.concatenate([mesh.uv, rows(uv)]),
        faces=np.concatenate([mesh.faces, rows(faces) % count if len(faces) else np.zeros((0, 3), int)]),
        seams=np.concatenate([mesh.seams, np.reshape(seams, (-1, 2)).astype(int) % count]),
        numbers=np.arange(count),
    )


def parted(mesh: Mesh, row: int, sewn: bool) -> Mesh:
    """Cut along a row: the lower part gets copies of the row's vertices, with the same UV, sewn on or not."""
    cut = at(row, 0) + np.arange(COLUMNS + 1)
    copy = np.arange(len(mesh.vertices))
    copy[cut] = len(mesh.vertices) + np.arange(len(cut))
    faces = mesh.faces.copy()
    lower = np.arange(len(faces)) < 2 * COLUMNS * row
    faces[lower] = copy[faces[lower]]
    pairs = np.stack([cut, copy[cut]], axis=1)
    seams = copy[mesh.seams]
    seams = np.concatenate([mesh.seams, seams[(seams != mesh.seams).any(axis=1)], pairs[: len(pairs) if sewn else 0]])
    return replace(
        mesh,
        vertices=np.concatenate([mesh.vertices, mesh.vertices[cut]]),
        uv=np.concatenate([mesh.uv, mesh.uv[cut]]),
        faces=faces,
        seams=seams,
        numbers=np.arange(len(copy) + len(cut)),
    )


def ball(radius: float = 0.145, height: float = 0.9) -> Body:
    """A body for the tube: a closed ellipsoid that nearly fills it, with outward faces."""
    import trimesh

    sphere = trimesh.creation.icosphere(subdivisions=4)
    rest = (sphere.vertices * [radius, radius, height]).astype(np.float32)
    half = (rest[:, 2] > 0).astype(np.int8)
    return Body("ball", rest, sphere.faces.astype(np.int32), half, ("lower", "upper"))
